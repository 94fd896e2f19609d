"""Sunlight behind a prism against Radiance's photon map (mkpmap)."""

import numpy as np
from caustic_scenes import HALF, HEIGHT, PRISM_SUN, SUN_DEG, prism, prism_light
from radiance import run

from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

# Photons of the map, and those averaged at a sensor: nearly all are in the patch
PHOTONS, NEAREST = 50_000, 2000


def rad_of(scene):
    """The prism with its floor, the sun, and the port from which photons start."""
    radiance = scene.materials["sun"].radiance[0]
    polygons = [(each.material, each.vertices) for each in scene.surfaces]
    x, y, z = HALF, 5, HEIGHT + 0.01
    hole = [[-x, -x, z], [-x, x, z], [x, x, z], [x, -x, z]]
    floor = [[-y, -y, 0], [y, -y, 0], [y, y, 0], [-y, y, 0]]
    polygons += [("port", np.array(hole)), ("floor", np.array(floor))]
    lines = [
        f"void light sun 0 0 3 {radiance} {radiance} {radiance}",
        f"sun source s 0 0 4 {PRISM_SUN[0]} 0 {PRISM_SUN[2]} {SUN_DEG}",
        "void dielectric glass 0 0 5 1 1 1 1.5 0",
        "void plastic black 0 0 5 0 0 0 0 0",
        "void plastic floor 0 0 5 .001 .001 .001 0 0",
        "void trans port 0 0 7 1 1 1 0 0 1 1",
    ]
    for number, (name, corner) in enumerate(polygons):
        place = " ".join(f"{value:.9f}" for value in corner.ravel())
        lines.append(f"{name} polygon p{number} 0 0 {corner.size} {place}")
    return "\n".join(lines) + "\n"


def test_a_prism_deflects_the_sun_as_in_the_photon_map(tmp_path):
    """The map's value has a standard error of 2 %, and a bias of its blur."""
    corners, _ = prism_light()
    place = corners.mean(axis=0)
    (tmp_path / "prism.rad").write_text(rad_of(prism()))
    run("oconv prism.rad > prism.oct", folder=tmp_path)
    options = f"-apc prism.pm {PHOTONS} -apo port -apD .1 -apm 10000"
    run(f"mkpmap {options} prism.oct", folder=tmp_path)
    found = run(
        f"rtrace -h -I -ab 1 -ap prism.pm {NEAREST} prism.oct",
        folder=tmp_path,
        stdin=f"{place[0]} {place[1]} .0005 0 0 1\n",
    )
    theirs = float(found.split()[0])
    ours = irradiance(
        prism(), Sensors(place[None], np.array([[0.0, 0, 1]])), samples=65536
    )
    assert abs(ours.irradiance[0, 0] - theirs) < 3 / np.sqrt(NEAREST) * theirs
    assert ours.error[0, 0] < 0.01 * theirs
