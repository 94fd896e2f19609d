"""Morton codes of the cells of tensor trees.

A code has one digit per level, the coarsest in the highest bits. A digit has one bit
per dimension of the tree (rank 3 or 4); the incident dimensions have the lowest bits.
"""

from functools import cache

import numpy as np
from jaxtyping import Int

from clerestory.array_types import Indices

# Number of code bits that one table lookup converts.
_TABLE_BITS = 16

_Number = Int[np.ndarray, "*batch"]


def incident_code(number: _Number, *, rank: int, levels: int) -> _Number:
    """Morton code of the incident cell in the last `levels` levels of a tree code."""
    found = np.zeros_like(number)
    together = _TABLE_BITS // rank
    for first in range(0, levels, together):
        digits = min(together, levels - first)
        some = (number >> rank * first) & ((1 << rank * digits) - 1)
        part = _incident_parts(rank, digits)[some].astype(number.dtype)
        found |= part << (rank - 2) * first
    return found


@cache
def _incident_parts(rank: int, digits: int) -> Indices:
    # Lookup table of the incident cell for each code with `digits` digits
    number = np.arange(1 << rank * digits)
    found = np.zeros_like(number)
    bits = rank - 2
    for level in range(digits):
        digit = (number >> rank * level) & ((1 << bits) - 1)
        found |= digit << bits * level
    return found


def pair_code(
    incident: Int[np.ndarray, " *incident"],
    leaving: Int[np.ndarray, " *leaving"],
    *,
    rank: int,
    levels: int,
) -> Int[np.ndarray, " *place"]:
    """Morton code of a pair of an incident and an exit cell."""
    bits = rank - 2
    found = np.zeros(np.broadcast_shapes(incident.shape, leaving.shape), dtype=int)
    for level in range(levels):
        one = (incident >> bits * level) & ((1 << bits) - 1)
        other = (leaving >> 2 * level) & 3
        found |= (one | (other << bits)) << rank * level
    return found
