"""Klems angle bases of LBNL WINDOW.

Names of bases are ambiguous: "LBNL/Klems Half" has 73 patches in old Radiance and 77 in
WINDOW. File readers therefore build the partition from the rings in the file; the bases
here are WINDOW's present definitions, used for traced matrices.

In the frame of a window (right, up, normal into the room) the first patch of a ring is
to the right, and the following patches run upwards. For incident and exiting light
alike, the patch is that of the direction of travel into the room, so that undeviated
light has equal patch numbers.

References: J. H. Klems, ASHRAE Transactions 100 (1), 1994; LBNL WINDOW 7 technical
documentation, angle bases.
"""

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import one_of
from clerestory.hemisphere.partition import RingPartition

_RINGS: dict[str, tuple[tuple[float, ...], tuple[int, ...]]] = {
    "full": (
        (0, 5, 15, 25, 35, 45, 55, 65, 75, 90),
        (1, 8, 16, 20, 24, 24, 24, 16, 12),
    ),
    "half": ((0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90), (1, 8, 12, 16, 20, 12, 8)),
    "quarter": ((0, 9, 27, 45, 63, 90), (1, 8, 12, 12, 8)),
}


def klems(basis: str = "full") -> RingPartition:
    """Return the Klems basis "full" (145 patches), "half" (77) or "quarter" (41).

    Raises
    ------
    InputError : unknown basis

    Examples
    --------
    >>> lam = klems("full").projected_solid_angles()
    >>> lam.size, round(float(lam.sum()), 12)
    (145, 3.14159265359)
    """
    one_of(basis, "Klems basis", choices=_RINGS)
    limits_deg, count = map(np.array, _RINGS[basis])
    name = f"LBNL/Klems {basis.capitalize()}"
    return from_rings(name, limits_deg=limits_deg.astype(float), count=count)


def from_rings(
    name: str,
    *,
    limits_deg: Float[np.ndarray, " limits"],
    count: Int[np.ndarray, " rings"],
) -> RingPartition:
    """Return the partition with the ring limits [°] and patch counts of a file."""
    theta = np.radians(np.asarray(limits_deg, dtype=float))
    return RingPartition(name, np.asarray(count, dtype=int), theta, azimuth="polar")
