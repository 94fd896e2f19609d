"""Pixels in sunlight by recorded paths, against quadrature and pairwise tracing.

The radiance of blocks of pixels agrees within 1 % and four standard errors, for every
kind of BSDF; errors of blocks are honest: deviations over errors have a variance of 1.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pairwise_sun import pairwise_sun
from physics_scenes import box, grey, quad, window
from scipy.sparse import csc_array
from test_sun_through_trees import over_disc, quadrature, towards

from clerestory.bands import RGB
from clerestory.bsdf.analytic import clear_air
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.panes_and_fabrics import clear_pane
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.engine import window_path_jobs
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases import sunlit_window
from clerestory.phases.picture_matrices import (
    picture_view_matrices,
    reflected_view_matrices,
)
from clerestory.phases.sun_coefficients import picture_sun_coefficients
from clerestory.phases.sunlit import in_sunlight
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.model import Glass, Plastic, Scene
from clerestory.scene.view import View, solid_angles
from clerestory.scene.window_zones import fills_rectangle
from clerestory.spectral.band_sets import wavelength_bands

KLEMS = klems("full")
NINE = wavelength_bands(np.linspace(380, 780, 10))

# Altitudes on both sides of the cut-off angle of the blind, and a low sun
SUNS = np.array(
    [towards(170, 25), towards(200, 33), towards(178, 53), towards(140, 62)]
)

# Pixels along an edge of a picture, and of a block
SIZE, EDGE = 96, 16

# From the back of the room to the window, and down to the floor behind it
BACK = View(
    kind="angular", horizontal=130, vertical=130,
    position=np.array([2.1, 4.3, 1.4]), direction=np.array([0.1, -1, -0.35]),
)  # fmt: skip


@cache
def blind(basis, halvings=4):
    """A blind whose slats let some of the suns through."""
    system = venetian(slat_width=0.08, spacing=0.072, tilt_deg=20, reflectance=0.5)
    return generate_bsdf(
        system, basis=basis, halvings=halvings, sides="both", samples=200, seed=3,
        geometry=False,
    )  # fmt: skip


@cache
def isotropic():
    """A tree of rank 3 of random values in cells of two sizes."""
    rng = np.random.default_rng(5)

    def branch(levels):
        if levels > 1:
            children = " ".join(branch(levels - 1) for _ in range(8))
        else:
            count = 8 if rng.random() < 0.7 else 1
            children = " ".join(map(str, 0.1 + 0.9 * rng.random(count)))
        return f"{{ {children} }}"

    table = parse_tree(branch(3).encode(), rank=3)
    tree = ScatteringTree(table.slots, 3, table.depth)
    return Bsdf({("visible", name): tree for name in FUNCTIONS})


@cache
def pane():
    """A clear pane as a tree of rank 3: its light leaves in one cell."""
    return generate_bsdf(
        clear_pane(), basis="tree3", halvings=5, sides="both", samples=200, seed=3,
        geometry=False,
    )  # fmt: skip


BSDFS = {
    "Klems": lambda: blind("full"),
    "rank 4": lambda: blind("tree4"),
    "rank 3": isotropic,
    "pane": pane,
}

# The pairwise estimator removes parts of Klems patches that reach into the peak, and
# loses their flux; random values of neighbouring cells have no peak
PEAKS = {"Klems": SUNS[[0, 1, 3]], "rank 4": SUNS, "pane": SUNS}


def camera(view=BACK, size=SIZE):
    return Camera(view, size, size)


def blocks(values, edge=EDGE, size=SIZE):
    """Means over blocks of edge × edge pixels of (…, pixel, sun)."""
    few = size // edge
    parts = values.reshape(*values.shape[:-2], few, edge, few, edge, -1)
    return parts.mean(axis=(-4, -2))


def block_errors(error, edge=EDGE, size=SIZE):
    """Standard errors of blocks of pixels with independent errors."""
    return np.sqrt(blocks(np.square(error), edge, size)) / edge


def compare(
    found, error, expected, noise, *, edge=EDGE, size=SIZE, bias=0.01, dark=0.02
):
    """Blocks agree within a share of their radiance and four standard errors."""
    assert expected.max() > 0
    value, truth = (blocks(v, edge, size) for v in (found, expected))
    spread = np.hypot(*(block_errors(e, edge, size) for e in (error, noise)))
    least = dark * np.mean(truth, axis=(-3, -2), keepdims=True)
    allowed = 4 * spread + bias * np.maximum(truth, least)
    worst = np.max(abs(value - truth) / np.maximum(allowed, 1e-9))
    assert worst < 1
    # The sum of all pixels: light is neither lost nor counted twice
    total, whole = value.mean(axis=(-3, -2)), truth.mean(axis=(-3, -2))
    count = value.shape[-2] * value.shape[-3]
    sure = 4 * np.sqrt(np.mean(spread**2, axis=(-3, -2)) / count)
    assert np.all(abs(total - whole) <= sure + bias / 2 * whole)
    return (value - truth) / np.maximum(spread, 1e-9), truth > least


def against_pairs(
    scene, windows, bsdf, *, number=0, peak=False, view=BACK, suns=SUNS, samples=16,
    device="cpu", bias=0.01, pairs=32,
):  # fmt: skip
    """Compare recorded paths with the pairwise estimator."""
    given = scene, windows, windows[number].name, bsdf, camera(view)
    found = picture_sun_coefficients(
        *given, suns=suns, peak=peak, samples=samples, seed=7, device=device
    )
    expected, noise = pairwise_sun(
        scene, windows, bsdf, camera(view), suns, number=number, peak=peak,
        samples=pairs, device=device,
    )  # fmt: skip
    return compare(found.values, found.standard_error, expected, noise, bias=bias)


@pytest.mark.parametrize("reflectance", [0.5, (0.7, 0.4, 0.1)], ids=["grey", "rgb"])
def test_direct_view_matrix_is_that_of_the_path_tracer(device, reflectance):
    """V_d, patch by patch of blocks of pixels, and each window by itself."""
    scene, windows = two_windows(reflectance)
    shared = {"samples": 16, "device": device}
    paths = picture_window_paths(scene, windows, camera(), seed=1, **shared)
    traced = picture_view_matrices(
        scene, windows, camera(), direct=True, seed=2, **shared
    )
    for name, found in paths.view_matrices().items():
        other = traced[name]
        # One channel is enough for grey rooms
        value = np.broadcast_to(found.values, other.values.shape)
        error = np.broadcast_to(found.standard_error, other.values.shape)
        noise = other.standard_error
        # Patches that many paths reach; others have errors of few paths
        many = blocks(other.values) > 1e-3 * other.values.sum(axis=-1).mean()
        spread = np.hypot(block_errors(error), block_errors(noise))
        score = ((blocks(value) - blocks(other.values)) / np.maximum(spread, 1e-9))[
            many
        ]
        assert 0.8 < np.sqrt(np.mean(score**2)) < 1.2
        assert abs(score).max() < 6
        every = (v.sum(axis=-1, keepdims=True) for v in (value, error, other.values))
        compare(*every, noise.sum(axis=-1, keepdims=True), bias=0.002)


@pytest.mark.parametrize("kind", ["diffuse", "glossy", "mirrors", "pane"])
def test_direct_and_reflected_light_are_the_whole_light(device, kind):
    """V is the sum of V_d and V - V_d, which are traced by different paths."""
    scene, south = box(4, 5, 3, 0.5)
    if kind in ("glossy", "mirrors"):
        roughness = 0.2 if kind == "glossy" else 0.0
        wall = replace(grey(0.4), specularity=0.3, roughness=roughness)
        scene = Scene({"wall": wall}, scene.surfaces)
    if kind == "pane":
        pane = quad((0, 1, 0), (0, 1, 3), (4, 1, 3), (4, 1, 0), material="clear")
        materials = scene.materials | {"clear": Glass("clear", np.full(3, 0.8))}
        scene = Scene(materials, (*scene.surfaces, pane))
    given, shared = (scene, [south], camera()), {"samples": 64, "device": device}
    whole = picture_view_matrices(*given, seed=1, **shared)["south"]
    direct = picture_window_paths(*given, seed=2, **shared).view_matrices()["south"]
    reflected = reflected_view_matrices(*given, seed=3, **shared)["south"]
    assert reflected.values.sum() > 0.1 * whole.values.sum()
    sums = [
        (each.values.sum(axis=-1, keepdims=True), each.components[0].sum(axis=-1))
        for each in (whole, direct, reflected)
    ]
    noise = np.hypot(sums[1][1], sums[2][1])[..., None]
    compare(
        np.broadcast_to(sums[1][0] + sums[2][0], sums[0][0].shape),
        np.broadcast_to(noise, sums[0][0].shape),
        sums[0][0],
        abs(sums[0][1])[..., None],
        bias=0.002,
    )


@pytest.mark.parametrize("kind", BSDFS)
def test_blocks_agree_with_pairs_of_pixels_and_suns(device, kind):
    """Narrow lobes too: the pairwise estimator samples them for each sun."""
    scene, south = box(4, 5, 3, 0.5)
    against_pairs(scene, [south], BSDFS[kind](), device=device)


@pytest.mark.parametrize("kind", PEAKS)
def test_blocks_agree_where_sunlight_is_unscattered(device, kind):
    scene, south = box(4, 5, 3, 0.5)
    given = {"suns": PEAKS[kind], "peak": True, "device": device}
    against_pairs(scene, [south], BSDFS[kind](), **given)


@pytest.mark.slow
@pytest.mark.parametrize("kind", BSDFS)
@pytest.mark.parametrize("peak", [False, True], ids=["spread", "peak"])
def test_errors_of_blocks_are_those_of_the_scatter(device, kind, peak):
    """Root mean square of errors over that of the scatter between eight seeds."""
    scene, south = box(4, 5, 3, 0.5)
    bsdf, suns = BSDFS[kind](), PEAKS.get(kind, SUNS)
    found = [
        picture_sun_coefficients(
            scene, [south], "south", bsdf, camera(),
            suns=suns, peak=peak and kind in PEAKS, samples=8, seed=seed,
            device=device,
        )
        for seed in range(1, 9)
    ]  # fmt: skip
    values = np.stack([blocks(one.values) for one in found])
    errors = np.stack([block_errors(one.standard_error) for one in found])
    mean = values.mean(axis=0)
    bright = mean > 0.1 * mean.mean(axis=(-3, -2), keepdims=True)
    for sun in range(len(suns)):
        some = bright[..., sun]
        shares, parts = (
            v[..., sun][:, some] / mean[..., sun][some] for v in (values, errors)
        )
        scatter = shares.var(axis=0, ddof=1).mean()
        assert 0.8 < np.sqrt(np.square(parts).mean() / scatter) < 1.25


def floor_point(x, y, reach=3.0):
    """A view of a spot on the floor, a millimetre wide."""
    angle = np.degrees(1e-3 / reach)
    return View(
        kind="perspective", horizontal=angle, vertical=angle,
        position=np.array([x, y, 2.9]), direction=np.array([0, 0, -1.0]),
        up=np.array([0, 1.0, 0]),
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["Klems", "rank 4", "rank 3"])
def test_floor_reflects_the_integral_over_window_and_disc(device, kind):
    """L = ρ/π ∫ f cos θ_sun cos θ dω, by quadrature: no tracing on the other side."""
    scene, south = box(4, 5, 3, 0.5)
    bsdf = BSDFS[kind]()
    for eye in ([1.0, 2.0, 0.0], [3.0, 4.0, 0.0]):
        found = picture_sun_coefficients(
            scene, [south], "south", bsdf, Camera(floor_point(*eye[:2]), 64, 64),
            suns=SUNS, samples=32, seed=4, device=device,
        )  # fmt: skip
        expected = np.array(
            [0.5 / np.pi * quadrature(south, bsdf, np.array(eye), s) for s in SUNS]
        )
        value = found.values[0].mean(axis=0)
        error = np.sqrt(np.square(found.standard_error[0]).mean(axis=0)) / 64
        assert np.all(error < 0.02 * expected + 1e-5)
        assert np.all(abs(value - expected) < 4 * error + 0.01 * expected)


@pytest.mark.parametrize("kind", ["Klems", "rank 4", "rank 3"])
def test_window_has_the_radiance_of_the_layer(device, kind):
    """C_F-ds: f(ω_sun, ω) cos θ_sun, the mean over a pixel and over the disc."""
    scene, south = box(4, 5, 3, 0.0)
    bsdf, size, fine = BSDFS[kind](), 12, 32
    eye = View(
        kind="perspective", horizontal=50, vertical=40,
        position=np.array([2.0, 3.5, 1.5]), direction=np.array([0.05, -1, 0.02]),
    )  # fmt: skip
    found = picture_sun_coefficients(
        scene, [south], "south", bsdf, Camera(eye, size, size),
        suns=SUNS, samples=512, seed=4, device=device,
    )  # fmt: skip
    toward = eye.rays(size * fine, size * fine).direction.reshape(-1, 3)
    axes = np.stack([south.frame.right, south.frame.up, south.frame.normal], axis=-1)
    expected = np.zeros((size**2, len(SUNS)))
    for number, sun in enumerate(SUNS):
        for one in over_disc(sun, 24):
            value = bsdf.evaluate(one @ axes, -toward @ axes)
            value = value.reshape(size, fine, size, fine).mean(axis=(1, 3)).ravel()
            expected[:, number] += value * -(one @ south.frame.normal) / 24
    nothing = np.zeros_like(expected)
    value, error = found.values[0], found.standard_error[0]
    compare(value, error, expected, nothing, size=size, edge=3, dark=0.1)


def two_windows(reflectance=0.5):
    """A room with windows to the south and, smaller, to the west."""
    scene, south = box(4, 5, 3, reflectance)
    sill = quad((0, 0, 0), (0, 5, 0), (0, 5, 1), (0, 0, 1))
    side = quad((0, 3, 1), (0, 5, 1), (0, 5, 3), (0, 3, 3))
    west = window(quad((0, 0, 1), (0, 3, 1), (0, 3, 3), (0, 0, 3)), name="west")
    walls = tuple(w for n, w in enumerate(scene.surfaces) if n != 2)
    return Scene(scene.materials, (*walls, sill, side)), [south, west]


def test_beams_cross_a_window_by_crossing_its_rectangle():
    """Only if it fills the rectangle, and no window is between it and the room."""
    whole = window(quad((0, 0, 0), (0, 0, 3), (4, 0, 3), (4, 0, 0)))
    beside = window(quad((4, 0, 0), (4, 0, 3), (6, 0, 3), (6, 0, 0)))
    triangle = window(quad((0, 0, 0), (0, 0, 3), (4, 0, 0)))
    both = window(*whole.polygons, *beside.polygons)
    before = window(quad((1, 1, 1), (1, 1, 2), (2, 1, 2), (2, 1, 1)))
    assert fills_rectangle(0, [whole])
    assert fills_rectangle(0, [both])
    assert fills_rectangle(1, [whole, beside])
    assert not fills_rectangle(0, [triangle])
    assert not fills_rectangle(0, [whole, before])
    assert fills_rectangle(1, [whole, before])


@pytest.mark.parametrize("number", [0, 1], ids=["south", "west"])
def test_each_of_several_windows_is_lit_by_itself(device, number):
    """A sun in the south-west lights both; each has its own zones and frame."""
    scene, windows = two_windows()
    suns = np.array([towards(235, 26), towards(215, 50)])
    view = replace(BACK, direction=np.array([-0.6, -1, -0.3]))
    given = {"number": number, "suns": suns, "view": view, "device": device}
    against_pairs(scene, windows, blind("tree4"), peak=True, **given)


def test_coloured_walls_colour_reflected_sunlight(device):
    scene, south = box(4, 5, 3, (0.7, 0.4, 0.1))
    against_pairs(scene, [south], blind("tree4"), peak=True, device=device)


@pytest.mark.parametrize("peak", [False, True], ids=["spread", "peak"])
def test_nine_bands_are_lit_each_by_itself(device, peak):
    """A floor that is black in three of nine bands reflects none of them."""
    scene, south = box(4, 5, 3, 0.5)
    floor, *walls = scene.surfaces
    colour = np.array([0.5, 0.2, 0.8, 0, 0, 0, 0.9, 0.3, 0.4])
    materials = {
        "wall": Plastic("wall", np.linspace(0.2, 0.8, 9)),
        "floor": Plastic("floor", colour),
    }
    room = Scene(materials, (replace(floor, material="floor"), *walls), bands=NINE)
    against_pairs(room, [south], blind("tree4"), peak=peak, device=device)


@pytest.mark.parametrize(
    ("kind", "peak"), [("Klems", False), ("rank 4", False), ("rank 4", True)]
)
def test_shadow_of_an_obstacle_crosses_the_window(device, kind, peak):
    """Fins and an overhang outside, with an oblique edge."""
    scene, south = box(4, 5, 3, 0.5)
    fin = quad((1.3, -1.2, -1), (1.3, 0, -1), (1.3, 0, 4), (1.3, -1.2, 4))
    roof = quad((-1, -0.7, 3.1), (5, -1.6, 3.3), (5, -0.05, 3.3), (-1, -0.05, 3.1))
    shaded = Scene(scene.materials, (*scene.surfaces, fin, roof))
    suns = np.array([towards(215, 30), towards(150, 45)])
    against_pairs(shaded, [south], BSDFS[kind](), peak=peak, suns=suns, device=device)


@pytest.mark.parametrize("peak", [False, True], ids=["spread", "peak"])
def test_window_of_several_polygons(device, peak):
    """Two panes and a triangle, with walls between them."""
    scene, _ = box(4, 5, 3, 0.5)
    panes = (
        quad((0, 0, 0), (0, 0, 3), (1.1, 0, 3), (1.1, 0, 0)),
        quad((1.6, 0, 1), (1.6, 0, 2.2), (2.3, 0, 2.2), (2.3, 0, 1)),
        quad((4, 0, 0.5), (2.7, 0, 0.5), (3.6, 0, 2.9)),
    )
    south = window(*panes)
    against_pairs(scene, [south], blind("tree4"), peak=peak, device=device)


def eye_to(sun, position=(2.0, 3.0, 1.2), kind="angular", turn=(0.0, 0.0, 0.0)):
    """A fisheye that looks almost to the sun."""
    return View(
        kind=kind, horizontal=180, vertical=180, position=np.array(position),
        direction=sun + np.array(turn),
    )  # fmt: skip


@pytest.mark.parametrize("size", [1, 2, 5, 16, 101, 400])
@pytest.mark.parametrize("kind", ["angular", "hemispherical"])
def test_solar_disc_is_exact_in_any_resolution(device, size, kind):
    """Through clear air: Σ L Ω = E; the sun is in a pixel corner if `size` is even."""
    scene, south = box(4, 5, 3, 0.0)
    sun = towards(175, 25)
    view = eye_to(sun, kind=kind)
    found = picture_sun_coefficients(
        scene, [south], "south", clear_air(KLEMS), Camera(view, size, size),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    angle = solid_angles(view, size, size).ravel()
    assert found.values[0, :, 0] @ angle == pytest.approx(1, rel=1e-4)
    # At most four pixels share the disc, if they are larger than it
    count = np.count_nonzero(found.values[0])
    assert count <= 4 if size <= 101 else count <= 16


@pytest.mark.parametrize("turn", [(0, 0, 0), (0.4, 0, 0.2), (-0.3, 0.9, 0.8)])
def test_eye_receives_the_direct_irradiance(device, turn):
    """E_v = cos θ, for suns in the middle and at the edge of the view."""
    scene, south = box(4, 5, 3, 0.0)
    sun, size = towards(175, 25), 200
    view = eye_to(sun, turn=turn)
    found = picture_sun_coefficients(
        scene, [south], "south", clear_air(KLEMS), Camera(view, size, size),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    rays = view.rays(size, size)
    cosine = np.maximum(rays.direction @ view.direction, 0).ravel()
    received = found.values[0, :, 0] * solid_angles(view, size, size).ravel() @ cosine
    assert received == pytest.approx(sun @ view.direction, rel=0.02, abs=0.01)


def test_disc_at_the_edge_of_the_window_is_cut(device):
    """The upper edge of the window passes through the middle of the disc."""
    scene, south = box(4, 5, 3, 0.0)
    sun = towards(180, 30)
    eye = np.array([2.0, 2.0, 3 - 2 * np.tan(np.radians(30))])
    view = eye_to(sun, eye)
    found = picture_sun_coefficients(
        scene, [south], "south", clear_air(KLEMS), Camera(view, 64, 64),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    received = found.values[0, :, 0] @ solid_angles(view, 64, 64).ravel()
    assert received == pytest.approx(0.5, abs=0.05)


def test_small_window_is_found_by_the_sun(device):
    """No path of a coarse picture meets a window of 4 cm, but its sunlight counts."""
    scene, _ = box(4, 5, 3, 0.0)
    sun = towards(180, 30)
    eye = np.array([2.0, 2.0, 1.0])
    x, _, z = eye + sun * 2 / np.cos(np.radians(30))
    corners = ((-1, -1), (-1, 1), (1, 1), (1, -1))
    tiny = window(quad(*((x + 0.02 * a, 0, z + 0.02 * b) for a, b in corners)))
    view = eye_to(sun, eye, turn=(0.3, 0.2, 0.1))
    found = picture_sun_coefficients(
        scene, [tiny], "south", clear_air(KLEMS), Camera(view, 4, 4),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    received = found.values[0, :, 0] @ solid_angles(view, 4, 4).ravel()
    assert received == pytest.approx(1, rel=1e-3)


def test_suns_behind_the_wall_give_nothing(device):
    scene, south = box(4, 5, 3, 0.5)
    suns = np.array([towards(180, 30), towards(0, 30), towards(91, 5), towards(89, 5)])
    for kind in BSDFS:
        for peak in (False, True):
            found = picture_sun_coefficients(
                scene, [south], "south", BSDFS[kind](), camera(size=24),
                suns=suns, peak=peak, samples=4, device=device,
            )  # fmt: skip
            assert found.values[..., 0].max() > 0
            assert not found.values[..., [1, 3]].any()
            assert not found.standard_error[..., [1, 3]].any()


def test_same_seed_gives_the_same_bits_in_work_units_of_any_size(device, monkeypatch):
    scene, windows = two_windows((0.7, 0.4, 0.1))

    def traced(seed):
        paths = picture_window_paths(
            scene, windows, camera(size=24), samples=8, seed=seed, device=device
        )
        lit = picture_sun_coefficients(
            scene, windows, "west", blind("tree4"), camera(size=24),
            suns=np.array([towards(230, 30)]), peak=True, samples=8, seed=seed,
            device=device,
        )  # fmt: skip
        return paths, lit

    first, lit = traced(3)
    again, again_lit = traced(3)
    other, unlike = traced(4)
    monkeypatch.setattr(window_path_jobs, "_PATHS", 1 << 8)
    small, cut = traced(3)
    for one, twin, few, apart in zip(
        first.records, again.records, small.records, other.records, strict=True
    ):
        for name in ("starts", "directions", "zones", "weights"):
            values = getattr(one, name)
            assert np.array_equal(values, getattr(twin, name))
            assert np.array_equal(values, getattr(few, name))
        assert not np.array_equal(one.directions, apart.directions)
    for same in (again_lit, cut):
        assert np.array_equal(lit.values, same.values)
    assert not np.allclose(lit.values, unlike.values, rtol=0.01)


def test_suns_do_not_depend_on_the_block_in_which_they_are_computed(device):
    """A sun has the same radiance alone and among others."""
    scene, south = box(4, 5, 3, 0.5)

    def lit(suns):
        return picture_sun_coefficients(
            scene, [south], "south", blind("tree4"), camera(),
            suns=suns, peak=True, samples=8, device=device,
        )  # fmt: skip

    together, apart = lit(SUNS), [lit(sun[None]) for sun in SUNS[1:3]]
    values = np.concatenate([one.values for one in apart], axis=-1)
    np.testing.assert_allclose(together.values[..., 1:3], values, rtol=1e-5)


VIEWS = {
    "perspective": View(
        kind="perspective", horizontal=70, vertical=60,
        position=np.array([2.1, 4.3, 1.4]), direction=np.array([0.1, -1, -0.5]),
    ),
    "parallel": View(
        kind="parallel", horizontal=3.5, vertical=4.5, position=np.array([2, 2.5, 2.0]),
        direction=np.array([0, 0.1, -1.0]), up=np.array([0, 1.0, 0]),
    ),
    "cylindrical": View(
        kind="cylindrical", horizontal=150, vertical=80,
        position=np.array([2.1, 4.3, 1.4]), direction=np.array([0, -1.0, 0]),
    ),
    "planisphere": View(
        kind="planisphere", horizontal=150, vertical=150,
        position=np.array([2.1, 4.3, 1.4]), direction=np.array([0.1, -1, -0.5]),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", VIEWS)
def test_views_of_every_kind(device, kind):
    scene, south = box(4, 5, 3, 0.5)
    against_pairs(
        scene, [south], blind("tree4"), peak=True, view=VIEWS[kind], device=device
    )


def test_fore_plane_hides_what_is_before_it(device):
    """A screen before the eye is clipped away; it still throws its shadow."""
    scene, south = box(4, 5, 3, 0.5)
    screen = quad((0.5, 3.6, 0), (3.5, 3.6, 0), (3.5, 3.6, 1.6), (0.5, 3.6, 1.6))
    room = Scene(scene.materials, (*scene.surfaces, screen))
    view = replace(VIEWS["perspective"], fore=1.2)
    against_pairs(room, [south], blind("tree4"), peak=True, view=view, device=device)
    # Through clear air the sun is seen over the screen's place
    sun = towards(180, 15)
    fisheye = replace(eye_to(sun, (2.0, 4.3, 1.0)), fore=1.2)
    found = picture_sun_coefficients(
        room, [south], "south", clear_air(KLEMS), Camera(fisheye, 64, 64),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    shown = found.values.max()
    hidden = picture_sun_coefficients(
        room, [south], "south", clear_air(KLEMS),
        Camera(replace(fisheye, fore=0), 64, 64),
        suns=sun[None], peak=True, samples=2, device=device,
    )  # fmt: skip
    assert shown > 0
    assert hidden.values.max() < 0.01 * shown


def test_luminance_of_bands_is_weighted(device):
    """`received` with photometric weights is the weighted sum of the bands."""
    scene, south = box(4, 5, 3, (0.7, 0.4, 0.1))
    small = camera(size=24)
    paths = picture_window_paths(scene, [south], small, samples=8, device=device)
    lit = in_sunlight(paths, "south", blind("tree4"), suns=SUNS, peak=True)

    # One sun at each step; the second is dark
    normal = csc_array(np.diag([500.0, 0, 800.0, 300.0]))
    by_band = lit.received(normal, np.eye(3))
    weighted = lit.received(normal, RGB.weights[None])
    expected = np.einsum("b,tbps->tps", RGB.weights, by_band.batches)
    np.testing.assert_allclose(weighted.batches[:, 0], expected, rtol=1e-3, atol=1e-3)
    assert weighted.steps.tolist() == by_band.steps.tolist() == [0, 2, 3]
    assert weighted.mean(slice(None)).mean() > 1

    # The same sun at another step, and in a longer block
    last = csc_array((np.array([500.0]), ([0], [2])), shape=(4, 3))
    first = csc_array((np.array([500.0]), ([0], [0])), shape=(4, 5))
    late, early = (lit.received(n, RGB.weights[None]) for n in (last, first))
    assert np.array_equal(late.batches, early.batches)
    assert late.steps.tolist() == [2]
    assert early.steps.tolist() == [0]


def test_beams_that_are_kept_are_those_of_single_blocks(device):
    """Suns traced together, in two calls, give the light of suns traced alone."""
    scene, south = box(4, 5, 3, 0.5)
    paths = picture_window_paths(
        scene, [south], camera(size=24), samples=8, device=device
    )
    normal = csc_array(np.diag([500.0, 0, 800.0, 300.0]))
    for layer in (clear_air(KLEMS), blind("tree4")):
        alone, kept = (
            in_sunlight(paths, "south", layer, suns=SUNS, peak=True) for _ in range(2)
        )
        weights = RGB.weights[None]
        kept.keep_beams(normal[:, :1], weights)
        kept.keep_beams(normal, weights)
        one, other = (each.received(normal, weights) for each in (alone, kept))
        assert one.steps.tolist() == other.steps.tolist()
        assert one.batches.max() > 1
        most = float(one.batches.max())
        np.testing.assert_allclose(
            other.batches, one.batches, rtol=1e-4, atol=1e-5 * most
        )


def test_radiance_under_suns_that_are_known_is_that_without_memory(device, monkeypatch):
    """Suns asked for before, again and twice; the irradiance is another one."""
    scene, south = box(4, 5, 3, 0.5)
    paths = picture_window_paths(
        scene, [south], camera(size=24), samples=8, device=device
    )
    for layer in (blind("full"), blind("tree4")):
        kept, fresh = (
            in_sunlight(paths, "south", layer, suns=SUNS, peak=True).window
            for _ in range(2)
        )
        suns, irradiance = np.array([0, 1, 2, 2]), np.array([1.0, 2.0, 3.0, 400.0])
        kept.radiance(np.array([2, 0]), np.ones(2))
        found = kept.radiance(suns, irradiance)
        with monkeypatch.context() as patch:
            patch.setattr(sunlit_window, "_KEPT", 0)
            expected = fresh.radiance(suns, irradiance)
        assert expected.max() > 1
        np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_rough_plastic_reflects_the_sun(device):
    """Rough plastic: its highlights are wider than a patch."""
    room, south = box(4, 5, 3, 0.4)
    glossy = Scene(
        {"wall": replace(grey(0.4), specularity=0.05, roughness=0.2)}, room.surfaces
    )
    against_pairs(glossy, [south], blind("full"), device=device)


@pytest.mark.parametrize("kind", ["Klems", "rank 4"])
def test_lambertian_surfaces_reflect_what_paths_find(device, kind):
    """Paths are traced where a material has a highlight, here one of 10⁻⁶."""
    scene, windows = two_windows((0.7, 0.4, 0.1))
    screen = quad((1.5, 1, 0), (2.5, 1, 0), (2.5, 1, 2), (1.5, 1, 2))
    found = []
    for specularity in (0.0, 1e-6):
        matt = replace(scene.materials["wall"], specularity=specularity, roughness=0.2)
        room = Scene({"wall": matt}, (*scene.surfaces, screen))
        paths = picture_window_paths(
            room, windows, camera(size=48), samples=16, device=device
        )
        suns = np.array([towards(200, 30), towards(235, 22)])
        lit = in_sunlight(paths, "south", BSDFS[kind](), suns=suns, peak=True)
        found.append(lit.received(csc_array(np.diag([500.0, 800.0])), np.eye(3)))
    even, traced = (each.batches for each in found)
    assert (even > 0.02 * even.max()).mean() > 0.1
    # Single points at the edges of shadows may be lit or not by rounding
    equal = np.isclose(even, traced, rtol=1e-4, atol=1e-5 * float(even.max()))
    assert equal.mean() > 0.999
    np.testing.assert_allclose(even.sum(axis=2), traced.sum(axis=2), rtol=1e-3)
