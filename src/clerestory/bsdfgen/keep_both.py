"""Cells of a tree that keep the light of incident and of leaving cells.

A tree is read both ways: one transmission tells of light from the room and, by
reciprocity, of light from the sky. Incident cells are given their light, then the
leaving ones, then the incident ones again: iterative proportional fitting, of which one
turn does nearly all.

Reference: W. E. Deming, F. F. Stephan, "On a least squares adjustment of a sampled
frequency table when the expected marginal totals are known", Annals of Mathematical
Statistics 11 (4), 1940.
"""

import numpy as np
from jaxtyping import Float

from clerestory.bsdfgen.keep_light import SummedLight, keep_light
from clerestory.bsdfgen.refine import Cells


def keep_both(
    cells: Cells,
    incident: SummedLight,
    leaving: SummedLight,
    weights: Float[np.ndarray, " channel"],
    *,
    depth: int,
) -> Cells:
    """Return cells of rank 4 that keep the light of incident and of leaving cells.

    Parameters
    ----------
    incident, leaving : as they were counted
    weights : share of each channel in the luminous value
    depth : halvings of each coordinate down to the finest cells

    Examples
    --------
    Four leaving cells of two brightnesses, joined:

    >>> one = Cells(np.array([0], dtype=np.int32), np.array([[0.2]]), np.zeros(1),
    ...             np.array([0]), np.array([1]))
    >>> even = SummedLight(np.pi * np.full(4, 0.2), np.zeros(4))
    >>> share = np.pi * np.array([0.1, 0.3, 0.1, 0.3])
    >>> leaving = SummedLight(share, np.zeros(4))
    >>> kept = keep_both(one, even, leaving, np.ones(1), depth=1)
    >>> kept.value[::4, 0].round(3).tolist()
    [0.1, 0.3, 0.1, 0.3]
    """
    for light, by_leaving in ((incident, False), (leaving, True), (incident, False)):
        cells = keep_light(
            cells, light, weights, rank=4, depth=depth, by_leaving=by_leaving
        )
    return cells
