"""Façade matrices where the answer is known without tracing."""

import numpy as np
import pytest
from physics_scenes import box, endless_ground, grey, quad, sensor, window

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.errors import ClerestoryWarning, InputError, MatrixError
from clerestory.hemisphere.klems import klems
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.facade_matrices import joint_sum
from clerestory.scene.model import Scene
from clerestory.scene.window import window_of


def pane(y, *, name="south", left=0.0, right=4.0, low=1.0, high=2.5, basis="full"):
    """A window in a plane of constant y whose front faces +y."""
    corners = (left, y, low), (left, y, high), (right, y, high), (right, y, low)
    return window(quad(*corners), name=name, basis=basis)


def ports_before(depth):
    """A box of ports, open to the wall, that sticks out 1 m around `pane(0)`."""
    x, z = (-1.0, 5.0), (0.0, 3.5)
    a, b, c, d = (
        (p, q) for p, q in ((x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1]))
    )
    out = {"left": (d, a), "right": (b, c), "bottom": (a, b), "top": (c, d)}
    found = [pane(-depth, name="front", left=x[0], right=x[1], low=z[0], high=z[1])]
    for name, ((x1, z1), (x2, z2)) in out.items():
        corners = (x1, -depth, z1), (x2, -depth, z2), (x2, 0, z2), (x1, 0, z1)
        up = (0, 1, 0) if name in ("top", "bottom") else (0, 0, 1)
        found.append(window(quad(*corners), name=name, up=up))
    return found


def weighed(matrix):
    """Irradiance of the window from each column, and its standard error."""
    share = matrix.rows.partition.projected_solid_angles()
    value = np.einsum("r,crx->cx", share, matrix.values)
    error = np.einsum("r,bcrx->bcx", share, matrix.components)
    return value, np.sqrt(np.square(error).sum(axis=0))


def total(matrices):
    """Sums of the rows over all ports, with their standard errors."""
    value = sum(m.values[0].sum(axis=1) for m in matrices)
    parts = sum(m.components[:, 0].sum(axis=2) for m in matrices)
    return value, np.sqrt(np.square(parts).sum(axis=0))


def test_a_port_just_before_the_window_changes_nothing(device):
    """V T F D equals V T D, and F is the identity.

    At 0.01 mm the outermost ring, of mean tan θ 7.6, loses 0.08 mm of 1.5 m at an edge:
    with the noise of 4096 paths less than 5·10⁻⁴.
    """
    south, port = pane(0.0), pane(-1e-5, name="port")
    F = cl.facade_matrix(Scene(), south, port, samples=4096, device=device)
    assert F.values[0] == pytest.approx(np.eye(145), abs=1e-3)

    opposite = quad((-9, -8, 0), (9, -8, 0), (9, -8, 7), (-9, -8, 7))
    ground = endless_ground(0.3)
    street = Scene(ground.materials, (*ground.surfaces, opposite))
    shared = {"subdivision": 1, "samples": 8192, "device": device}
    through = F @ cl.daylight_matrix(street, port, seed=1, **shared)
    plain = cl.daylight_matrix(street, south, seed=2, **shared)

    room, _ = box(4, 5, 3, 0.5)
    desk = sensor((2, 2, 0.8), (0, 0, 1))
    V = cl.view_matrix(room, south, sensors=desk, samples=4096, device=device)
    T = lambertian(0.5, klems("full")).transmission_matrix()
    one, other = V @ T @ through, V @ T @ plain
    error = np.hypot(one.standard_error, other.standard_error)
    assert np.all(abs(one.values - other.values) < 4 * error + 1e-3 * other.values)
    (found, noise), (truth, more) = weighed(through), weighed(plain)
    assert np.all(abs(found - truth) < 4 * np.hypot(noise, more) + 1e-3 * truth + 1e-6)
    assert found.sum() == pytest.approx(truth.sum(), rel=2e-3)


def test_ports_that_close_the_space_take_all_light(device):
    """Without a shade every row sums to one over all ports."""
    ports = ports_before(1.0)
    F = cl.facade_matrices(Scene(), pane(0.0), ports, samples=2048, device=device)
    value, _ = total(F.values())
    assert value == pytest.approx(np.ones(145), abs=2e-6)


def test_light_keeps_its_direction_through_each_port(device):
    """The mean direction of a row's columns, in the scene, is that of the row.

    Patches are at most 20° wide and averages of many lie closer.
    """
    south, ports = pane(0.0), ports_before(1.0)
    F = cl.facade_matrices(Scene(), south, ports, samples=4096, device=device)

    def in_scene(of):
        axes = np.array([of.frame.right, of.frame.up, of.frame.normal])
        return of.partition.centres() @ axes

    rows = in_scene(south)
    mean = sum(F[port.name].values[0] @ in_scene(port) for port in ports)
    cosine = np.sum(mean * rows, axis=1) / np.linalg.norm(mean, axis=1)
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 4


def test_one_port_around_the_window_keeps_all_patches(device):
    """The five sides are one port, and its mean normal is that of the window."""
    south = pane(0.0)
    sides = tuple(polygon for port in ports_before(1.0) for polygon in port.polygons)
    port = window_of(sides, name="port", faceted=True)
    assert port.frame.normal == pytest.approx([0, 1, 0])
    F = cl.facade_matrix(Scene(), south, port, samples=1024, device=device)
    assert F.values[0] == pytest.approx(np.eye(145), abs=2e-6)


def test_polygons_of_a_port_take_light_by_their_area_along_its_direction(device):
    """A black sheet covers the upright square; the level one sees the sky."""
    upright = quad((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0))
    level = quad((0, 0, 1), (0, 2, 1), (1, 2, 1), (1, 0, 1))
    y = -1e-4
    sheet = quad((0, y, 0), (0, y, 1), (1, y, 1), (1, y, 0))
    port = window_of((upright, level), name="port", faceted=True)
    D = cl.daylight_matrix(
        Scene({"wall": grey(0.0)}, (sheet,)), port, subdivision=1, samples=1 << 13,
        device=device,
    )  # fmt: skip
    rng = np.random.default_rng(1)
    turn, sine = 2 * np.pi * rng.random(1 << 18), np.sqrt(rng.random(1 << 18))
    local = np.stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1 - sine**2)])
    frame = port.frame
    axes = np.stack([frame.right, frame.up, frame.normal])
    inwards = local.T @ axes
    seen = np.maximum(inwards @ np.array([[0, 1.0, 0], [0, 0, -2.0]]).T, 0)
    share = seen[:, 1] / seen.sum(axis=1)
    patch = port.partition.find(local.T)
    expected = np.bincount(patch, share) / np.bincount(patch)
    assert expected.min() < 0.1
    assert expected.max() == 1
    assert D.values[0].sum(axis=1) == pytest.approx(expected, abs=0.02)


def test_a_white_tunnel_transmits_all_light(device):
    """Between white walls the window sees the port's radiance everywhere."""
    port = pane(-1.0, name="port")
    corners = [(0, 1.0), (4, 1.0), (4, 2.5), (0, 2.5)]
    walls = tuple(
        quad((x1, -1, z1), (x2, -1, z2), (x2, 0, z2), (x1, 0, z1))
        for (x1, z1), (x2, z2) in zip(corners, corners[1:] + corners[:1], strict=True)
    )
    wall = quad((0, 0, 1), (4, 0, 1), (4, 0, 2.5), (0, 0, 2.5))
    scene = Scene({"wall": grey(1.0)}, (*walls, wall))
    south = pane(-0.01, name="south", left=0.01, right=3.99, low=1.01, high=2.49)
    F = cl.facade_matrix(scene, south, port, samples=8192, device=device)
    value, error = total([F])
    assert np.all(error < 0.02)
    assert np.all(abs(value - 1) < 4 * error + 1e-5)


def test_four_phases_equal_a_daylight_matrix_with_the_shade(device):
    """A grey overhang before a grey wall: light from all around, by window patch.

    The field below has the sky's radiance, so that patches across the horizon lose
    nothing; overhang and wall, 30 % grey, are all that is darker.
    """
    south, ports = pane(-0.001), ports_before(1.0)
    shade = quad(
        (-0.9, -0.9, 2.6), (4.9, -0.9, 2.6), (4.9, -0.01, 2.6), (-0.9, -0.01, 2.6)
    )
    wall = quad((-1, 0, 0), (5, 0, 0), (5, 0, 3.5), (-1, 0, 3.5))
    scene = Scene({"wall": grey(0.3)}, (shade, wall))
    F = cl.facade_matrices(scene, south, ports, samples=4096, seed=1, device=device)
    shared = {"subdivision": 1, "samples": 2048, "device": device}
    D = cl.daylight_matrices(Scene(), ports, seed=2, **shared)
    chain = cl.facade_daylight(F, D)
    whole = cl.daylight_matrix(scene, south, seed=3, **shared)
    (found, noise), (truth, more) = total([chain]), total([whole])
    assert truth.min() < 0.5
    assert np.all(np.hypot(noise, more) < 0.02)
    assert np.all(abs(found - truth) < 4 * np.hypot(noise, more) + 1e-5)


def test_errors_of_f_and_d_do_not_agree(device):
    """F and D of one seed: the spread of F D over seeds is what its error says."""
    south, port = pane(0.0, basis="quarter"), pane(-0.5, name="port", basis="quarter")
    shade = quad((0, -0.4, 2.4), (4, -0.4, 2.4), (4, -0.1, 2.4), (0, -0.1, 2.4))
    scene = Scene({"wall": grey(0.5)}, (shade,))
    shared = {"samples": 256, "device": device}
    chains = [
        cl.facade_matrix(scene, south, port, seed=seed, **shared)
        @ cl.daylight_matrix(scene, port, subdivision=1, seed=seed, **shared)
        for seed in range(24)
    ]
    values = np.array([weighed(chain)[0][0] for chain in chains])
    stated = np.mean([weighed(chain)[1][0] ** 2 for chain in chains], axis=0)
    assert values.var(axis=0, ddof=1).mean() == pytest.approx(stated.mean(), rel=0.25)


def test_a_port_that_faces_away_is_reported(device):
    corners = (4, -1, 1), (4, -1, 2.5), (0, -1, 2.5), (0, -1, 1)
    port = window(quad(*corners), name="port")
    with pytest.warns(ClerestoryWarning, match="port 'port' reaches window 'south'"):
        cl.facade_matrix(Scene(), pane(0.0), port, samples=64, device=device)


def test_a_port_with_the_window_s_name_is_refused():
    with pytest.raises(InputError, match="several windows are named 'south'"):
        cl.facade_matrix(Scene(), pane(0.0), pane(-1.0), samples=64)


def test_daylight_of_other_ports_is_refused(device):
    F = cl.facade_matrices(
        Scene(), pane(0.0), [pane(-1, name="a")], samples=64, device=device
    )
    with pytest.raises(MatrixError, match="of ports a, daylight matrices of none"):
        cl.facade_daylight(F, {})


def test_joint_errors_of_opposite_terms_cancel():
    """Paths that miss one port enter the other: their sum has no error."""
    axes = cl.Axis("unknown", 1), cl.Axis("unknown", 1)
    swing = np.array([0.3, -0.1]).reshape(2, 1, 1, 1)
    one = TransferMatrix(np.full((1, 1, 1), 0.4), *axes, swing)
    other = TransferMatrix(np.full((1, 1, 1), 0.6), *axes, -swing)
    assert joint_sum([one, other]).standard_error.item() == 0
    apart = TransferMatrix(np.full((1, 1, 1), 0.6), *axes, -swing[:1])
    assert joint_sum([one, apart]).standard_error.item() == pytest.approx(0.19**0.5)
