"""Cells of trees: numbers of branches, and where noise lets a block stay apart."""

import numpy as np
import pytest

from clerestory.bsdf.tree_table import look_up
from clerestory.bsdfgen.branches import incident_part, joined
from clerestory.bsdfgen.keep_light import SummedLight, keep_light
from clerestory.bsdfgen.refine import chosen_cells, climbed, finest_light

WHOLE = np.array([1.0])


def levels(value, noise, rank, depth):
    """Levels above cells of which those that hold nothing are left out."""
    lit = np.flatnonzero(value > 0)
    finest = finest_light(lit, value[lit, None], noise[lit], WHOLE)
    return climbed(finest, WHOLE, rank=rank, levels=depth)


def expanded(cells, rank, depth):
    """Value of each finest cell."""
    value = np.empty(1 << rank * depth)
    for place, height, mean in zip(
        cells.place, cells.height, cells.value[:, 0], strict=True
    ):
        size = 1 << rank * height
        value[place * size : (place + 1) * size] = mean
    return value


@pytest.mark.parametrize("rank", [3, 4])
def test_places_take_branches_apart_and_together(rank):
    """The incident part of a joined place is what it was joined from."""
    levels_ = 3
    incident = np.arange(1 << (rank - 2) * levels_)
    leaving = np.arange(1 << 2 * levels_)
    place = joined(incident[:, None], leaving, rank=rank, levels=levels_)
    assert len(np.unique(place)) == 1 << rank * levels_
    back = incident_part(place, rank=rank, levels=levels_)
    assert np.array_equal(back, np.broadcast_to(incident[:, None], place.shape))


def test_pure_noise_is_joined():
    """Even light counted by a Poisson process becomes few cells near its mean."""
    rng = np.random.default_rng(1)
    count = rng.poisson(3.0, 1 << 12).astype(float)
    cells = chosen_cells(levels(count, count, 4, 3), rank=4)
    assert len(cells.value) < 300
    error = np.sqrt(np.mean((expanded(cells, 4, 3) - 3) ** 2))
    assert error < 0.3 * np.sqrt(3.0)


def test_peaks_stay_apart():
    """A bright cell in a dim field keeps its value, and the field stays joined."""
    rng = np.random.default_rng(2)
    truth = np.full(1 << 12, 0.5)
    truth[777] = 5000.0
    count = rng.poisson(truth).astype(float)
    cells = chosen_cells(levels(count, count, 4, 3), rank=4)
    assert expanded(cells, 4, 3)[777] == count[777]
    assert len(cells.value) < 400


def test_cells_keep_the_light():
    """However cells are chosen, their sum is that of the counts."""
    rng = np.random.default_rng(3)
    count = rng.poisson(rng.exponential(4, 1 << 9)).astype(float)
    cells = chosen_cells(levels(count, count, 3, 3), rank=3)
    assert expanded(cells, 3, 3).sum() == pytest.approx(count.sum())


def test_slots_lead_to_the_cells():
    """Looking up each finest place finds the cell that it lies in."""
    rng = np.random.default_rng(4)
    depth, rank = 2, 4
    count = rng.poisson(rng.exponential(30, 1 << rank * depth)).astype(float)
    cells = chosen_cells(levels(count, count, rank, depth), rank=rank)
    values = cells.value[:, 0].astype(np.float32)
    inner = cells.slots < 0
    slots = np.where(
        inner, cells.slots, values.view(np.int32)[np.where(inner, 0, cells.slots)]
    ).astype(np.int32)
    number = np.arange(1 << rank * depth)
    place = np.zeros((rank, len(number)), dtype=np.int32)
    for dimension in range(rank):
        for level in range(depth):
            bit = (number >> (rank * level + dimension)) & 1
            place[dimension] |= (bit << level).astype(np.int32)
    found, _ = look_up(slots, tuple(place), depth=depth)
    assert np.array_equal(found, expanded(cells, rank, depth).astype(np.float32))


def steep_block(seed=4, paths=200):
    """Counts of a block whose light in all differs from incident cell to cell."""
    rng = np.random.default_rng(seed)
    depth = 3
    incident = incident_part(np.arange(1 << 4 * depth), rank=4, levels=depth)
    share = rng.uniform(0.1, 0.9, 4**depth)
    mean = share[incident] / 4**depth * paths
    count = rng.poisson(mean).astype(float)
    size = np.pi / 4**depth * paths
    return incident, count, count / size, count / size**2


def test_joined_cells_keep_the_light_of_each_incident_cell():
    """Single values are lost in noise; the light in all is known ten times better."""
    depth, paths = 3, 200
    incident, count, value, noise = steep_block(paths=paths)
    cells = chosen_cells(levels(value, noise, 4, depth), rank=4)
    counted = np.bincount(incident, count) / paths
    light = SummedLight(counted, np.zeros(len(counted)))
    kept = keep_light(cells, light, WHOLE, rank=4, depth=depth)
    size = np.pi / 4**depth

    def in_all(found):
        return np.bincount(incident, expanded(found, 4, depth)) * size

    assert np.abs(in_all(cells) - counted).max() > 0.1
    assert np.abs(in_all(kept) - counted).max() < 0.02 + 1e-9
    assert in_all(kept).sum() == pytest.approx(in_all(cells).sum())
    # Every finest cell still belongs to one cell
    span = 1 << 4 * kept.height
    assert span.sum() == 1 << 4 * depth
    assert np.array_equal(np.sort(kept.slots[kept.slots >= 0]), np.arange(len(span)))


def test_slots_of_cut_cells_lead_to_their_values():
    depth = 3
    incident, count, value, noise = steep_block()
    cells = chosen_cells(levels(value, noise, 4, depth), rank=4)
    light = SummedLight(np.bincount(incident, count) / 200, np.zeros(64))
    kept = keep_light(cells, light, WHOLE, rank=4, depth=depth)
    for number in (0, len(kept.place) // 2, len(kept.place) - 1):
        place, height = int(kept.place[number]), int(kept.height[number])
        slot = int(kept.slots[0])
        for level in range(depth - height - 1, -1, -1):
            branch = place >> 4 * level & 15
            slot = int(kept.slots[~slot + branch])
        assert slot == number


def test_light_that_is_hardly_known_cuts_nothing():
    incident, count, value, noise = steep_block()
    cells = chosen_cells(levels(value, noise, 4, 3), rank=4)
    share = np.bincount(incident, count) / 200
    vague = SummedLight(share, np.full(64, 100.0))
    kept = keep_light(cells, vague, WHOLE, rank=4, depth=3)
    assert np.array_equal(kept.slots, cells.slots)
