"""Conditional evaluation in kernels.

A kernel computes packets of lanes, and masks the lanes that do not take part. Code
under a mask costs its full time even if no lane of a packet takes part. The code
evaluated here is skipped in such packets.
"""

from collections.abc import Callable
from typing import TypeVar

import drjit as dr
import mitsuba as mi

T = TypeVar("T")


def where_needed(
    active: mi.Bool, evaluate: Callable[[mi.Bool], T], otherwise: Callable[[], T]
) -> T:
    """Return values that are evaluated in packets with active lanes only.

    `evaluate` is called with the mask; inactive lanes have the values returned by
    `otherwise`, which are of the same types.
    """
    return dr.if_stmt((active,), active, evaluate, lambda _: otherwise())
