"""Rooms of every material: sensors read what rtrace reads.

A box open to the south has a west wall and a roof of the material. Light of a sky or a
sun reaches the sensors through and by way of it; or that of a window in the south, in
which case the rows of a view matrix say how much.
"""

import numpy as np
import pytest
from material_texts import SHEETS
from radiance import run

import clerestory as cl
from clerestory.phases.render import irradiance
from clerestory.scene.sensors import Sensors

BOX = """
void plastic w 0 0 5 .5 .5 .5 0 0
w polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
w polygon east 0 0 12 3 0 0 3 0 3 3 4 3 3 4 0
m polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
w polygon north 0 0 12 0 4 0 3 4 0 3 4 3 0 4 3
m polygon roof 0 0 12 0 0 3 0 4 3 3 4 3 3 0 3
"""
LIGHT = {
    "sky": (
        "void glow sky 0 0 4 3 2 1 0\nsky source sky 0 0 4 0 0 1 180\n"
        "void glow ground 0 0 4 .5 .5 .5 0\nground source ground 0 0 4 0 0 -1 180\n"
    ),
    "sun": "void light sun 0 0 3 2e5 2e5 2e5\nsun source sun 0 0 4 .3 -.5 .6 .533\n",
}
WINDOW = """#@rfluxmtx h=kf u=Z
void glow pane 0 0 4 1 1 1 0
pane polygon pane 0 0 12 0 0 0 0 0 3 3 0 3 3 0 0
"""
POSITION = np.array([[1, 1, 0.8], [2, 3, 0.8], [1.5, 2, 1.5], [1, 3.5, 1.5]])
DIRECTION = np.array([[0, 0, 1], [0, 0, 1], [-1, 0, 0], [0, -1, 0.0]])
AGAIN = 32


@pytest.mark.slow
@pytest.mark.parametrize("light", LIGHT)
@pytest.mark.parametrize("name", SHEETS)
def test_sensors_read_what_rtrace_reads(tmp_path, name, light):
    """Within 2 % and the noise of both.

    The 2 % are for rough materials: rays after a bounce weigh too little for rtrace to
    take several samples of a highlight, and single ones it does not weight by its
    model, so they bring a few per cent more at grazing angles.
    """
    file = tmp_path / "room.rad"
    file.write_text("\n".join([SHEETS[name], BOX, LIGHT[light]]))
    ours = irradiance(
        cl.read_rad(file),
        Sensors(POSITION, DIRECTION),
        samples=1 << 16,
        bounces=2,
        seed=1,
        device="cpu",
    )
    truth, spread = seen_by_radiance(tmp_path, "room.rad", bounces=2)
    error = np.hypot(ours.error, spread)
    assert np.median(error / truth) < 0.01
    difference = np.abs(ours.irradiance - truth)
    assert np.all(difference < 4 * error + 0.02 * truth)
    total = ours.irradiance.sum() / truth.sum()
    assert abs(total - 1) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("name", SHEETS)
def test_views_of_a_window_sum_to_what_rtrace_reads(tmp_path, name):
    """A window of unit radiance sends what the row of its view matrix holds.

    Of metals rtrace takes many samples after a bounce: with few, their highlights
    bring up to 6 % more, with ever more samples ever less.
    """
    (tmp_path / "room.rad").write_text("\n".join([SHEETS[name], BOX]))
    (tmp_path / "window.rad").write_text(WINDOW)
    matrix = cl.view_matrix(
        cl.read_rad(tmp_path / "room.rad"),
        cl.read_window(tmp_path / "window.rad"),
        sensors=Sensors(POSITION, DIRECTION),
        samples=1 << 15,
        bounces=2,
        seed=1,
        device="cpu",
    )
    found = matrix.values.sum(axis=2).T
    own = np.square(matrix.components.sum(axis=3)).sum(axis=0).T ** 0.5
    truth, spread = seen_by_radiance(
        tmp_path,
        "room.rad window.rad",
        bounces=2,
        highlight=20_000 if name.startswith("metal") else 32,
    )
    error = np.hypot(own, spread)
    assert np.median(error / truth) < 0.01
    assert np.all(np.abs(found - truth) < 4 * error + 0.02 * truth)
    assert abs(found.sum() / truth.sum() - 1) < 0.02


def seen_by_radiance(folder, files, *, bounces, highlight=32):
    """Mean irradiance of the sensors and its standard error, by rtrace."""
    rays = np.repeat(np.concatenate([POSITION, DIRECTION], axis=1), AGAIN, axis=0)
    seen = run(
        f"oconv {files} > room.oct; rtrace -h -w -I -ab {bounces} -aa 0 -ad 1024 -as 0"
        f" -st 0 -ss {highlight} -lw 1e-9 -lr 12 -dj 0 -ds 0 -dc 1 -dt 0 room.oct",
        folder=folder,
        stdin="\n".join(" ".join(map(str, ray)) for ray in rays),
    )
    found = np.fromstring(seen, sep=" ").reshape(-1, AGAIN, 3)
    return found.mean(axis=1), found.std(axis=1, ddof=1) / np.sqrt(AGAIN)
