"""Which way is up, left and in: windows in five orientations against rfluxmtx.

A room with windows to all sides and a skylight tilted by 30°. The matrices between
V and D are asymmetric in every way: only the right convention gives the right light.
"""

import numpy as np
import pytest
import radiance

import clerestory as cl
from clerestory.matrix.axis import window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

ROOM = """
void plastic wall 0 0 5 .5 .5 .5 0 0
void plastic floor 0 0 5 .2 .2 .2 0 0
void plastic ground 0 0 5 .3 .3 .3 0 0
ground polygon ground 0 0 12  -60 -60 -.1  60 -60 -.1  60 60 -.1  -60 60 -.1
ground polygon obstruction 0 0 12  9 -4 -.1  9 3 -.1  9 3 5  9 -4 5
floor polygon floor 0 0 12  0 0 0  5 0 0  5 4 0  0 4 0
wall polygon south 0 0 30  0 0 0  5 0 0  5 0 3  0 0 3  0 0 0
    1 0 1  2 0 1  2 0 2  1 0 2  1 0 1
wall polygon north 0 0 30  0 4 0  5 4 0  5 4 3  0 4 3  0 4 0
    3 4 1  4 4 1  4 4 2.2  3 4 2.2  3 4 1
wall polygon west 0 0 30  0 0 0  0 4 0  0 4 3  0 0 3  0 0 0
    0 1 .8  0 2 .8  0 2 2  0 1 2  0 1 .8
wall polygon east 0 0 30  5 0 0  5 4 0  5 4 3  5 0 3  5 0 0
    5 2.2 .8  5 3.4 .8  5 3.4 2  5 2.2 2  5 2.2 .8
wall polygon ceiling 0 0 30  0 0 3  5 0 3  5 4 3  0 4 3  0 0 3
    2 1.5 3  3 1.5 3  3 2.5 3  2 2.5 3  2 1.5 3
wall polygon kerb_w 0 0 12  2 1.5 3  2 2.5 3  2 2.5 3.577350  2 1.5 3
wall polygon kerb_e 0 0 12  3 1.5 3  3 2.5 3  3 2.5 3.577350  3 1.5 3
wall polygon kerb_n 0 0 12  2 2.5 3  3 2.5 3  3 2.5 3.577350  2 2.5 3.577350
"""

# Fronts face the room; the skylight's up vector points along its slope.
WINDOWS = {
    "south": ("Z", "1 0 1  1 0 2  2 0 2  2 0 1"),
    "north": ("Z", "4 4 1  4 4 2.2  3 4 2.2  3 4 1"),
    "west": ("Z", "0 2 .8  0 2 2  0 1 2  0 1 .8"),
    "east": ("Z", "5 2.2 .8  5 2.2 2  5 3.4 2  5 3.4 .8"),
    "skylight": ("Y", "2 1.5 3  2 2.5 3.577350  3 2.5 3.577350  3 1.5 3"),
}

POINTS = "1.3 1.1 .8 0 0 1\n3.6 2.9 .8 0 0 1\n2.5 2 1.2 0 1 0\n2.5 2 1.2 .8 -.6 0\n"


def window_text(name, skylight_up="Y"):
    up, corners = WINDOWS[name]
    return (
        f"#@rfluxmtx h=kf u={up}\nvoid glow {name} 0 0 4 1 1 1 0\n"
        f"{name} polygon pane_{name} 0 0 12 {corners}\n"
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("room")
    (folder / "room.rad").write_text(ROOM)
    (folder / "points.pts").write_text(POINTS)
    for name in WINDOWS:
        (folder / f"{name}.rad").write_text(window_text(name))
    sky = "void glow sky 0 0 4 1 1 1 0\n"
    (folder / "sky.rad").write_text(
        f"#@rfluxmtx h=u u=Y\n{sky.replace('sky', 'below')}"
        "below source ground_half 0 0 4 0 0 -1 180\n"
        f"#@rfluxmtx h=r1 u=Y\n{sky}sky source dome 0 0 4 0 0 1 180\n"
    )
    radiance.run("oconv room.rad > room.oct", folder=folder)
    return folder


@pytest.fixture(scope="module")
def traced(folder):
    scene = cl.read_rad(folder / "room.rad")
    windows = [cl.read_window(folder / f"{name}.rad") for name in WINDOWS]
    sensors = cl.read_sensors(folder / "points.pts")
    views = cl.view_matrices(
        scene, windows, sensors=sensors, samples=1 << 16, bounces=3, seed=1
    )
    daylights = cl.daylight_matrices(
        scene, windows, subdivision=1, samples=1 << 13, bounces=2, seed=2
    )
    return windows, views, daylights


def lopsided(partition):
    """A transmission matrix without any symmetry, smooth enough for Monte Carlo."""
    rng = np.random.default_rng(11)
    centre = partition.centres()
    to, back = rng.normal(size=(2, 3))
    out = np.exp(1.2 * centre @ (to / np.linalg.norm(to)))
    arriving = np.exp(2.5 * centre @ (back / np.linalg.norm(back)))
    values = np.outer(out, arriving * partition.projected_solid_angles())
    values /= values.max()
    return TransferMatrix(
        values[None],
        window_axis("interior", partition),
        window_axis("exterior", partition),
    )


def lopsided_sky(partition):
    """Radiances without symmetry: a bright spot in the east-south-east."""
    spot = np.array([0.8, -0.35, 0.5])
    return np.exp(3 * partition.centres() @ (spot / np.linalg.norm(spot)))


@pytest.fixture(scope="module")
def reference(folder):
    """Radiance's view and daylight matrices of every window."""
    options = "-n 2 -h -V- -w-"
    views, daylights = {}, {}
    for name in WINDOWS:
        others = " ".join(f"{other}.rad" for other in WINDOWS if other != name)
        radiance.run(f"oconv room.rad {others} > {name}.oct", folder=folder)
        # Each run draws anew and scatters by 3 % a sensor: take the mean of four
        command = (
            f"rfluxmtx {options} -I+ -ab 3 -ad 65536 -lw 3e-6 -y 4"
            f" - {name}.rad -i {name}.oct"
        )
        runs = [
            radiance.matrix(radiance.run(command, folder=folder, stdin=POINTS))
            for _ in range(4)
        ]
        views[name] = np.mean(runs, axis=0)
        daylights[name] = radiance.matrix(
            radiance.run(
                f"rfluxmtx {options} -ab 2 -ad 1 -lw 1e-6 -c 3000"
                f" {name}.rad sky.rad -i room.oct",
                folder=folder,
            )
        )
    return views, daylights


@pytest.mark.parametrize("name", WINDOWS)
def test_illuminance_through_a_lopsided_bsdf_equals_radiance(name, traced, reference):
    """Within the noise of rfluxmtx: four runs' mean scatters by 1.5 % a sensor."""
    windows, views, daylights = traced
    [window] = [w for w in windows if w.name == name]
    middle = lopsided(window.partition)
    sky = lopsided_sky(daylights[name].columns.partition)
    ours = (views[name] @ middle @ daylights[name]).values[0] @ sky
    theirs = reference[0][name] @ middle.values[0] @ reference[1][name] @ sky
    assert np.all(np.abs(ours - theirs) < 0.06 * theirs + 0.02 * theirs.mean())
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.03)


@pytest.mark.parametrize("name", WINDOWS)
def test_a_mirrored_bsdf_would_be_noticed(name, traced):
    """The same product with left and right, or up and down, exchanged is far off."""
    windows, views, daylights = traced
    [window] = [w for w in windows if w.name == name]
    partition = window.partition
    middle = lopsided(partition)
    sky = lopsided_sky(daylights[name].columns.partition)
    right = (views[name] @ middle @ daylights[name]).values[0] @ sky
    for mirror in ([-1, 1, 1], [1, -1, 1], [-1, -1, 1]):
        swap = partition.find(partition.centres() * mirror)
        wrong_middle = middle.values[0][swap][:, swap]
        wrong = views[name].values[0] @ wrong_middle @ daylights[name].values[0] @ sky
        assert np.max(np.abs(wrong / right - 1)) > 0.15


def test_view_matrices_equal_rfluxmtx_patch_by_patch(traced, reference):
    """Correlation over all patches of all windows, which any renumbering breaks."""
    _, views, _ = traced
    for name in WINDOWS:
        ours, theirs = views[name].values[0], reference[0][name]
        assert np.corrcoef(ours.ravel(), theirs.ravel())[0, 1] > 0.97
        assert ours.sum() == pytest.approx(theirs.sum(), rel=0.015)


def test_daylight_matrices_equal_rfluxmtx_patch_by_patch(traced, reference):
    """Correlation over all patches of window and sky, which any renumbering breaks."""
    _, _, daylights = traced
    for name in WINDOWS:
        ours, theirs = daylights[name].values[0], reference[1][name]
        assert np.corrcoef(ours.ravel(), theirs.ravel())[0, 1] > 0.99
        assert ours.sum() == pytest.approx(theirs.sum(), rel=0.01)
