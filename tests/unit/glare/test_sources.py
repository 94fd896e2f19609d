"""Glare sources in pictures for which they can be determined by hand."""

import numpy as np
import pytest
from glare_rooms import SIZE, eye, room

from clerestory.errors import InputError
from clerestory.glare.detection_criteria import SourceRules, Zone
from clerestory.glare.picture_sources import tabulate
from clerestory.glare.smoothing import surrounded
from clerestory.glare.sources import (
    SourceSearch,
    find_sources,
    threshold_luminance,
)
from clerestory.glare.zones import Zones, cut_along

# 1° a pixel: 0.1 rad are 5.7 pixels
NEAR, FAR = 5, 7


def sources(luminance, **rules):
    return tabulate(
        find_sources(luminance, eye(), SourceRules(**rules)), luminance, eye()
    )


def test_a_dark_room_has_no_source():
    assert sources(room()).count == 0


def test_bright_spots_within_a_tenth_of_a_radian_are_one_source():
    luminance = room()
    luminance[60, [50, 50 + NEAR]] = 5000
    assert sources(luminance).count == 1
    luminance = room()
    luminance[60, [50, 50 + FAR]] = 5000
    assert sources(luminance).count == 2


def test_sources_join_along_a_chain():
    luminance = room()
    luminance[60, 40:70:NEAR] = 5000
    assert sources(luminance).count == 1


def test_arms_that_meet_late_in_the_scan_are_one_source():
    """The scan starts both arms of a fork as sources of their own."""
    luminance = room()
    luminance[40:42, 40:60] = luminance[70:73, 40:60] = 5000
    luminance[40:73, 60] = 5000
    assert sources(luminance).count == 1


def test_the_merging_angle_decides():
    luminance = room()
    luminance[60, [50, 50 + FAR]] = 5000
    assert sources(luminance, merge_angle=0.4).count == 1


def test_luminance_and_solid_angle_of_a_source_are_its_pixels():
    luminance = room()
    luminance[50:54, 30:40] = 3000
    luminance[50:54, 36:40] = 9000
    table = sources(luminance)
    omega = eye().solid_angle[50:54, 30:40]
    assert table.solid_angle[0] == pytest.approx(omega.sum(), rel=1e-9)
    expected = (omega * luminance[50:54, 30:40]).sum() / omega.sum()
    assert table.luminance[0] == pytest.approx(expected, rel=1e-9)
    assert table.pixels[0] == 40
    weight = eye().eye_weight[50:54, 30:40] * luminance[50:54, 30:40]
    assert table.illuminance[0] == pytest.approx(weight.sum(), rel=1e-9)


def test_a_peak_becomes_a_source_of_its_own():
    luminance = room()
    luminance[40:60, 40:60] = 8000
    luminance[50:52, 50:52] = 1e6
    table = sources(luminance)
    assert table.luminance.round().tolist() == [8000, 1e6]
    assert table.pixels.tolist() == [396, 4]
    assert sources(luminance, peak_luminance=None).count == 1
    assert sources(luminance, peak_luminance=2e6).count == 1


def test_peaks_far_apart_in_one_source_stay_apart():
    luminance = room()
    luminance[40:60, 40:60] = 8000
    luminance[42, 42] = luminance[58, 58] = 1e6
    assert sources(luminance).pixels.tolist() == [398, 1, 1]


def test_small_sources_can_be_left_out():
    luminance = room()
    luminance[100, 90] = luminance[40:50, 40:50] = 5000
    found = sources(luminance)
    assert found.larger_than(0.002).count == 1


def test_a_threshold_can_follow_the_mean_or_the_task():
    luminance = room(100)
    luminance[80:100, 50:70] = 300
    task = Zone(90, 60, 0.2)
    by_task = SourceRules(threshold=5, threshold_kind="times_task", task=task)
    assert threshold_luminance(luminance, eye(), by_task) == pytest.approx(1500)
    by_mean = SourceRules(threshold=2, threshold_kind="times_mean")
    weight = eye().solid_angle
    mean = (weight * luminance).sum() / weight.sum()
    assert threshold_luminance(luminance, eye(), by_mean) == pytest.approx(2 * mean)


def test_smoothing_fills_a_hole():
    luminance = room()
    luminance[40:60, 40:60] = 5000
    luminance[50, 50] = 100
    assert sources(luminance).pixels[0] == 399
    assert sources(luminance, smooth=True).pixels[0] >= 400


def test_a_disc_over_nothing_is_not_surrounded():
    mine = np.zeros((SIZE, SIZE), bool)
    mine[60:64, 60:64] = True
    inside = surrounded(mine, np.ones((SIZE, SIZE)), 2.0)
    assert inside[62, 62]
    assert not inside[50, 50]


def test_zones_cut_a_source_along_their_borders():
    luminance = room()
    luminance[50:70, 30:90] = 5000
    found = find_sources(luminance, eye())
    zones = Zones(Zone(60, 60, 0.3), 0.6)
    parts, zone = cut_along(found, zones.of_pixels(eye()))
    table = tabulate(parts, luminance, eye(), zone=zone)
    assert table.zone.tolist() == [0, 2, 1]
    whole = tabulate(found, luminance, eye())
    assert table.solid_angle.sum() == pytest.approx(whole.solid_angle.sum())
    assert table.illuminance.sum() == pytest.approx(whole.illuminance.sum())


def test_what_guths_field_does_not_hold_is_no_source():
    luminance = room()
    luminance[4:8, 88:92] = 5000  # 84° up
    assert sources(luminance).count == 1
    assert sources(luminance, field_of_view="total").count == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"threshold": 0.0}, "threshold is 0; a positive"),
        ({"merge_angle": float("nan")}, "merging angle is nan"),
        ({"peak_luminance": -1.0}, "peak luminance is -1"),
        ({"smallest": -1.0}, "smallest source is -1"),
        ({"threshold_kind": "times_task"}, "without a task zone"),
    ],
)
def test_rules_out_of_range_are_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        SourceRules(**arguments)


def test_a_task_outside_of_the_picture_is_refused():
    rules = SourceRules(
        threshold=5, threshold_kind="times_task", task=Zone(500, 1, 0.2)
    )
    with pytest.raises(InputError, match="row 500, column 1 of a picture of 180 × 180"):
        find_sources(room(), eye(), rules)


@pytest.mark.parametrize("share", [0.003, 0.03, 0.3])
def test_pictures_searched_together_have_the_sources_of_each(share):
    """Bright spots at random, on all sides of the view; the fourth picture has none."""
    view, random = eye(), np.random.default_rng(int(1e4 * share))
    pictures = 3000.0 * (random.random((4, *view.shape)) < share)
    pictures[1, :, 60:], pictures[3] = 0, 0
    search = SourceSearch(view, SourceRules(merge_angle=np.radians(12)))
    together = search.members([picture[None] for picture in pictures])
    for picture, (found, _) in zip(pictures, together, strict=True):
        alone = find_sources(picture, view, search.rules)
        for own, other in zip(found, alone, strict=True):
            assert np.array_equal(own, other)
