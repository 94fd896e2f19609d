"""Upload of arrays to the device, and errors of its kernels."""

from collections.abc import Iterator
from contextlib import contextmanager

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from clerestory.errors import DeviceError

_NUMBERS = {
    dr.VarType.Float32: np.float32,
    dr.VarType.UInt32: np.uint32,
    dr.VarType.Int32: np.int32,
    dr.VarType.Bool: np.bool_,
}

# Where vectors of a processor's kernels begin.
_ALIGNED = 64


def on_device(kind: type, values: ArrayLike):
    """Return values on the device, in one row.

    Kernels take no empty tables: without values there is one of zero. What processors
    share with NumPy is laid where their vectors begin: kernels for memory that lies
    otherwise differ, and would be compiled anew by chance.
    """
    row = np.ravel(values)
    number = _NUMBERS[dr.type_v(kind)]
    size = max(len(row), 1) * np.dtype(number).itemsize
    memory = np.zeros(size + _ALIGNED, dtype=np.uint8)
    start = -memory.ctypes.data % _ALIGNED
    laid = memory[start : start + size].view(number)
    laid[: len(row)] = row
    return kind(laid)


def vectors(kind: type, values: Float[np.ndarray, "n 3"]):
    """Return rows of three as points, vectors or colours on the device."""
    return kind(*(on_device(mi.Float, column) for column in np.asarray(values).T))


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
