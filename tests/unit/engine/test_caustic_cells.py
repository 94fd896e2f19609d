"""Cones of caustics that small cells take from larger ones."""

import numpy as np

from clerestory.engine.device import load

load("cpu")

from clerestory.engine.caustic_lobes import Level, keys
from clerestory.engine.cone_fits import ConeArrays

CELLS = np.array([[0, 0, 0], [1, 0, 3], [9, 9, 9], [-1, 0, 0]])


def level(size, cells, kinds, width):
    """A level of cells with one cone of each kind in each cell, and the slots."""
    side = np.zeros(len(cells), dtype=np.int64)
    key = keys(cells, side)
    slots = 1 << (4 * len(cells)).bit_length()
    taken = key & (slots - 1)
    owner = np.zeros(slots, dtype=np.int64)
    place = np.zeros((slots, 3), dtype=np.int64)
    owner[taken], place[taken] = key, cells
    count = len(cells) * len(kinds)
    some = np.random.default_rng(0).random((count, 3))
    cones = ConeArrays(
        np.repeat(taken, len(kinds)), np.tile(kinds, len(cells)), np.ones(count),
        some, some, np.zeros((count, 3, 3)), some, np.full((count, 2), width),
    )  # fmt: skip
    return Level(size, owner, place, np.zeros(slots, dtype=np.int64), cones), taken


def test_small_cells_take_cones_of_kinds_that_they_lack():
    """Weights are roots of power, which is in proportion to the area of the cells."""
    small, slots = level(0.25, CELLS, [5, 7], 0.01)
    large, _ = level(1.0, np.array([[0, 0, 0], [5, 5, 5]]), [7, 8, 9], 0.1)
    extended = small.extended(large).cones
    for slot, inside in zip(slots, [True, True, False, False], strict=True):
        here = extended.some(np.flatnonzero(extended.slot == slot))
        found = dict(zip(here.kind.tolist(), here.weight.tolist(), strict=True))
        own = {5: 1.0, 7: 1.0}
        assert found == (own | {8: 0.25, 9: 0.25} if inside else own)
        assert np.all(here.width[here.weight == 1] == 0.01)


def test_narrower_cones_of_larger_cells_replace_wide_ones():
    """More particles have been fitted by them; the weight of the cell remains."""
    small, slots = level(0.25, CELLS, [5, 7], 0.2)
    large, _ = level(1.0, np.array([[0, 0, 0]]), [7], 0.1)
    extended = small.extended(large).cones
    here = extended.some(np.flatnonzero(extended.slot == slots[0]))
    widths = dict(zip(here.kind.tolist(), here.width[:, 0].tolist(), strict=True))
    assert widths == {5: 0.2, 7: 0.1}
    assert np.all(here.weight == 1)
