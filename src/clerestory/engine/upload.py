"""Arrays to the device, and what goes wrong there."""

from collections.abc import Iterator
from contextlib import contextmanager

import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.errors import DeviceError


def vectors(kind: type, values: Float[np.ndarray, "n 3"]):
    """Return rows of three as points, vectors or colours on the device.

    Kernels take no empty tables: without rows there is one of zeros.
    """
    rows = some(np.asarray(values))
    return kind(np.ascontiguousarray(rows.T.astype(np.float32)))


def some(values: np.ndarray) -> np.ndarray:
    """Return the values, or one entry that is never read where there are none."""
    return values if len(values) else np.zeros((1, *values.shape[1:]), values.dtype)


@contextmanager
def launching() -> Iterator[None]:
    """Turn the tracer's own errors into one line.

    Raises
    ------
    DeviceError : a kernel did not compile or run
    """
    try:
        yield
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1]
        raise DeviceError(f"the trace failed on {mi.variant()}: {reason}") from error
