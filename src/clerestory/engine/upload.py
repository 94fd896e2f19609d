"""Arrays on the compute device: upload, search, and conversion of kernel errors."""

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
    dr.VarType.Float64: np.float64,
    dr.VarType.UInt32: np.uint32,
    dr.VarType.Int32: np.int32,
    dr.VarType.Bool: np.bool_,
}

# Alignment of arrays for CPU kernels [bytes].
_ALIGNED = 64


def on_device(kind: type, values: ArrayLike):
    """Return a one-dimensional Dr.Jit array of the values, opaque to the compiler.

    An empty array becomes a single zero, because kernels accept no empty arrays. CPU
    arrays share their memory with NumPy; the memory is aligned, because kernels for
    unaligned memory would be compiled separately.
    """
    row = np.ravel(values)
    number = _NUMBERS[dr.type_v(kind)]
    size = max(len(row), 1) * np.dtype(number).itemsize
    memory = np.zeros(size + _ALIGNED, dtype=np.uint8)
    start = -memory.ctypes.data % _ALIGNED
    laid = memory[start : start + size].view(number)
    laid[: len(row)] = row
    made = kind(laid)
    dr.make_opaque(made)
    return made


def vectors(kind: type, values: Float[np.ndarray, "n 3"]):
    """Return the rows of an array as Dr.Jit points, vectors or colours."""
    number = dr.value_t(kind)
    return kind(*(on_device(number, column) for column in np.asarray(values).T))


def search(table, count: int, value, first=0):
    """Return how many of `count` - 1 ascending entries do not exceed a value."""

    def reached(number):
        return dr.gather(type(table), table, first + number) <= value

    return mi.UInt32(dr.binary_search(0, count - 1, reached))


@contextmanager
def launching() -> Iterator[None]:
    """Convert errors of Dr.Jit and Mitsuba to a `DeviceError` of one line.

    Interruptions remain `KeyboardInterrupt`.
    """
    try:
        yield
    except RuntimeError as error:
        if _is_interruption(error):
            raise KeyboardInterrupt from error
        reason = str(error).strip().splitlines()[-1]
        raise DeviceError(f"the trace failed on {mi.variant()}: {reason}") from error


def _is_interruption(error: BaseException | None) -> bool:
    # Whether a signal that arrived while Dr.Jit recorded a loop caused the error
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None
