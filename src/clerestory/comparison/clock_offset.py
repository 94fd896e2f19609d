"""Clock offset between measurement and simulation: the shift of smallest CV(RMSE).

The offset is reported but not applied.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from clerestory.comparison.time_alignment import Pairs

# Largest time shift and step of the search [min]
_LARGEST, _STEP = 120, 5

# Smallest number of distinct times required for a search
_FEWEST = 8


@final
@dataclass(frozen=True)
class Offset:
    """Shift of the measured times with the best agreement.

    Attributes
    ----------
    minutes : time shift added to the measured times [min]
    rmse, rmse_unmoved : CV(RMSE) with and without the time shift
    """

    minutes: int
    rmse: float
    rmse_unmoved: float

    @property
    def matters(self) -> bool:
        """Whether the time shift reduces CV(RMSE) by more than a tenth."""
        return self.minutes != 0 and self.rmse < 0.9 * self.rmse_unmoved


def search_offset(pairs_at: Callable[[int], Pairs]) -> Offset | None:
    """Return the best time shift up to two hours; None if there are too few pairs.

    Parameters
    ----------
    pairs_at : function that returns the pairs for a time shift [min]
    """
    unmoved = pairs_at(0)
    if len(np.unique(unmoved.times)) < _FEWEST:
        return None
    enough = 0.8 * unmoved.measured.size
    found = {0: _variation(unmoved)}
    for minutes in range(-_LARGEST, _LARGEST + 1, _STEP):
        pairs = pairs_at(minutes)
        if pairs.measured.size >= enough:
            found[minutes] = _variation(pairs)
    # Among time shifts of equal CV(RMSE), choose the smallest
    best = min(found, key=lambda minutes: (found[minutes], abs(minutes)))
    return Offset(best, found[best], found[0])


def _variation(pairs: Pairs) -> float:
    deviation = pairs.simulated - pairs.measured
    return float(np.sqrt(np.mean(deviation**2)) / np.mean(pairs.measured))
