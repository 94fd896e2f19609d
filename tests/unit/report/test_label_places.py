"""Numbers of dots in a plot."""

import numpy as np

from clerestory.report.label_places import label_places

WIDTH, HEIGHT, RADIUS = 7.5, 9.0, 6.0


def boxes(places):
    return [
        (x, y - HEIGHT, x + WIDTH * len(str(k)), y)
        for k, (x, y) in enumerate(places, start=1)
    ]


def overlap(one, other):
    return min(one[2], other[2]) > max(one[0], other[0]) and min(
        one[3], other[3]
    ) > max(one[1], other[1])


def test_a_single_number_is_above_right_of_its_dot():
    assert label_places([(100.0, 50.0)], radius=RADIUS) == [(109.0, 44.0)]
    assert label_places([], radius=RADIUS) == []


def test_numbers_of_a_row_of_close_dots_do_not_overlap():
    """Dots that touch: each number is clear of the others and of all dots."""
    dots = [(100.0 + 7 * k, 100.0 - 4 * k) for k in range(6)]
    found = boxes(label_places(dots, radius=RADIUS))
    discs = [(x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS) for x, y in dots]
    for k, own in enumerate(found):
        assert not any(overlap(own, other) for other in found[:k])
        assert not any(overlap(own, disc) for disc in discs)


def test_every_dot_has_a_number_even_in_a_crowd():
    dots = [(0.0, 0.0)] * 40
    places = label_places(dots, radius=RADIUS)
    assert len(places) == 40
    assert np.abs(np.array(places)).max() < 60
