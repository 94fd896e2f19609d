"""Plans: the cut through the walls, the cells of the sensors, the frame."""

from dataclasses import replace

import numpy as np
import pytest
from lxml import html

from clerestory.report.colour import percent_scale
from clerestory.report.content import WindowSurface
from clerestory.report.content_from_results import from_results
from clerestory.report.floor_plan import plan, plan_frame
from clerestory.report.mesh_lines import horizontal_section, visible_extent
from clerestory.report.metric_maps import metric_maps
from clerestory.scene.sensor_cells import sensor_cells


def area(outlines):
    x, y = outlines[..., 0], outlines[..., 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)


def test_the_cut_of_a_room_is_its_perimeter(room):
    corners = np.array(room.box((0, 0, 0), (4, 3, 2.5)))
    segments = horizontal_section(corners, height=1.2)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * (4 + 3))


def test_a_cut_at_the_height_of_a_surface_does_not_fail(room):
    corners = np.array(room.box((0, 0, 0), (1, 1, 0.75)))
    assert len(horizontal_section(corners, height=0.75)) == 0


def test_a_plan_frames_the_room_and_not_the_town(room):
    corners = np.concatenate(
        [room.box((0, 0, 0), (6, 9, 3)), room.box((30, 0, 0), (60, 50, 20))]
    )
    segments = horizontal_section(corners, height=0.8)
    low, high = visible_extent(segments, np.array([[3.0, 4.0], [2.0, 8.0]]))
    assert np.allclose(low, [0, 0], atol=1e-6)
    assert np.allclose(high, [6, 9], atol=1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.3, -0.7])
def test_cells_of_a_turned_grid_tile_the_floor(turn):
    x, y = np.meshgrid(np.arange(5) * 0.6, np.arange(8) * 0.9)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    cells = sensor_cells(np.stack([x.ravel(), y.ravel()], axis=-1) @ rotation.T)
    assert np.allclose(area(cells), 0.6 * 0.9)
    # Every cell has the corners of its neighbours
    corners = np.unique((cells @ rotation).reshape(-1, 2).round(3), axis=0)
    assert len(corners) == 6 * 9


def test_scattered_sensors_become_discs():
    points = np.random.default_rng(0).uniform(0, 5, size=(40, 2))
    cells = sensor_cells(points)
    assert cells.shape[1] > 8
    assert np.allclose(cells.mean(axis=1), points)


def test_sensors_at_one_place_have_a_cell_each():
    cells = sensor_cells(np.zeros((4, 2)))
    assert cells.shape == (4, 4, 2)
    assert np.all(area(cells) > 0)


def test_north_is_up_and_east_is_right(room):
    content = from_results(room.analytic_results(times=room.year(days=1)))
    frame = plan_frame(content, np.arange(77), identifier="p")
    origin, east, north = frame.place(np.array([[0.0, 0], [1, 0], [0, 1]]))
    assert east[0] - origin[0] == pytest.approx(frame.scale)
    assert north[1] - origin[1] == pytest.approx(-frame.scale)


def test_upright_sensors_are_arrows_that_point_where_they_look(room):
    content = from_results(room.analytic_results(times=room.year(days=1)))
    eyes = np.arange(77, 81)
    frame = plan_frame(content, eyes, identifier="p")
    assert not frame.level
    tips = frame.cells[:, 3] - frame.points
    ahead = np.sum(tips * content.sensors.direction[eyes, :2], axis=1)
    assert np.allclose(ahead, np.linalg.norm(tips, axis=1))


def test_a_skylight_is_outlined_without_the_seams_of_its_triangles(room):
    content = from_results(room.analytic_results(times=room.year(days=1)))
    pane = np.array(room.quad((2, 6, 2.7), (2, 8, 2.7), (4, 8, 2.7), (4, 6, 2.7)))
    up, down = np.array([0.0, 1, 0]), np.array([0.0, 0, -1])
    content = replace(content, windows=(WindowSurface("roof", pane, down, up),))
    members = np.arange(77)
    metric = metric_maps(content.metrics)[1]
    drawing = plan(
        plan_frame(content, members, identifier="p"),
        metric,
        members,
        scale=percent_scale(),
        content=content,
        label="plan",
    )
    (outline,) = html.fromstring(drawing).xpath("//*[@class='window overhead']/@d")
    assert outline.count("M") == 4
