"""Processor time of a call, for tests that something does not take minutes."""

import gc
import time
from collections.abc import Callable


def least_processor_time(call: Callable[[], object], *, attempts: int = 3) -> float:
    """Return the least processor time of some calls [s].

    Other programs slow down one call or another, and collections of garbage take longer
    the more a process of many tests has allocated.
    """
    taken = []
    gc.disable()
    try:
        for _ in range(attempts):
            begin = time.process_time()
            call()
            taken.append(time.process_time() - begin)
    finally:
        gc.enable()
    return min(taken)
