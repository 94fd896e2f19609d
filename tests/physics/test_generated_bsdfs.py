"""Generated BSDFs whose every value, or whose sums, have a closed form."""

import itertools

import numpy as np
import pytest

import clerestory as cl
from clerestory.bsdf.analytic import glass_properties
from clerestory.bsdf.patch_overlap import patches_in_cells
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdfgen.film_geometry import mirrored_channels, prismatic
from clerestory.bsdfgen.mirror_symmetry import Orbits
from clerestory.bsdfgen.morton_codes import incident_code
from clerestory.bsdfgen.panes_and_fabrics import clear_pane, diffuse_pane, fabric
from clerestory.bsdfgen.screen_geometry import perforated, woven
from clerestory.bsdfgen.shading_system import SampleArea, system_in_bands
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.engine import device as devices
from clerestory.engine import work_units
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.shirley_chiu import disc_from_square
from clerestory.scene.model import Metal, Plastic, Polygon, Scene
from clerestory.scene.surface import area_vector
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_means, band_set

FUNCTIONS = (
    "transmission_front",
    "transmission_back",
    "reflection_front",
    "reflection_back",
)
BOX = np.array([[0.0, 0, -0.1], [1, 1, 0]])


def sheet(material, z=-0.05):
    """An endless sheet across the cell of one square metre."""
    corners = [(-1, -1, z), (2, -1, z), (2, 2, z), (-1, 2, z)]
    polygon = Polygon(np.array(corners, dtype=float), "m", "sheet")
    return Scene({"m": material}, (polygon,))


def part(bsdf, name):
    return bsdf.functions["visible", name]


@pytest.mark.parametrize("periodic", [True, False])
def test_empty_area_passes_all_light_straight_on(device, periodic):
    """T is diagonal: the exact inverse of the projected solid angles."""
    bsdf = cl.generate_bsdf(
        Scene(),
        area=SampleArea(BOX, periodic),
        basis="half",
        samples=256,
        device=device,
        geometry=False,
    )
    straight = np.diag(1 / klems("half").projected_solid_angles())
    for side in ("front", "back"):
        found = part(bsdf, f"transmission_{side}").values
        # A direction on the very edge of its patch may fall to either side
        assert found == pytest.approx(straight, abs=1e-3 * straight.max())
        assert np.all(part(bsdf, f"reflection_{side}").values == 0)


def test_lambertian_sheet_is_even(device):
    """A sheet that passes 0.4 and reflects 0.3 has the values 0.4/π and 0.3/π."""
    system = diffuse_pane(transmittance=0.4, reflectance=0.3)
    bsdf = cl.generate_bsdf(system, basis="quarter", samples=1 << 14, device=device)
    for name, share in zip(FUNCTIONS, (0.4, 0.4, 0.3, 0.3), strict=True):
        matrix = part(bsdf, name)
        score = (matrix.values - share / np.pi) / matrix.standard_error
        assert np.sqrt(np.mean(matrix.standard_error**2)) < 0.1 * share / np.pi
        # Student's t with 7 degrees of freedom has the variance 7/5
        assert np.mean(score**2) == pytest.approx(7 / 5, rel=0.25)
        assert matrix.direct_hemispherical().mean() == pytest.approx(share, rel=2e-3)


def mean_over(partition, patches, share):
    """Means of a function of the cosine over patches, by projected solid angle."""
    u = np.stack([(np.arange(4000) + 0.5) / 4000, np.full(4000, 0.5)], axis=1)
    cosine = [partition.sample(np.full(4000, p), u)[:, 2] for p in patches]
    return np.array([np.mean(share(c)) for c in cosine])


def of_polished_metal(cosine):
    """Radiance's mirror coat (normal.c): 0.8 upright, growing towards grazing light."""
    return 0.8 + 0.2 * (np.exp(-5.85 * cosine) - 0.00202943064)


def test_mirror_keeps_the_number_of_each_patch(device):
    """A mirror sends patch i to patch i, and nothing through."""
    mirror = Metal("m", np.full(3, 0.8), 1.0, 0.0)
    bsdf = cl.generate_bsdf(
        sheet(mirror),
        area=SampleArea(BOX, periodic=True),
        basis="full",
        samples=256,
        device=device,
    )
    full = klems("full")
    expected = mean_over(full, range(len(full)), of_polished_metal)
    measure = full.projected_solid_angles()
    for side in ("front", "back"):
        found = part(bsdf, f"reflection_{side}").values * measure[:, None]
        # A direction on the very edge of its patch may fall to either side
        assert np.diag(found) == pytest.approx(found.sum(axis=0), rel=0.02)
        assert found.sum(axis=0) == pytest.approx(expected, rel=2e-3)
        assert np.all(part(bsdf, f"transmission_{side}").values == 0)


def test_mirror_turns_light_around_its_normal_in_a_tree(device):
    """What comes from one azimuth leaves at the opposite one, whichever it is."""
    mirror = Metal("m", np.full(3, 0.8), 1.0, 0.0)
    area = SampleArea(BOX, periodic=True)
    bsdf = cl.generate_bsdf(
        sheet(mirror), area=area, basis="tree4", halvings=4, samples=64, device=device
    )
    azimuth = np.radians([10.0, 100.0, 205.0, 290.0])
    for side, z in (("front", -0.8), ("back", 0.8)):
        came = np.stack([0.6 * np.cos(azimuth), 0.6 * np.sin(azimuth)], axis=1)
        incident = np.column_stack([came, np.full(4, z)])
        tree = part(bsdf, f"reflection_{side}")
        left = incident * [-1, -1, 1]
        assert (tree.evaluate(incident, left) > 20).all()
        assert (tree.evaluate(incident, incident) < 1).all()


def test_glass_has_fresnels_shares(device):
    """Each patch of a pane passes and reflects the mean of Fresnel's shares over it."""
    bsdf = cl.generate_bsdf(clear_pane(transmissivity=0.9), samples=1024, device=device)
    full = klems("full")
    u = np.stack([(np.arange(4000) + 0.5) / 4000, np.full(4000, 0.5)], axis=1)
    for patch in (0, 40, 100, 144):
        cosine = full.sample(np.full(4000, patch), u)[:, 2]
        expected = glass_properties(cosine, transmissivity=0.9, index=1.52)
        for name, share in zip(FUNCTIONS[::2], expected, strict=True):
            found = part(bsdf, name).direct_hemispherical()[patch]
            assert found == pytest.approx(float(share.mean()), abs=0.002)


def straight_share(width, spacing, tangent):
    """Share of light that passes black flat slats, by the tangent of its profile."""
    return np.maximum(0, 1 - width * np.abs(tangent) / spacing)


@pytest.mark.parametrize("vertical", [False, True])
def test_black_slats_pass_what_geometry_says(device, vertical):
    """Light at the profile angle α passes flat slats with 1 - (w/s)·|tan α|."""
    width, spacing = 0.05, 0.08
    blind = venetian(
        slat_width=width, spacing=spacing, reflectance=0.0, vertical=vertical
    )
    bsdf = cl.generate_bsdf(blind, basis="full", samples=1 << 13, device=device)
    full = klems("full")
    rng = np.random.default_rng(1)
    for side in ("front", "back"):
        assert np.all(part(bsdf, f"reflection_{side}").values == 0)
        matrix = part(bsdf, f"transmission_{side}")
        found = matrix.direct_hemispherical()
        direction = full.sample(
            np.repeat(np.arange(145), 20000), rng.random((145 * 20000, 2))
        )
        along = direction[:, 0 if vertical else 1] / direction[:, 2]
        expected = straight_share(width, spacing, along).reshape(145, -1).mean(axis=1)
        measure = full.projected_solid_angles()
        error = np.sqrt(((matrix.standard_error * measure[:, None]) ** 2).sum(axis=0))
        assert np.all(error < 0.01)
        assert np.all(np.abs(found - expected) < 5 * error + 2e-3)


def test_microlouvre_cuts_off_at_its_angle(device):
    """No straight light above the cut-off, and some of it just below."""
    cutoff = 40.0
    bsdf = cl.generate_bsdf(
        microlouvre(cutoff_deg=cutoff, reflectance=0.0),
        basis="tree4",
        sides="front",
        halvings=5,
        samples=256,
        device=device,
    )
    for angle, dark in ((30.0, False), (37.0, False), (45.0, True), (60.0, True)):
        alpha = np.radians(angle)
        high_sun = np.array([0.0, np.sin(alpha), -np.cos(alpha)])
        share = bsdf.hemispherical(high_sun, function="transmission_front")
        assert (share < 0.02) == dark, angle


SYSTEMS = {
    "venetian": venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.48),
    "curved": venetian(
        slat_width=0.08,
        spacing=0.072,
        tilt_deg=30,
        rise=0.008,
        reflectance=0.7,
        reflectance_below=0.3,
        vertical=True,
    ),
    "prismatic": prismatic(),
    "mirrored_channels": mirrored_channels(),
    "perforated": perforated(thickness=0.5e-3),
    "woven": woven(),
    "fabric": fabric(openness=0.05, reflectance=0.5, diffuse_transmittance=0.1),
}


def total_of(bsdf, side):
    """Light in all from each patch, and its error as if values were independent."""
    parts = [part(bsdf, f"{kind}_{side}") for kind in ("transmission", "reflection")]
    measure = parts[0].exits.projected_solid_angles()[:, None]
    square = sum(np.sum((p.standard_error * measure) ** 2, axis=0) for p in parts)
    return sum(p.direct_hemispherical() for p in parts), np.sqrt(square)


@pytest.mark.parametrize("kind", SYSTEMS)
def test_systems_keep_energy_and_reciprocity(device, kind):
    """No more light leaves than came, and light goes the same ways forth and back."""
    bsdf = cl.generate_bsdf(
        SYSTEMS[kind], basis="quarter", samples=4096, seed=3, device=device
    )
    for side in ("front", "back"):
        total, error = total_of(bsdf, side)
        assert np.all(total <= 1 + 4 * error)
        assert np.all(error < 0.015)
    pairs = (
        ("transmission_front", "transmission_back"),
        ("reflection_front", "reflection_front"),
        ("reflection_back", "reflection_back"),
    )
    for name, other in pairs:
        forth, back = part(bsdf, name), part(bsdf, other)
        turned = back.reciprocal()
        error = np.hypot(
            forth.standard_error,
            type(back)(back.standard_error, back.exits, back.incidents)
            .reciprocal()
            .values,
        )
        # Values that only a few paths reached have errors that are not known themselves
        known = (error < 0.1 * (forth.values + turned.values)) & (error > 0)
        score = (forth.values - turned.values)[known] / error[known]
        assert np.sqrt(np.mean(score**2)) < 1.6
        assert abs(forth.diffuse() - back.diffuse()) < 0.01


def test_lossless_systems_lose_nothing(device):
    """A clear film and mirrors of reflectance 1 absorb no light."""
    for system in (prismatic(), mirrored_channels(reflectance=1.0)):
        bsdf = cl.generate_bsdf(system, basis="quarter", samples=1 << 14, device=device)
        for side in ("front", "back"):
            total, error = total_of(bsdf, side)
            assert np.all(np.abs(total - 1) < 4 * error)
            assert np.all(error < 0.008)


def test_mirrored_patches_are_traced_once(device):
    """With and without the system's own mirror, within the errors, as often."""
    made = [
        cl.generate_bsdf(
            SYSTEMS["venetian"],
            basis="quarter",
            samples=4096,
            seed=seed,
            symmetry=symmetry,
            device=device,
        )
        for seed, symmetry in ((1, True), (2, False))
    ]
    left_right = Orbits.of(klems("quarter"), ((1, 1), (-1, 1))).flips[1]
    for name in FUNCTIONS:
        one, other = (part(b, name) for b in made)
        assert np.array_equal(one.values, one.values[np.ix_(left_right, left_right)])
        error = np.hypot(one.standard_error, other.standard_error)
        known = error > 0
        score = (one.values - other.values)[known] / error[known]
        # Student's t with 7 and 7 degrees of freedom has the variance 7/6
        assert np.mean(score**2) == pytest.approx(7 / 6, rel=0.25)
        sizes = [np.sqrt(np.mean(p.standard_error**2)) for p in (one, other)]
        assert sizes[0] == pytest.approx(sizes[1], rel=0.1)


def test_white_slats_lose_nothing(device):
    """All light leaves to one side or the other, of an endless blind and a short one.

    Mirrored patches are traced once and share their paths, so that totals vary.
    """
    shape = {"slat_width": 0.08, "spacing": 0.08, "tilt_deg": 60, "reflectance": 1.0}
    endless, few = (
        cl.generate_bsdf(
            venetian(**shape, **more), basis="quarter", samples=2048, device=device
        )
        for more in ({}, {"slats": 3})
    )
    for bsdf in (endless, few):
        total, error = total_of(bsdf, "front")
        assert np.all(np.abs(total - 1) < 4 * error + 1e-5)
        assert np.all(error < 0.02)


def test_two_bands_are_traced_at_once(device):
    """Visible and solar values follow their own reflectances."""
    blind = venetian(
        slat_width=0.05,
        spacing=0.05,
        tilt_deg=80,
        reflectance=0.8,
        solar_reflectance=0.4,
    )
    both = cl.generate_bsdf(blind, basis="quarter", samples=8192, device=device)
    assert both.channels == ("visible", "solar")
    for band, reflectance in (("visible", 0.8), ("solar", 0.4)):
        alone = cl.generate_bsdf(
            venetian(
                slat_width=0.05, spacing=0.05, tilt_deg=80, reflectance=reflectance
            ),
            basis="quarter",
            samples=8192,
            seed=7,
            device=device,
        )
        one = both.diffuse("reflection_front", channel=band)
        assert one == pytest.approx(alone.diffuse("reflection_front"), rel=0.01)


def test_coloured_matrices_keep_their_colour(device):
    """RGB of the transmission matrix is that of a coloured sheet."""
    rgb = np.array([0.6, 0.4, 0.2])
    paint = Plastic("m", rgb)
    bsdf = cl.generate_bsdf(
        sheet(paint),
        area=SampleArea(BOX, periodic=True),
        basis="quarter",
        colour=True,
        samples=4096,
        device=device,
    )
    x, z = (bsdf.diffuse("reflection_front", channel=c) for c in ("cie-x", "cie-z"))
    y = bsdf.diffuse("reflection_front")
    # Radiance's primaries: X and Z of unit red, green and blue
    assert x / y == pytest.approx(
        np.dot([0.5142, 0.3239, 0.1619], rgb) / np.dot([0.2651, 0.6701, 0.0648], rgb),
        rel=1e-3,
    )
    assert z / y == pytest.approx(
        np.dot([0.0241, 0.1229, 0.8530], rgb) / np.dot([0.2651, 0.6701, 0.0648], rgb),
        rel=1e-3,
    )


def tree_from_the_room(system, device, *, halvings, samples):
    """Rank 4 trees of light from the room."""
    return cl.generate_bsdf(
        system,
        basis="tree4",
        halvings=halvings,
        samples=samples,
        sides="back",
        device=device,
    )


@pytest.mark.parametrize("kind", ["venetian", "prismatic", "microlouvre"])
def test_trees_keep_the_light_of_matrices(device, kind):
    """In all, a tree scatters what the matrix does, to half a percent."""
    system = SYSTEMS.get(kind) or microlouvre()
    matrix = cl.generate_bsdf(system, samples=2048, sides="back", device=device)
    tree = tree_from_the_room(system, device, halvings=4, samples=1024)
    for name in ("transmission_back", "reflection_back"):
        one, other = (b.diffuse(name) for b in (matrix, tree))
        assert other == pytest.approx(one, rel=0.005, abs=0.001)
        cells = part(tree, name)
        error = cells.standard_error.extrema()[1]
        assert 0 < error < cells.extrema()[1]


def counted(system, halvings, device, *, samples, back=True):
    """Bare counts of light from each incident cell: all from the room, or what passes.

    What passes is that of light from the sky.
    """
    engine = devices.load(device, "sample_area_tree")
    area = system.area
    slab = engine.lower_slab(system.scene, area.slab(), periodic=area.periodic)
    grid = engine.Grid(4, halvings, min(halvings, 4))
    rows = np.arange(grid.incidents)
    light = np.zeros((1 << halvings, 1 << halvings))
    for block in range(grid.blocks):
        start = {"back": back, "segments": 1 << 30, "seed": 9}
        found = engine.trace_block(slab, grid, block, [(rows, 0, samples)], **start)
        number = block * grid.incidents + rows
        one, other = (
            sum((n >> bit) & (1 << bit) for bit in range(halvings))
            for n in (number, number >> 1)
        )
        for score in found if back else found[:1]:
            which = incident_code(score.cell, rank=4, levels=grid.block)
            sums = np.bincount(which, score.sums[:, 0], minlength=len(rows))
            light[one, other] += sums / samples
    return light.ravel()


@pytest.mark.parametrize("kind", ["venetian", "prismatic", "microlouvre"])
@pytest.mark.parametrize(
    ("halvings", "samples"),
    [
        (4, 4096),
        pytest.param(5, 4096, marks=pytest.mark.slow),
    ],
)
def test_trees_keep_the_light_of_each_incident_patch(device, kind, halvings, samples):
    """As bare counts of other paths have it, on the same cells, in Klems' patches."""
    system = SYSTEMS.get(kind) or microlouvre()
    tree = tree_from_the_room(system, device, halvings=halvings, samples=samples)
    full = klems("full")
    cells = patches_in_cells(full, halvings)
    bare = cells @ counted(system, halvings, device, samples=samples)
    bare /= np.asarray(cells.sum(axis=1)).ravel()
    total = sum(
        part(to_matrices(tree, full), name).direct_hemispherical()
        for name in ("transmission_back", "reflection_back")
    )
    paths = samples * 4**halvings * full.projected_solid_angles() / np.pi
    # Roulette makes a variance of about 0.25 a path where nothing is lost
    error = np.sqrt(2 * bare * np.maximum(1 - bare, 0.25) / paths)
    assert np.all(np.abs(total - bare) < 0.005 + 2 * error)
    assert np.all(total < 1.005 + 2 * error)


def test_trees_from_the_room_keep_the_light_of_the_sky(device):
    """One transmission is read both ways: by reciprocity, the sun shines through it.

    Level slats pass light by its profile angle, over which diffuse cells are joined.
    Bare counts are those of light from the sky; what leaves through a cell has more
    noise than what comes to it, since each path is there or not.
    """
    halvings, samples = 5, 512
    system = venetian(slat_width=0.08, spacing=0.072, reflectance=0.48)
    tree = tree_from_the_room(system, device, halvings=halvings, samples=samples)
    edge = (np.arange(1 << halvings) + 0.5) / (1 << halvings)
    place = np.meshgrid(edge, edge, indexing="ij")
    x, y = (part.ravel() for part in disc_from_square(*place))
    direction = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=1)
    total = part(tree, "transmission_back").reciprocal().hemispherical(direction)
    bare = counted(system, halvings, device, samples=samples, back=False)
    profile_deg = np.degrees(np.arctan2(np.abs(y), direction[:, 2]))
    for low in range(0, 80, 10):
        of = (profile_deg >= low) & (profile_deg < low + 10)
        mean = bare[of].mean()
        error = np.sqrt(mean * (2 - mean) / (samples * of.sum()))
        assert total[of].mean() == pytest.approx(mean, abs=0.005 + 3 * error)


def test_straight_light_keeps_its_energy_in_trees(device):
    """All light of an empty area passes, and fills the cell that goes straight on."""
    bsdf = cl.generate_bsdf(
        Scene(),
        area=SampleArea(BOX, periodic=True),
        basis="tree4",
        halvings=4,
        samples=256,
        geometry=False,
        device=device,
    )
    direction = np.array([[0.2, 0.3, -0.93], [-0.5, 0.1, -0.86], [0.0, 0.02, -1.0]])
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    share = bsdf.hemispherical(direction, function="transmission_front")
    assert share == pytest.approx(1, rel=1e-5)
    straight = bsdf.evaluate(direction, -direction)
    assert straight == pytest.approx(4**4 / np.pi, rel=1e-5)


@pytest.mark.parametrize("basis", ["quarter", "tree4"])
def test_the_same_seed_gives_the_same_bits(device, basis):
    """Sums are exact integers: no order of additions changes them."""
    options = {"basis": basis, "halvings": 3, "samples": 300, "device": device}
    one, two = (
        cl.generate_bsdf(SYSTEMS["venetian"], seed=5, **options) for _ in range(2)
    )
    for key, matrix in one.functions.items():
        name = "values" if basis == "quarter" else "slots"
        assert np.array_equal(getattr(matrix, name), getattr(two.functions[key], name))


def test_the_error_aimed_at_is_reached(device):
    """The root mean square of all errors, over the mean value, is as small as asked."""
    bsdf = cl.generate_bsdf(
        SYSTEMS["venetian"], basis="quarter", relative_error=0.2, device=device
    )
    parts = list(bsdf.functions.values())
    error = np.sqrt(np.mean([p.standard_error**2 for p in parts]))
    assert error <= 0.2 * np.mean([p.values for p in parts]) * (1 + 1e-6)


# Reflectances of a paint that absorbs blue
PAINT = Spectrum(np.array([400.0, 500.0, 600.0, 700.0]), np.array([0.1, 0.3, 0.7, 0.8]))


def test_bands_share_the_paths_of_a_blind(device, monkeypatch):
    """A slit between painted slats: each band as if it was traced alone.

    All bands are traced in one pass. The first and last of twenty bands have other
    throughputs by a factor of eight.
    """
    blind = venetian(slat_width=0.05, spacing=0.05, tilt_deg=70, specularity=0.02)
    bands = band_set("20")
    effort = {"basis": "quarter", "samples": 4096, "device": device}
    spectra = {"upper": PAINT}
    system = system_in_bands(blind, bands, spectra=spectra)
    monkeypatch.setattr(work_units, "band_groups", lambda _: pytest.fail("by threes"))
    together = cl.generate_bsdf(system, **effort)
    monkeypatch.undo()
    assert together.channels == ("visible", *bands.names)
    values = band_means(PAINT, bands)
    for number in (0, 9, 19):
        alone = cl.generate_bsdf(
            venetian(
                slat_width=0.05,
                spacing=0.05,
                tilt_deg=70,
                reflectance=values[number],
                specularity=0.02,
            ),
            seed=11,
            **effort,
        )
        for name in FUNCTIONS:
            own = together.functions[bands.names[number], name]
            other = part(alone, name)
            error = np.hypot(row_error(own), row_error(other))
            shares, known = (f.direct_hemispherical() for f in (own, other))
            assert (np.abs(shares - known) < 4 * error + 1e-4).all()
            assert shares.mean() == pytest.approx(known.mean(), rel=0.01)


def row_error(function):
    """Standard error of direct-hemispherical values, from independent single ones."""
    measure = function.exits.projected_solid_angles()[:, None]
    return np.sqrt(np.square(function.standard_error * measure).sum(axis=0))


def bowl(azimuths=48, rings=12, half=1.05):
    """A hemispherical bowl below the hole of a black plate, and its two areas [m²]."""
    phi = np.arange(azimuths + 1) * 2 * np.pi / azimuths
    round_ = np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=1)
    square = half * round_ / np.abs(round_).max(axis=1, keepdims=True)
    theta = np.linspace(0, np.pi / 2, rings + 1)
    circles = [np.cos(t) * round_ - [0, 0, np.sin(t)] for t in theta]
    quads = [("black", square, circles[0])]
    quads += [("paint", above, below) for above, below in itertools.pairwise(circles)]
    polygons = []
    for name, outer, inner in quads:
        for k in range(azimuths):
            corners = np.array([outer[k], outer[k + 1], inner[k + 1], inner[k]])
            if np.allclose(inner[k], inner[k + 1]):
                corners = corners[:3]
            polygons.append(Polygon(corners, name, f"{name}{len(polygons)}"))
    areas = [np.linalg.norm(area_vector(one.vertices)) for one in polygons]
    painted = sum(areas[azimuths:])
    materials = {
        "paint": Plastic("paint", np.full(3, 0.5)),
        "black": Plastic("black", np.zeros(3)),
    }
    opening = 4 * half**2 - sum(areas[:azimuths])
    return Scene(materials, tuple(polygons)), opening, painted


def test_bands_of_a_bowl_are_those_of_its_closed_form(device):
    """Diffuse light on a spherical cavity: R = ρF / (1 − ρ(1 − F)), F = A₀ / A.

    Every point of a sphere sees the opening by the same factor, the ratio of the area
    of the opening to that of the wall, here a half.
    """
    scene, opening, wall = bowl()
    factor = opening / wall
    assert factor == pytest.approx(0.5, rel=0.01)
    bands = band_set("20")
    painted = cl.in_bands(scene, bands, spectra={"paint": PAINT})
    bsdf = cl.generate_bsdf(
        painted, basis="quarter", samples=8192, sides="back", device=device
    )
    share = opening / (2 * 1.05) ** 2
    for name, rho in zip(bands.names, band_means(PAINT, bands), strict=True):
        found = bsdf.diffuse("reflection_back", channel=name)
        expected = share * rho * factor / (1 - rho * (1 - factor))
        assert found == pytest.approx(expected, rel=0.01), name
        assert bsdf.diffuse("transmission_back", channel=name) < 1e-4


def test_trees_have_three_bands(device):
    """Tensor trees are traced in three channels only."""
    scene = cl.in_bands(sheet(Plastic("m", np.full(3, 0.5))), band_set("20"))
    area = SampleArea(BOX, periodic=True)
    with pytest.raises(InputError, match="trees of a scene"):
        cl.generate_bsdf(scene, area=area, basis="tree3", device=device)


def test_systems_with_a_solar_band_have_no_spectral_bands():
    pane = venetian(
        slat_width=0.05, spacing=0.05, reflectance=0.4, solar_reflectance=0.3
    )
    with pytest.raises(InputError, match="visible, solar"):
        system_in_bands(pane, band_set("20"), spectra={})
