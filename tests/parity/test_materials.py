"""Every material looks and scatters as Radiance's does.

A sheet is seen under a small sun, where Radiance evaluates its formulas exactly, and
under a dome of two unequal halves, where it samples. Solids that refract are seen as
balls before the dome, where Radiance follows every ray.
"""

import numpy as np
import pytest
from material_texts import SHEETS
from radiance import run

from clerestory.engine import device as devices

# Mitsuba and Dr.Jit exist once a device was started
devices.load("cpu")

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.radiance.rad_reader import read_rad


def unit(*vector):
    return np.array(vector) / np.linalg.norm(vector)


SHEET = "\nm polygon s 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"

SUNS = [unit(-0.5, 0, 0.9), unit(-0.6, -0.6, 0.5), unit(0.6, 0.7, -0.3)]
SUN_DEG = 0.5
SUN_RADIANCE = 1e5

# To the viewer: from above at three angles, and from below
VIEWS = [unit(0.3, 0.1, 0.9), unit(0.6, 0.5, 0.5), unit(-0.1, 0.5, 0.6), -SUNS[0]]

BRIGHT = unit(0.3, -0.5, 0.8)
DOME = "".join(
    f"void glow {name} 0 0 4 {value} {value} {value} 0\n"
    f"{name} source {name} 0 0 4 {x} {y} {z} 180\n"
    for name, value, (x, y, z) in (("bright", 3, BRIGHT), ("dark", 1, -BRIGHT))
)


def seen_by_radiance(folder, scene, rays, options):
    """Radiance along rays, by rtrace."""
    (folder / "scene.rad").write_text(scene)
    text = "\n".join(" ".join(f"{x:.15g}" for x in ray) for ray in rays)
    command = f"oconv scene.rad > scene.oct; rtrace -h -w {options} scene.oct"
    return np.fromstring(run(command, folder=folder, stdin=text), sep=" ").reshape(
        -1, 3
    )


def material(folder):
    """The material m of the scene, on the device."""
    materials.register()
    return materials.load(read_rad(folder / "scene.rad").materials["m"])


def interaction(n, view):
    """Points of the sheet, seen from a direction."""
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.wi = si.to_local(mi.Vector3f(view.astype("f4")))
    si.t = 1
    return si


def dome(direction):
    """Radiance of the dome, by direction."""
    return dr.select(dr.dot(direction, mi.Vector3f(BRIGHT.astype("f4"))) > 0, 3.0, 1.0)


def numbers(n, rng):
    """Random numbers for n samples."""
    a, b, c = rng.random((3, n), dtype="f4")
    return mi.Float(a), mi.Point2f(b, c)


def mean(samples):
    """Mean over samples and its standard error, by channel."""
    values = np.broadcast_to(samples.numpy(), (3, dr.width(samples)))
    return values.mean(axis=1), values.std(axis=1) / np.sqrt(values.shape[1])


@pytest.mark.parametrize("sun", SUNS, ids=["high", "low", "behind"])
@pytest.mark.parametrize("name", SHEETS)
def test_sunlit_sheets_are_as_bright(tmp_path, name, sun):
    """What arrives from a lamp is the formula, times the solid angle of the lamp."""
    x, y, z = sun
    lamp = f"void light sun 0 0 3 {SUN_RADIANCE} {SUN_RADIANCE} {SUN_RADIANCE}\n"
    lamp += f"sun source sun 0 0 4 {x} {y} {z} {SUN_DEG}\n"
    truth = seen_by_radiance(
        tmp_path,
        SHEETS[name] + SHEET + lamp,
        [(*(0.9 * view), *-view) for view in VIEWS],
        "-ab 0 -dj 0 -ds 0 -dc 1 -dt 0 -st 0 -ss 0 -lw 0 -lr 6",
    )
    bsdf = material(tmp_path)
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))
    for view, expected in zip(VIEWS, truth, strict=True):
        if view @ sun < -0.999:
            continue  # the sun itself, seen through the sheet
        si = interaction(1, view)
        local = si.to_local(mi.Vector3f(sun.astype("f4")))
        value = bsdf.eval(materials.lamp_context(), si, local).numpy().ravel()
        found = value * SUN_RADIANCE * solid_angle
        # Radiance widens highlights by the size of the sun, 0.25 mrad² in slope²
        assert found == pytest.approx(expected, rel=2e-3, abs=1e-4)


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_under_a_dome_are_as_bright(tmp_path, name):
    """Means of samples of ours and of Radiance's, at angles up to 60°.

    Radiance samples a transmitted highlight with another lobe than it evaluates for
    lamps, narrower in the plane of incidence and of constant share; ours is the
    latter. The two differ by less than 2 % here, and by more towards grazing angles.
    """
    n, again = 1 << 18, 32
    rays = [(*(0.9 * view), *-view) for view in VIEWS for _ in range(again)]
    options = "-ab 1 -aa 0 -ad 512 -as 0 -st 0 -ss 128 -lw 1e-9 -lr 6"
    text = SHEETS[name] + SHEET + DOME
    seen = seen_by_radiance(tmp_path, text, rays, options).reshape(-1, again, 3)
    truth, spread = seen.mean(axis=1), seen.std(axis=1, ddof=1) / np.sqrt(again)
    assert np.all(spread < 0.01 * truth + 1e-6)
    bsdf, rng = material(tmp_path), np.random.default_rng(1)
    for view, expected, error in zip(VIEWS, truth, spread, strict=True):
        si = interaction(n, view)
        sample, weight = bsdf.sample(mi.BSDFContext(), si, *numbers(n, rng))
        found, own = mean(weight * dome(si.to_world(sample.wo)))
        allowed = 4 * np.hypot(own, error) + (0.02 if "trans" in name else 0) * expected
        assert np.all(own < 0.005 * expected + 1e-6)
        assert np.all(np.abs(found - expected) <= allowed + 1e-5)


BALLS = {
    "ball": ("void dielectric m 0 0 5 .3 .6 .9 1.5 0", ["m sphere s 0 0 4 0 0 0 1"]),
    "dispersing": (
        "void dielectric m 0 0 5 .3 .6 .9 1.4 20",
        ["m sphere s 0 0 4 0 0 0 1"],
    ),
    "interface": (
        "void interface m 0 0 8 .3 .6 .9 1.3 1 1 1 1.5",
        ["m sphere s 0 0 4 0 0 0 1"],
    ),
    "shell": (
        "void dielectric m 0 0 5 .3 .6 .9 1.5 0",
        ["m sphere s 0 0 4 0 0 0 1", "m bubble t 0 0 4 0 0 0 .8"],
    ),
}


@pytest.mark.filterwarnings("ignore:.*Hartmann")
@pytest.mark.parametrize("name", BALLS)
def test_clear_balls_look_alike(tmp_path, name):
    """A dome seen through balls that refract, reflect inside and absorb."""
    text, balls = BALLS[name]
    towards = unit(-1.0, 0.0, 0.0)
    eyes = [(4, *yz) for yz in ((0, 0), (0.3, 0.2), (0.5, 0.5), (0.8, 0.1), (0.2, 0.9))]
    truth = seen_by_radiance(
        tmp_path,
        "\n".join([text, *balls, DOME]),
        [(*eye, *towards) for eye in eyes],
        "-ab 0 -st 0 -lw 1e-9 -lr 20",
    )
    bsdf = material(tmp_path)
    scene = {"type": "scene"}
    for number, ball in enumerate(read_rad(tmp_path / "scene.rad").surfaces):
        scene[f"ball{number}"] = {
            "type": "sphere",
            "radius": ball.radius,
            "flip_normals": ball.inward,
            "bsdf": bsdf,
        }
    scene, rng = mi.load_dict(scene), np.random.default_rng(2)
    for eye, expected in zip(eyes, truth, strict=True):
        found, own = mean(follow(scene, np.array(eye), towards, rng))
        assert np.all(own < 0.01 * expected)
        assert np.all(np.abs(found - expected) < 4 * own + 1e-4 * expected)


def follow(scene, eye, towards, rng, *, n=1 << 17, segments=20):
    """What paths from an eye bring back from the dome."""
    ray = mi.Ray3f(mi.Point3f(eye.astype("f4")), mi.Vector3f(towards.astype("f4")))
    ray.o += dr.zeros(mi.Point3f, n)
    weight, total = dr.full(mi.Color3f, 1, n), dr.zeros(mi.Color3f, n)
    active = dr.full(mi.Bool, True, n)
    for _ in range(segments):
        si = scene.ray_intersect(ray, active)
        gone = active & ~si.is_valid()
        total = dr.select(gone, weight * dome(ray.d), total)
        active &= si.is_valid()
        sample, factor = si.bsdf().sample(
            mi.BSDFContext(), si, *numbers(n, rng), active
        )
        weight = dr.select(active, weight * factor, 0)
        ray = si.spawn_ray(si.to_world(sample.wo))
        dr.eval(ray, weight, total, active)
    return total
