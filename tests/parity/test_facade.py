"""Façade matrices of LBNL's tutorial of matrix-based methods, against rfluxmtx.

Its room with an overhang, a grate of polygons or a pane of diffusing glass (a Klems
BSDF), its ports F1 (one plane before the façade) and FN (a box of seven ports).
"""

import numpy as np
import pytest
import radiance

import clerestory as cl
from clerestory.hemisphere.klems import klems

PATCHES, BOUNCES, RUNS = 145, 4, 4
SHARE = klems("full").projected_solid_angles()


@pytest.fixture
def room(shared_data, monkeypatch):
    """The tutorial's folder, from which its overhang names a file."""
    folder = shared_data / "tutorial_room"
    monkeypatch.chdir(folder)
    return folder


def files(overhang):
    return "materials.rad", "room.rad", f"overhang/{overhang}.rad"


def theirs(room, folder, overhang, ports, rays):
    """Mean of rfluxmtx's runs, and its standard error (row, column).

    With as many rays every run would draw the same.
    """
    octree = folder / "overhang.oct"
    radiance.run(f"oconv -f {' '.join(files(overhang))} > {octree}", folder=room)
    runs = []
    for run in range(RUNS):
        text = radiance.run(
            f"rfluxmtx -n 1 -h- -fa -ab {BOUNCES} -ad 1 -lw 1e-6 -c {rays + 16 * run}"
            f" objects/GlazingVmtx.rad fports/{ports}.rad -i {octree}",
            folder=room,
        )
        runs.append(radiance.matrix(text))
    return np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / RUNS**0.5


def ours(room, overhang, ports, samples):
    """Columns of all ports side by side (row, column), and their standard errors."""
    scene = cl.read_rad(*(room / name for name in files(overhang)))
    window = cl.read_window(room / "objects" / "GlazingVmtx.rad")
    found = cl.facade_matrices(
        scene, window, cl.read_windows(room / "fports" / f"{ports}.rad"),
        samples=samples, bounces=BOUNCES, seed=1,
    )  # fmt: skip
    value = np.concatenate([F.values[0] for F in found.values()], axis=1)
    error = [F.standard_error[0] for F in found.values()]
    return value, np.concatenate(error, axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("ports", ["F1", "FN"])
def test_facade_matrix_equals_rfluxmtx(ports, room, tmp_path):
    """Behind the grate entries are within joint noise, all light within 0.3 %."""
    overhang = "metalGrateModel"
    value, error = ours(room, overhang, ports, 8192)
    other, noise = theirs(room, tmp_path, overhang, ports, 1000)
    joint = np.mean(error**2 + noise**2)
    assert np.mean((value - other) ** 2) < 1.25 * joint
    assert (SHARE @ value).sum() == pytest.approx((SHARE @ other).sum(), rel=0.003)


@pytest.mark.slow
def test_behind_diffusing_glass_all_light_is_the_same(room, tmp_path):
    """Single entries differ: Radiance blurs the direction a Klems BSDF is lit from."""
    overhang, ports = "diffuseGlass", "F1"
    value, _ = ours(room, overhang, ports, 8192)
    other, _ = theirs(room, tmp_path, overhang, ports, 1000)
    light, their_light = SHARE @ value, SHARE @ other
    assert light.sum() == pytest.approx(their_light.sum(), rel=0.003)
    assert np.corrcoef(light, their_light)[0, 1] > 0.999
