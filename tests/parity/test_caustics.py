"""Sunlight behind a prism and off a glossy slat against Radiance's photon map."""

import numpy as np
from caustic_scenes import HALF, HEIGHT, PRISM_SUN, SUN_DEG, prism, prism_light
from radiance import run
from sun_patch_scenes import DOWN, METAL, PLACE, SENSOR, SOUTH_SUN, slat

from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

# Photons of the map, and those averaged at a sensor: nearly all are in the patch
PHOTONS, NEAREST = 50_000, 2000

# As many for the slat, whose light is spread over a larger area
SLAT_PHOTONS, SLAT_NEAREST = 100_000, 2000


def rad_of(scene, sun, port, floor):
    """A scene with the port from which photons start, and a floor where they land."""
    radiance = scene.materials["sun"].radiance[0]
    polygons = [(each.material, each.vertices) for each in scene.surfaces]
    polygons += [("port", np.array(port)), ("floor", np.array(floor))]
    red, green, blue = METAL.reflectance
    lines = [
        f"void light sun 0 0 3 {radiance} {radiance} {radiance}",
        f"sun source s 0 0 4 {sun[0]} {sun[1]} {sun[2]} {SUN_DEG}",
        "void dielectric glass 0 0 5 1 1 1 1.5 0",
        "void plastic black 0 0 5 0 0 0 0 0",
        "void plastic floor 0 0 5 .001 .001 .001 0 0",
        "void trans port 0 0 7 1 1 1 0 0 1 1",
        f"void metal slat 0 0 5 {red} {green} {blue} 1 {METAL.roughness}",
    ]
    for number, (name, corner) in enumerate(polygons):
        place = " ".join(f"{value:.9f}" for value in corner.ravel())
        lines.append(f"{name} polygon p{number} 0 0 {corner.size} {place}")
    return "\n".join(lines) + "\n"


def by_photons(folder, text, place, normal, photons, nearest):
    """Irradiance of a sensor from a map of caustic photons."""
    (folder / "scene.rad").write_text(text)
    run("oconv scene.rad > scene.oct", folder=folder)
    options = f"-apc scene.pm {photons} -apo port -apD .1 -apm 10000"
    run(f"mkpmap {options} scene.oct", folder=folder)
    found = run(
        f"rtrace -h -I -ab 1 -ap scene.pm {nearest} scene.oct",
        folder=folder,
        stdin=" ".join(f"{value:.6f}" for value in (*place, *normal)) + "\n",
    )
    return float(found.split()[0])


def test_a_prism_deflects_the_sun_as_in_the_photon_map(tmp_path):
    """The map's value has a standard error of 2 %, and a bias of its blur."""
    corners, _ = prism_light()
    place, up = corners.mean(axis=0), np.array([0.0, 0, 1])
    x, y, z = HALF, 5, HEIGHT + 0.01
    hole = [[-x, -x, z], [-x, x, z], [x, x, z], [x, -x, z]]
    floor = [[-y, -y, 0], [y, -y, 0], [y, y, 0], [-y, y, 0]]
    text = rad_of(prism(), PRISM_SUN, hole, floor)
    theirs = by_photons(tmp_path, text, place + 5e-4 * up, up, PHOTONS, NEAREST)
    ours = irradiance(prism(), Sensors(place[None], up[None]), samples=65536)
    assert abs(ours.irradiance[0, 0] - theirs) < 3 / np.sqrt(NEAREST) * theirs
    assert ours.error[0, 0] < 0.01 * theirs


def test_a_glossy_slat_reflects_the_sun_as_in_the_photon_map(tmp_path):
    """The map's value has a standard error of 2 %, and a bias of its blur."""
    # Photons start from a port across the sun's beam, and land on the ceiling
    across = np.cross(SOUTH_SUN, [0, 0, 1])
    upwards = np.cross(across, SOUTH_SUN)
    sides = (1, 1), (-1, 1), (-1, -1), (1, -1)
    port = [
        PLACE + 0.5 * SOUTH_SUN + 0.6 * (i * across + j * upwards) for i, j in sides
    ]
    # A ceiling that does not hide the sun
    ceiling = SENSOR + np.array([(-1, -0.6), (-1, 0.6), (1, 0.6), (1, -0.6)]) @ np.eye(
        2, 3
    )
    ceiling[:, 2] += 1e-3
    text = rad_of(slat(1), SOUTH_SUN, port, ceiling)
    theirs = by_photons(tmp_path, text, SENSOR, DOWN, SLAT_PHOTONS, SLAT_NEAREST)
    ours = irradiance(slat(1), Sensors(SENSOR[None], DOWN[None]), samples=65536)
    assert abs(ours.irradiance[0, 0] - theirs) < 3 / np.sqrt(SLAT_NEAREST) * theirs
    assert ours.error[0, 0] < 0.01 * theirs
