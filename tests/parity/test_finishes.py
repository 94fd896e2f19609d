"""Patterns, textures and varying mixtures look as Radiance's do.

A sheet under a small sun is seen at many points, where Radiance evaluates its formulas
exactly. Gathered light is compared where Radiance does not approximate it.
"""

import numpy as np
import pytest
from radiance import run

from clerestory.engine import device as devices

# Mitsuba and Dr.Jit exist once a device was started
devices.load("cpu")

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.phases.rendering import irradiance
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.sensors import Sensors

FILES = {
    "ring.cal": "wave(u, v) = sin(9*sqrt(u*u + v*v) + noise3(u, v, 1));"
    "ring(u, v) = 1 - A1*.2*(1 + wave(u, v));"
    "dust(s) = if(s - 1.01, 0, abs(noise3(Px/s, Py/s, Pz/s)*s) + dust(2*s));"
    "tilt(a, b, c) = a - .5; lift(a, b, c) = b - c;",
    "t.dat": "2\n-2 2 5\n0 0 3 2 0.5 -2\n"
    "1 .2 .4\n.5 .6 .7\n.1 .9 .3\n.2 .2 .8\n1 .2 .3\n",
}
MATT = "plastic m 0 0 5 .8 .6 .4 .04 .1"
PAIR = "void plastic a 0 0 5 .8 .8 .8 0 0\nvoid metal b 0 0 5 .3 .4 .5 .8 .2\n"
CASES = {
    "wood": f"void brightfunc p 4 ring(Px,Py) ring.cal -rz 30 0 1 .8\np {MATT}",
    "colours": f"void colorfunc p 4 frac(2*Px) frac(3*Py) .5+Nz/2 . 0 0\np {MATT}",
    "sight": f"void brightfunc p 2 abs(Rdot)*(1+Dx) . 0 0\np {MATT}",
    "dust": f"void brightfunc p 2 1-.6*dust(.1) ring.cal 0 0\np {MATT}",
    "table": f"void brightdata p 7 noop t.dat . Px Py -s 2 0 0\np {MATT}",
    "tables": "void colordata p 11 red green clip_b t.dat t.dat t.dat . Px Py -s 2"
    f" 0 0\np {MATT}",
    "bumps": "void texfunc p 4 .3*noise3x(4*Px,4*Py,Pz) .3*noise3y(4*Px,4*Py,Pz) 0 ."
    f" 0 0\np {MATT}",
    "bumpy metal": "void texfunc p 8 A1*sin(9*Px) 0 .1*cos(5*Py) . -s .5 -ry 20 0 1 .2"
    "\np metal m 0 0 5 .5 .6 .7 .9 .2",
    "bumpy table": "void texdata p 9 tilt lift tilt t.dat t.dat t.dat ring.cal Px Py"
    f" 0 0\np {MATT}",
    "brushed": "void texfunc p 4 .1*sin(20*Px) 0 0 . 0 0\n"
    "p metal2 m 4 0 1 0 . 0 6 .8 .6 .3 .9 .1 .3",
    "turning": "void metal2 m 4 -Py Px 0 . 0 6 .8 .6 .3 .9 .1 .3",
    "turned turning": "void plastic2 m 8 -Py Px A1 . -rz 20 -ry 40 0 6"
    " .8 .6 .3 .4 .1 .3",
    "constant up": "void metal2 m 6 -sin(.4) cos(.4) 0 . -rx 20 0 6 .8 .6 .3 .9 .1 .3",
    "between": "void plastic q 0 0 5 .8 .6 .4 .04 .1\nq brightfunc r 2 abs(Px) . 0 0\n"
    "r texfunc m 4 .2*sin(7*Px) 0 0 . 0 0",
    "patch": PAIR + "void mixfunc m 4 a b if(sin(9*Px),1,.2) . 0 0",
    "cloth": PAIR + "void mixdata m 9 a b noop t.dat . Px Py -s 2 0 0",
    "smoothed": "void plastic q 0 0 5 .8 .6 .4 .04 .1\n"
    "q texfunc m 4 surf_dx surf_dy surf_dz surf.cal 0 13 2 .1 .2 0 .1 0 0 0 .1 0 0 0 0",
    "turned": "void plastic q 0 0 5 .8 .6 .4 .04 .1\n"
    "q texfunc m 4 rev_dx rev_dy rev_dz rev.cal 0 4 0 0 .1 .05",
}
SHEET = "\nm polygon s 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n"
TOWARDS_SUN = np.array([-0.4, -0.3, 0.85]) / np.linalg.norm([-0.4, -0.3, 0.85])
SUN_DEG, SUN = 0.2, 1e5


def scene(folder, name, light):
    for file, text in FILES.items():
        (folder / file).write_text(text)
    (folder / "scene.rad").write_text(CASES[name] + SHEET + light)


def seen_by_radiance(folder, points, view):
    light = "void light sun 0 0 3 {0} {0} {0}\nsun source sun 0 0 4 {1} {2} {3} {4}\n"
    (folder / "sun.rad").write_text(light.format(SUN, *TOWARDS_SUN, SUN_DEG))
    rays = [(*(p + 0.1 * view), *-view) for p in points]
    options = "-ab 0 -dj 0 -ds 0 -dc 1 -dt 0 -st 0 -ss 0 -lw 0 -lr 6"
    text = run(
        f"oconv scene.rad sun.rad > s.oct; rtrace -h -w {options} s.oct",
        folder=folder,
        stdin="\n".join(" ".join(f"{x:.15g}" for x in ray) for ray in rays),
    )
    return np.fromstring(text, sep=" ").reshape(-1, 3)


@pytest.mark.parametrize("side", [1, -1], ids=["front", "back"])
@pytest.mark.parametrize("name", CASES)
def test_finishes_are_as_bright_as_radiance_shows_them(tmp_path, name, side):
    """Reflected sunlight at 200 points of a sheet, seen from its front and back."""
    scene(tmp_path, name, "")
    rng = np.random.default_rng(5)
    points = np.concatenate([rng.uniform(-1.9, 1.9, (200, 2)), np.zeros((200, 1))], 1)
    view = np.array([0.3, 0.5, 0.81 * side])
    view /= np.linalg.norm(view)
    # Turn the sheet over instead of the sun
    if side < 0:
        text = (tmp_path / "scene.rad").read_text()
        over = SHEET.replace(
            "-2 -2 0 2 -2 0 2 2 0 -2 2 0", "-2 2 0 2 2 0 2 -2 0 -2 -2 0"
        )
        (tmp_path / "scene.rad").write_text(text.replace(SHEET, over))
        view[2] *= -1
    truth = seen_by_radiance(tmp_path, points, view)
    materials.register()
    made = materials.load(read_rad(tmp_path / "scene.rad").materials["m"])
    si = mi.SurfaceInteraction3f()
    si.p = mi.Point3f(np.ascontiguousarray(points.T.astype("f4")))
    si.n = mi.Normal3f(0, 0, side)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = si.to_local(mi.Vector3f(view.astype("f4")))
    local = si.to_local(mi.Vector3f(TOWARDS_SUN.astype("f4")))
    value = made.eval(materials.lamp_context(), si, local).numpy()
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))
    found = np.broadcast_to(value, (3, 200)).T * SUN * solid_angle
    assert truth.max() > 0
    # Edges of steps fall either way in single precision, and at a table's ends
    np.testing.assert_allclose(found, truth, rtol=3e-3, atol=2e-3 * truth.mean())


BENT = "void texfunc p 4 .3 0 0 . 0 0\np "


@pytest.mark.parametrize("name", ["metal m 0 0 5 .8 .6 .4 .9 .1", MATT])
@pytest.mark.parametrize("slant", [0.9, -0.6])
def test_bent_materials_gather_a_sky_by_radiances_formula(tmp_path, name, slant):
    """Radiance evaluates its formula for each of 6000 suns that fill the sky.

    Sky that is no lamp it samples, and weighs highlights by the angle to the true
    normal instead of the bent one: that is up to 15 % off the formula.
    """
    count = 6000
    z = (np.arange(count) + 0.5) / count
    phi, r = np.pi * (1 + 5**0.5) * np.arange(count), np.sqrt(1 - z**2)
    radius = np.degrees(np.arccos(1 - 1 / count))
    suns = "".join(
        f"sun source s{i} 0 0 4 {x:.9g} {y:.9g} {h:.9g} {2 * radius:.9g}\n"
        for i, (x, y, h) in enumerate(np.c_[r * np.cos(phi), r * np.sin(phi), z])
    )
    sky = "void light sun 0 0 3 1 1 1\n" + suns
    (tmp_path / "scene.rad").write_text(BENT + name + SHEET + sky)
    view = np.array([np.sin(slant), 0, np.cos(slant)])
    text = run(
        "oconv scene.rad > s.oct; rtrace -h -w -ab 0 -dj 0 -ds 0 -dc 1 -dt 0 -st 1"
        " -lw 0 s.oct",
        folder=tmp_path,
        stdin=" ".join(f"{x:.12g}" for x in (*(0.1 * view), *-view)),
    )
    truth = np.fromstring(text, sep=" ")
    (tmp_path / "bare.rad").write_text(BENT + name)
    materials.register()
    made = materials.load(read_rad(tmp_path / "bare.rad").materials["m"])
    size = 1 << 18
    si = dr.zeros(mi.SurfaceInteraction3f, size)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = mi.Vector3f(view.astype("f4"))
    draws = mi.PCG32(size)
    at = mi.Point2f(draws.next_float32(), draws.next_float32())
    bs, weight = made.sample(mi.BSDFContext(), si, draws.next_float32(), at)
    seen = dr.select(bs.wo.z > 0, weight, 0).numpy()
    found, error = seen.mean(axis=1), seen.std(axis=1) / size**0.5
    assert np.all(error < 0.002 * truth)
    assert np.all(np.abs(found - truth) < 4 * error + 0.003 * truth)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wood", "colours", "tables", "cloth", "patch"])
def test_finishes_reflect_the_light_of_a_sky(tmp_path, name):
    """Irradiance by way of a sheet, within 1 % and the joint noise."""
    scene(tmp_path, name, "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 .3 .2 1 120\n")
    sensors = Sensors(
        np.array([[0, 0, 0.5], [0.7, -0.4, 0.3]]), np.array([[0, 0, -1.0], [0, 0, -1]])
    )
    ours = irradiance(
        read_rad(tmp_path / "scene.rad"), sensors, samples=1 << 16, bounces=2, seed=1
    )
    rays = np.repeat(np.c_[sensors.position, sensors.direction], 16, axis=0)
    text = run(
        "oconv scene.rad > s.oct; rtrace -h -w -I -ab 2 -aa 0 -ad 1024 -as 0 -st 0"
        " -ss 16 -lw 1e-7 s.oct",
        folder=tmp_path,
        stdin="\n".join(" ".join(map(str, ray)) for ray in rays),
    )
    seen = np.fromstring(text, sep=" ").reshape(2, 16, 3)
    truth, spread = seen.mean(axis=1), seen.std(axis=1, ddof=1) / 4
    error = np.hypot(ours.error, spread)
    assert np.all(error < 0.01 * truth)
    assert np.all(np.abs(ours.irradiance - truth) < 4 * error + 0.01 * truth)
