"""The search around many pixels at once, against the search around each of them."""

import numpy as np
import pytest
from glare_rooms import eye

from clerestory.glare import neighbour_search
from clerestory.glare.mask_stack import MaskStack
from clerestory.glare.neighbour_search import Neighbourhood, first_found
from clerestory.glare.scan_search import previous_pixels


def one_by_one(row, column, mask, near):
    """Row and column found for each pixel, of the pixels scanned before."""
    number = np.arange(1, mask.size + 1).reshape(mask.shape)
    found = []
    for y, x in zip(row.tolist(), column.tolist(), strict=True):
        scanned = mask.copy()
        scanned[: y + 1, x] = scanned[:, x + 1 :] = False
        labels = np.where(scanned, number, 0)
        wanted = np.arange(mask.size + 1) > 0
        window = near.window(y, x)
        label = 0
        for upwards in (True, False):
            label = label or first_found(
                labels, wanted, window, y, x, upwards=upwards, last_column=x
            )
        found.append(np.unravel_index(label - 1, mask.shape) if label else (-1, -1))
    return np.array(found).T


@pytest.mark.parametrize("share", [0.002, 0.02, 0.2])
@pytest.mark.parametrize("angle_deg", [1.5, 4.0, 9.0])
def test_all_searches_find_what_each_of_them_finds(share, angle_deg):
    view = eye()
    random = np.random.default_rng(int(1e4 * share + angle_deg))
    mask = (random.random(view.shape) < share) & view.valid
    row, column = np.nonzero(mask)
    some = random.permutation(row.size)[:150]
    near = Neighbourhood(view, np.radians(angle_deg))
    found = previous_pixels(row[some], column[some], MaskStack(mask, len(mask)), near)
    assert np.array_equal(found, one_by_one(row[some], column[some], mask, near))


def test_spans_are_forgotten_when_memory_is_full(monkeypatch):
    view = eye()
    near = Neighbourhood(view, 0.1)
    known = Neighbourhood(view, 0.1)
    row, column = np.nonzero(view.valid)
    row, column = row[::97], column[::97]
    all_spans = known.spans(row, column)
    monkeypatch.setattr(neighbour_search, "_KEPT", 40_000)
    for first in range(0, row.size, 10):
        some = slice(first, first + 20)
        spans = near.spans(row[some], column[some])
        assert np.array_equal(spans.begin, all_spans.begin[some])
        assert np.array_equal(spans.length, all_spans.length[some])
