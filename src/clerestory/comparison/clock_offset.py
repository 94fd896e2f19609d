"""What moving the measured clock would do: a search that is told and never applied."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from clerestory.comparison.time_alignment import Pairs

FARTHEST = 120
STEP = 5
_FEWEST = 8


@final
@dataclass(frozen=True)
class Offset:
    """The shift of the measured times under which both sides agree best.

    Attributes
    ----------
    minutes : added to the measured times [min]
    rmse, rmse_unmoved : relative to the measured mean, with that shift and without
    """

    minutes: int
    rmse: float
    rmse_unmoved: float

    @property
    def matters(self) -> bool:
        """Whether the shift would lower the deviation by more than a tenth."""
        return self.minutes != 0 and self.rmse < 0.9 * self.rmse_unmoved


def search_offset(pairs_at: Callable[[int], Pairs]) -> Offset | None:
    """Return the best shift within two hours; None with too few pairs to tell.

    Parameters
    ----------
    pairs_at : the pairs that count, with the measured times that many minutes later
    """
    unmoved = pairs_at(0)
    if len(np.unique(unmoved.times)) < _FEWEST:
        return None
    enough = 0.8 * unmoved.measured.size
    found = {0: _variation(unmoved)}
    for minutes in range(-FARTHEST, FARTHEST + 1, STEP):
        pairs = pairs_at(minutes)
        if pairs.measured.size >= enough:
            found[minutes] = _variation(pairs)
    # Of equal shifts, the smallest
    best = min(found, key=lambda minutes: (found[minutes], abs(minutes)))
    return Offset(best, found[best], found[0])


def _variation(pairs: Pairs) -> float:
    deviation = pairs.simulated - pairs.measured
    return float(np.sqrt(np.mean(deviation**2)) / np.mean(pairs.measured))
