"""View out through the openings of a room, with rays of the tracer."""

from functools import partial

import numpy as np
import pytest

from clerestory.metrics.view_out import GROUND, LANDSCAPE, Opening, view_out
from clerestory.phases.unscattered_light import first_surfaces
from clerestory.radiance.rad_reader import read_rad

ROOM = """
void plastic grey 0 0 5 .5 .5 .5 0 0
void glass clear 0 0 3 .96 .96 .96
grey polygon partition 0 0 12  -5 1.5 0  0 1.5 0  0 1.5 3  -5 1.5 3
grey polygon across 0 0 12  -900 -25 -9  900 -25 -9  900 -25 90  -900 -25 90
grey polygon ground 0 0 12  -900 -900 0  900 -900 0  900 -.2 0  -900 -.2 0
clear polygon pane 0 0 12  -1 0 .8  1 0 .8  1 0 2.2  -1 0 2.2
"""


def test_width_and_distance_of_a_traced_scene(tmp_path):
    """A partition hides half; clear glass is passed; a building stands at 25 m."""
    (tmp_path / "room.rad").write_text(ROOM)
    scene = read_rad(tmp_path / "room.rad")
    corners = np.array([[-1, 0, 0.8], [1, 0, 0.8], [1, 0, 2.2], [-1, 0, 2.2]])
    eyes = np.array([[0.0, 3.0, 1.2], [0.5, 1.0, 1.2]])
    openings = [Opening(corners, np.array([0.0, 1, 0]))]
    found = view_out(eyes, openings, partial(first_surfaces, scene, device="cpu"))
    whole = np.arctan(0.5) + np.arctan(1.5)  # the second eye is before the partition
    expected = np.degrees([np.arctan(1 / 3), whole])
    assert found.width_deg == pytest.approx(expected, rel=1e-6)
    assert found.distance == pytest.approx([25.0, 25.0], rel=1e-5)
    assert found.layers.tolist() == [LANDSCAPE | GROUND] * 2
