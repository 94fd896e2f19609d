"""Path guiding: cells of a room, and the sampling probabilities learned for them."""

import numpy as np
import pytest

from clerestory.engine.device import load
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import DistantSource, Glass, Light, Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors

RADIANCE = 100.0


@pytest.fixture
def cells(device):
    return load(device, "guiding_cells").GuidingCells


def test_cells_distinguish_positions_and_orientations(cells):
    import mitsuba as mi

    grid = cells.around(np.array([[0.0, 0.0, 0.0], [3.0, 1.5, 0.7]] * 200))
    assert [int(along[0]) for along in grid.shape] == [4, 2, 1]
    assert grid.count == 48
    places = mi.Point3f([0.1, 2.9, 0.1, 0.1], [0.1, 0.1, 1.4, 0.1], [0.3] * 4)
    up, down = mi.Vector3f(0, 0.1, 1), mi.Vector3f(0, 0.1, -1)
    faced = [np.array(grid.number(places, normal)) for normal in (up, down)]
    assert len(set(faced[0])) == 3
    assert faced[0][0] == faced[0][3]
    assert not set(faced[0]) & set(faced[1])
    far = mi.Point3f([-1e6, 1e6], [0, 0], [0, 0])
    assert np.all(np.array(grid.number(far, up)) < grid.count)


def test_sunlit_points_do_not_decide_the_probabilities_in_the_shade(device):
    """A cell's own pilot samples tell its shares, however bright it is elsewhere.

    Thirty samples in each of two cells: in the shade one part has all the light, out
    in the sun, ten thousand times as bright, the other. Two of all samples beside
    thirty of its own give a part (30 + 2/2)/32 of the squares.
    """
    sizes = load(device, "path_guiding").root_mean_squares
    samples = np.repeat([[1.0, 0.0], [0.0, 1e4]], 30, axis=0)
    found = sizes(samples, np.repeat([0, 1], 30), 3) ** 2
    assert found[0] == pytest.approx([31 / 32, 1 / 32])
    assert found[1] == pytest.approx([1 / 32, 31 / 32])
    assert found[2] == pytest.approx([0.5, 0.5])


def box_with_two_panes(first, second):
    """A black box under a sky, with panes of given transmissivity in its roof."""

    def sheet(material, x, y, height=3.0, up=False):
        corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        corners = corners if up else corners[::-1]
        return Polygon(np.array([(*c, height) for c in corners]), material, material)

    materials = {
        "wall": Plastic("wall", np.zeros(3)),
        "first": Glass("first", np.full(3, first), 1.0),
        "second": Glass("second", np.full(3, second), 1.0),
        "sky": Light("sky", np.full(3, RADIANCE)),
    }
    strips = [((-9, -2), (-9, 9)), ((-1, 1), (-9, 9)), ((2, 9), (-9, 9))]
    strips += [((a, a + 1), y) for a in (-2, 1) for y in ((-9, -0.5), (0.5, 9))]
    surfaces = [sheet("wall", *strip) for strip in strips]
    surfaces.append(sheet("first", (-2, -1), (-0.5, 0.5)))
    surfaces.append(sheet("second", (1, 2), (-0.5, 0.5)))
    surfaces.append(sheet("wall", (-9, 9), (-9, 9), 0.0, up=True))
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        (x, y), (u, v) = (((-9, -9), (9, -9), (9, 9), (-9, 9))[i] for i in (a, b))
        side = np.array([(x, y, 0.0), (x, y, 3.0), (u, v, 3.0), (u, v, 0.0)])
        surfaces.append(Polygon(side, "wall", "wall"))
    sky = DistantSource(np.array([0.0, 0.0, 1.0]), 180.0, "sky")
    return Scene(materials, tuple(surfaces), (sky,))


def light_of_pane(x, y, height):
    """E = L ∫ cos² / r² over a clear pane of one square metre."""
    u, v = np.meshgrid(*[(np.arange(200) + 0.5) / 200 - 0.5] * 2)
    r2 = (x - u) ** 2 + (y - v) ** 2 + height**2
    return RADIANCE * np.mean(height**2 / r2**2)


@pytest.mark.parametrize("clear", [(1.0, 1e-9), (1e-9, 1.0)])
def test_a_dark_pane_takes_no_directions_from_a_clear_one(device, clear):
    """Both panes look alike from the sensor: half the directions would miss."""
    scene = box_with_two_panes(*clear)
    place = np.array([[0.0, 0.0, 0.5]])
    sensor = Sensors(place, np.array([[0.0, 0.0, 1.0]]))
    found = irradiance(scene, sensor, samples=4096, device=device)
    expected = light_of_pane(1.5, 0.0, 2.5)
    assert found.irradiance[0, 0] == pytest.approx(expected, abs=5 * found.error[0, 0])
    assert found.error[0, 0] < 0.03 * expected
