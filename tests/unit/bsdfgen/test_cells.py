"""Cells of trees: numbers of branches, and where noise lets a block stay apart."""

import numpy as np
import pytest

from clerestory.bsdf.tree_lookup import look_up
from clerestory.bsdfgen.flux_preserving_merge import HemisphericalFlux, preserve_flux
from clerestory.bsdfgen.morton_codes import incident_code, pair_code
from clerestory.bsdfgen.subcells import subcell_slots, whole_cells
from clerestory.bsdfgen.tree_pruning import NodeValues, pruned_levels, selected_cells

WHOLE = np.array([1.0])


def levels(value, noise, rank, depth):
    """Levels above cells of which those that hold nothing are left out."""
    lit = np.flatnonzero(value > 0)
    finest = NodeValues(lit, value[lit, None], noise[lit])
    return pruned_levels(finest, WHOLE, rank=rank, levels=depth)


def whole(cells, depth):
    """Cells as pieces that are not cut."""
    return whole_cells(cells.place, cells.height, depth=depth)


def expanded(cells, pieces, rank):
    """Value of each finest cell; NaN where there is no piece."""
    value = np.full(1 << rank * (len(pieces) - 1), np.nan)
    for height, part in enumerate(pieces):
        rows = value.reshape(-1, 1 << rank * height)
        assert np.all(np.isnan(rows[part.place]))
        rows[part.place] = (cells.value[part.cell, 0] * part.factor)[:, None]
    return value


@pytest.mark.parametrize("rank", [3, 4])
def test_places_take_branches_apart_and_together(rank):
    """The incident part of a joined place is what it was joined from."""
    levels_ = 3
    incident = np.arange(1 << (rank - 2) * levels_)
    leaving = np.arange(1 << 2 * levels_)
    place = pair_code(incident[:, None], leaving, rank=rank, levels=levels_)
    assert len(np.unique(place)) == 1 << rank * levels_
    back = incident_code(place, rank=rank, levels=levels_)
    assert np.array_equal(back, np.broadcast_to(incident[:, None], place.shape))


def test_pure_noise_is_joined():
    """Even light counted by a Poisson process becomes few cells near its mean."""
    rng = np.random.default_rng(1)
    count = rng.poisson(3.0, 1 << 12).astype(float)
    cells = selected_cells(levels(count, count, 4, 3), rank=4)
    assert len(cells.value) < 300
    error = np.sqrt(np.mean((expanded(cells, whole(cells, 3), 4) - 3) ** 2))
    assert error < 0.3 * np.sqrt(3.0)


def test_peaks_stay_apart():
    """A bright cell in a dim field keeps its value, and the field stays joined."""
    rng = np.random.default_rng(2)
    truth = np.full(1 << 12, 0.5)
    truth[777] = 5000.0
    count = rng.poisson(truth).astype(float)
    cells = selected_cells(levels(count, count, 4, 3), rank=4)
    assert expanded(cells, whole(cells, 3), 4)[777] == count[777]
    assert len(cells.value) < 400


def test_cells_keep_the_light():
    """However cells are chosen, their sum is that of the counts."""
    rng = np.random.default_rng(3)
    count = rng.poisson(rng.exponential(4, 1 << 9)).astype(float)
    cells = selected_cells(levels(count, count, 3, 3), rank=3)
    assert expanded(cells, whole(cells, 3), 3).sum() == pytest.approx(count.sum())


def looked_up(slots, rank, depth):
    """Slot at each finest place, by the tables that read files."""
    number = np.arange(1 << rank * depth)
    place = np.zeros((rank, len(number)), dtype=np.int32)
    for dimension in range(rank):
        for level in range(depth):
            bit = (number >> (rank * level + dimension)) & 1
            place[dimension] |= (bit << level).astype(np.int32)
    return look_up(slots, tuple(place), depth=depth)[0].view(np.int32)


def test_slots_lead_to_the_cells():
    """Looking up each finest place finds the piece that it lies in."""
    rng = np.random.default_rng(4)
    depth, rank = 2, 4
    count = rng.poisson(rng.exponential(30, 1 << rank * depth)).astype(float)
    cells = selected_cells(levels(count, count, rank, depth), rank=rank)
    pieces = whole(cells, depth)
    number = looked_up(subcell_slots(pieces, rank=rank), rank, depth)
    cell = np.concatenate([part.cell for part in pieces])
    found = cells.value[cell[number], 0]
    assert np.array_equal(found, expanded(cells, pieces, rank))


def steep_block(seed=4, paths=200):
    """Counts of a block whose light in all differs from incident cell to cell."""
    rng = np.random.default_rng(seed)
    depth = 3
    incident = incident_code(np.arange(1 << 4 * depth), rank=4, levels=depth)
    share = rng.uniform(0.1, 0.9, 4**depth)
    mean = share[incident] / 4**depth * paths
    count = rng.poisson(mean).astype(float)
    size = np.pi / 4**depth * paths
    return incident, count, count / size, count / size**2


def kept_block(depth, variance, paths=200):
    """Cells of a steep block, pieces that keep its light, and what was counted."""
    incident, count, value, noise = steep_block(paths=paths)
    cells = selected_cells(levels(value, noise, 4, depth), rank=4)
    counted = np.bincount(incident, count) / paths
    light = HemisphericalFlux(counted, np.full(len(counted), variance))
    luminous = cells.value[:, 0]
    kept = preserve_flux(whole(cells, depth), luminous, light, rank=4)
    return cells, kept, incident, counted


def test_joined_cells_keep_the_light_of_each_incident_cell():
    """Single values are lost in noise; the light in all is known ten times better."""
    depth = 3
    cells, kept, incident, counted = kept_block(depth, 0.0)

    def in_all(pieces):
        # `expanded` has found that no place is in two pieces
        value = expanded(cells, pieces, 4)
        assert not np.any(np.isnan(value))
        return np.bincount(incident, value) * np.pi / 4**depth

    before = in_all(whole(cells, depth))
    assert np.abs(before - counted).max() > 0.1
    assert np.abs(in_all(kept) - counted).max() < 0.02 + 1e-9
    assert in_all(kept).sum() == pytest.approx(before.sum())


def test_slots_of_cut_cells_lead_to_their_values():
    depth = 3
    cells, kept, _, _ = kept_block(depth, 0.0)
    number = looked_up(subcell_slots(kept, rank=4), 4, depth)
    cell = np.concatenate([part.cell for part in kept])
    factor = np.concatenate([part.factor for part in kept])
    found = (cells.value[cell, 0] * factor)[number]
    assert np.array_equal(found, expanded(cells, kept, 4))


def test_light_that_is_hardly_known_cuts_nothing():
    cells, kept, _, _ = kept_block(3, 100.0)
    assert [len(part) for part in kept] == [len(part) for part in whole(cells, 3)]


@pytest.mark.parametrize("rank", [3, 4])
def test_dark_pieces_are_not_cut(rank):
    """Where one half of a block is dark, light is moved in the other alone."""
    branch = np.arange(1 << rank)
    lit = branch >> (rank - 1) == 0
    pieces = whole_cells(branch, np.ones(len(branch), int), depth=2)
    share = np.tile([0.05, 0.4], 1 << 2 * (rank - 2) - 1)
    light = HemisphericalFlux(share, np.zeros(len(share)))
    kept = preserve_flux(pieces, np.where(lit, 0.2, 0.0), light, rank=rank)
    assert len(kept[0])
    assert np.all(lit[kept[0].cell])
