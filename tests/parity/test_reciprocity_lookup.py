"""Which value of a file that is not reciprocal lights a room: by quadrature.

The four functions of the layer are independent random tables, so that a value looked up
in reverse is another value. Radiance and we are asked for the same sun, and compared
with sums over the file's values.
"""

import numpy as np
import pytest
from radiance import run

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.quality_checks import check
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.scene.model import (
    BsdfSurface,
    DistantSource,
    Light,
    Polygon,
    Scene,
)
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

QUARTER = klems("quarter")
SUN = np.array([0.3, -0.7, 0.65]) / np.linalg.norm([0.3, -0.7, 0.65])
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))

# A pane in the plane y = 0, between the eye and the sun; the room is at y > 0
SIZE = 4.0
CORNERS = SIZE * np.array([[0, 0, 0], [0, 0, 1.0], [1, 0, 1], [1, 0, 0]])
FRAME = Frame.from_normal_up(np.array([0, 1.0, 0]), np.array([0, 0, 1.0]))
AXES = np.stack([FRAME.right, FRAME.up, FRAME.normal], axis=-1)
EYE = np.array([1.9, 1.1, 1.7])


@pytest.fixture(scope="module")
def layer():
    """All values between 0.02 and 0.18, which absorb half of the light."""
    rng = np.random.default_rng(5)
    parts = {
        ("visible", name): ScatteringMatrix(
            0.02 + 0.16 * rng.random((41, 41)), QUARTER, QUARTER
        )
        for name in FUNCTIONS
    }
    return Bsdf(parts)


def sunlit(layer, sun=SUN):
    """The pane in the sun of unit normal irradiance, and nothing else."""
    surface = BsdfSurface("layer", layer, 0.0, np.array([0, 0, 1.0]))
    light = Light("sun", np.full(3, 1 / SUN_SR))
    return Scene(
        {"layer": surface, "sun": light},
        (Polygon(CORNERS, "layer", "pane"),),
        (DistantSource(sun, 0.533, "sun", "sun"),),
    )


def pane():
    return Window("pane", (Polygon(CORNERS, "layer", "pane"),), FRAME, QUARTER)


def forwards(layer, leaving):
    """Radiance towards `leaving`: the file's light from the sun into the room."""
    part = layer.functions["visible", "transmission_front"]
    incident = np.broadcast_to(SUN @ AXES, leaving.shape)
    return part.evaluate(incident, leaving @ AXES) * -(SUN @ FRAME.normal)


def backwards(layer, leaving):
    """The same with the file's light from the room to the sun, in reverse."""
    part = layer.functions["visible", "transmission_back"]
    incident = np.broadcast_to(SUN @ AXES, leaving.shape)
    return part.evaluate(leaving @ AXES, incident) * -(SUN @ FRAME.normal)


def view(size):
    """A view of the pane, the unit vectors from the pane, and which pixels are inside.

    Pixels on the edge of two patches are left out.
    """
    camera = cl.parse_view("-vtv -vp 1.9 1.1 1.7 -vd 0 -1 -0.1 -vu 0 0 1 -vh 70 -vv 70")
    back = -camera.rays(size, size).direction.reshape(-1, 3)
    step = 2 / size
    near = [back + step * np.array(d) for d in np.eye(3)]
    near += [back - step * np.array(d) for d in np.eye(3)]
    patch = QUARTER.find(back @ AXES)
    inner = np.all(
        [
            QUARTER.find(n / np.linalg.norm(n, axis=1, keepdims=True) @ AXES) == patch
            for n in near
        ],
        axis=0,
    )
    reach = EYE[1] / back[:, 1]
    place = EYE - reach[:, None] * back
    inner &= np.all((place[:, [0, 2]] > 0.1) & (place[:, [0, 2]] < 3.9), axis=1)
    return camera, back, inner


def illuminated(layer, eye, normal, look, cells=400):
    """∫ L cos θ dω over the pane, with L by `look`."""
    x = (np.arange(cells) + 0.5) / cells * SIZE
    place = np.stack(np.meshgrid(x, [0.0], x, indexing="ij"), -1).reshape(-1, 3)
    line = eye - place
    distance2 = np.sum(line**2, axis=1)
    leaving = line / np.sqrt(distance2)[:, None]
    cosines = np.maximum(-leaving @ normal, 0) * (leaving @ FRAME.normal)
    return float(
        (look(layer, leaving) * cosines / distance2).sum() * (SIZE / cells) ** 2
    )


def test_pictures_show_light_forwards(layer):
    camera, leaving, inner = view(24)
    expected = forwards(layer, leaving)
    assert inner.sum() > 100
    made = cl.render(sunlit(layer), camera, columns=24, rows=24, samples=64, seed=1)
    shown = made.picture.radiance[:, :, 1].ravel()
    assert shown[inner] == pytest.approx(expected[inner], rel=2e-3)
    direct = picture_sun_coefficients(
        Scene({}, ()), [pane()], "pane", layer, Camera(camera, 24, 24),
        suns=SUN[None], samples=64, seed=1,
    )  # fmt: skip
    assert direct.values[0, inner, 0] == pytest.approx(expected[inner], rel=2e-3)


def test_sensors_and_matrices_hold_light_forwards(layer):
    """Also V T D s with one bright patch, which is the flux of the same values."""
    back = np.array([0, -1.0, 0])
    sensors = Sensors(EYE[None], back[None])
    expected = illuminated(layer, EYE, back, forwards)
    other = illuminated(layer, EYE, back, backwards)
    assert abs(other / expected - 1) > 0.05
    found = cl.irradiance(sunlit(layer), sensors, samples=1 << 16, seed=1)
    assert found.error[0, 1] < 0.005 * expected
    assert abs(found.irradiance[0, 1] - expected) < 4 * found.error[0, 1]
    direct = sun_coefficients(
        Scene({}, ()), [pane()], "pane", layer,
        sensors=sensors, suns=SUN[None], samples=1 << 15, seed=2,
    )  # fmt: skip
    error = direct.standard_error[0, 0, 0]
    assert error < 0.005 * expected
    assert abs(direct.values[0, 0, 0] - expected) < 4 * error
    patch = int(QUARTER.find(-SUN @ AXES))
    through = cl.view_matrix(
        Scene({}, ()), pane(), sensors=sensors, samples=1 << 16, bounces=1, seed=3
    )
    column = layer.transmission_matrix().values[0, :, patch]
    bright = column / QUARTER.projected_solid_angles()[patch] * -(SUN @ FRAME.normal)
    assert through.values[0, 0] @ bright == pytest.approx(expected, rel=0.01)


def seen_by_rtrace(folder, name, bsdf, leaving, sun):
    """Luminance of the pane by rtrace, without jitter of directions."""
    rays = "\n".join(
        " ".join(f"{x:.9g}" for x in (*EYE, *-direction)) for direction in leaving
    )
    corners = " ".join(f"{x:g}" for x in CORNERS.ravel())
    write_bsdf(folder / f"{name}.xml", bsdf)
    (folder / f"{name}.rad").write_text(
        f"void BSDF layer 6 0 {name}.xml 0 0 1 . 0 0\n"
        f"layer polygon pane 0 0 12 {corners}\n"
        f"void light sun 0 0 3 {(3 * f' {1 / SUN_SR}')}\n"
        f"sun source disc 0 0 4 {sun[0]} {sun[1]} {sun[2]} 0.533\n"
    )
    seen = run(
        f"oconv {name}.rad > {name}.oct; rtrace -h- -ab 0 -ss 0 -dj 0 {name}.oct",
        folder=folder,
        stdin=rays,
    )
    return np.array(seen.split(), float).reshape(-1, 3)[:, 1]


def test_radiance_looks_up_the_eye_as_source(layer, tmp_path):
    """Except in files of one transmission. The doctor states the ratio of the two."""
    _, leaving, inner = view(24)
    leaving = leaving[inner]
    front = dict(layer.functions)
    del front["visible", "transmission_back"]
    for name, bsdf, look in (
        ("both", layer, backwards),
        ("front", Bsdf(front), forwards),
    ):
        found = seen_by_rtrace(tmp_path, name, bsdf, leaving, SUN)
        assert found == pytest.approx(look(layer, leaving), rel=1e-3)
    finding = next(
        f for f in check(layer) if f.name == "reciprocity" and "transmission" in f.where
    )
    ratio = backwards(layer, leaving) / forwards(layer, leaving)
    words = finding.what.partition("reverse are ")[2].split()
    low, high = float(words[0]), float(words[2])
    assert ratio.min() < low < 1 < high < ratio.max()


def test_reflections_too(layer, tmp_path):
    """A sun on the room side: ours forwards, Radiance's in reverse."""
    camera, leaving, inner = view(24)
    lamp = SUN * [1, -1, 1]
    part = layer.functions["visible", "reflection_back"]
    incident, away = np.broadcast_to(lamp @ AXES, leaving.shape), leaving @ AXES
    slant = lamp @ FRAME.normal
    expected = part.evaluate(incident, away)[inner] * slant
    reverse = part.evaluate(away, incident)[inner] * slant
    scene = sunlit(layer, lamp)
    made = cl.render(scene, camera, columns=24, rows=24, samples=64, seed=1)
    shown = made.picture.radiance[:, :, 1].ravel()[inner]
    assert shown == pytest.approx(expected, rel=2e-3)
    found = seen_by_rtrace(tmp_path, "reflection", layer, leaving[inner], lamp)
    assert found == pytest.approx(reverse, rel=1e-3)
    assert np.abs(reverse / expected - 1).max() > 0.3
