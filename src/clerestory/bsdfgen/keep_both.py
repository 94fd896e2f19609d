"""Pieces of a tree's cells that keep the light of incident and of leaving cells.

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
from clerestory.bsdfgen.pieces import Pieces


def keep_both(
    pieces: list[Pieces],
    luminous: Float[np.ndarray, " cell"],
    incident: SummedLight,
    leaving: SummedLight,
) -> list[Pieces]:
    """Return pieces of rank 4 that keep the light of incident and of leaving cells.

    Parameters
    ----------
    pieces : by their height above the finest cells, up to the root
    luminous : value of each cell [1/sr]
    incident, leaving : as they were counted

    Examples
    --------
    Four leaving cells of two brightnesses, joined:

    >>> from clerestory.bsdfgen.pieces import uncut
    >>> one = uncut(np.array([0]), np.array([1]), depth=1)
    >>> even = SummedLight(np.pi * np.full(4, 0.2), np.zeros(4))
    >>> share = np.pi * np.array([0.1, 0.3, 0.1, 0.3])
    >>> kept = keep_both(one, np.array([0.2]), even, SummedLight(share, np.zeros(4)))
    >>> kept[0].factor[::4].round(3).tolist()
    [0.5, 1.5, 0.5, 1.5]
    """
    for light, by_leaving in ((incident, False), (leaving, True), (incident, False)):
        pieces = keep_light(pieces, luminous, light, rank=4, by_leaving=by_leaving)
    return pieces
