"""Checks of input values, with uniform error messages.

Each function raises `InputError` "WHAT is VALUE; EXPECTED expected" unless its
condition holds. The location of a fault is added by `errors.located`, or by the
arguments `file` and `line` of `require`.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Sized
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from clerestory.errors import InputError

# Largest number of characters of a value in a message
_SHOWN = 60


def require(
    valid: object,
    message: str,
    *,
    file: str | Path | None = None,
    line: int | None = None,
    error: type[InputError] = InputError,
) -> None:
    """Raise an input error unless a condition is true.

    The message states the fault and the expected input.

    >>> require(2 + 2 == 4, "arithmetic fails")
    >>> require(False, "no photographs; two or more expected")
    Traceback (most recent call last):
    clerestory.errors.InputError: no photographs; two or more expected
    """
    if not valid:
        raise error(message, file=file, line=line)


def positive(value: npt.ArrayLike, what: str, *, unit: str = "") -> None:
    """Require finite numbers above zero; the message states the first invalid number.

    >>> positive([2, -1.5], "height", unit="m")
    Traceback (most recent call last):
    clerestory.errors.InputError: height is -1.5 m; a positive number expected
    """
    number = np.asarray(value, dtype=float)
    valid = (number > 0) & np.isfinite(number)
    _require_all(valid, number, what, unit, "a positive number")


def not_negative(value: npt.ArrayLike, what: str, *, unit: str = "") -> None:
    """Require finite numbers of at least zero."""
    number = np.asarray(value, dtype=float)
    valid = (number >= 0) & np.isfinite(number)
    _require_all(valid, number, what, unit, "0 or more")


def finite(value: npt.ArrayLike, what: str, *, unit: str = "") -> None:
    """Require finite numbers."""
    number = np.asarray(value, dtype=float)
    _require_all(np.isfinite(number), number, what, unit, "a finite number")


def within(
    value: npt.ArrayLike, what: str, *, least: float, most: float, unit: str = ""
) -> None:
    """Require numbers from `least` to `most`, both included.

    >>> within(1.2, "reflectance", least=0, most=1)
    Traceback (most recent call last):
    clerestory.errors.InputError: reflectance is 1.2; a number from 0 to 1 expected
    """
    number = np.asarray(value, dtype=float)
    valid = (number >= least) & (number <= most)
    _require_all(valid, number, what, unit, f"a number from {least:g} to {most:g}")


def one_of(value: object, what: str, *, choices: Collection[object]) -> None:
    """Require one of a few values.

    >>> one_of("blue", "band", choices=("red", "green"))
    Traceback (most recent call last):
    clerestory.errors.InputError: band is 'blue'; one of red, green expected
    """
    listed = ", ".join(map(str, choices))
    require(value in choices, f"{what} is {_shown(value)}; one of {listed} expected")


def same_length(one: Sized, other: Sized, what: str, of: str) -> None:
    """Require as many elements in `one` as in `other`.

    >>> same_length([1, 2], "abc", "states", "time steps")
    Traceback (most recent call last):
    clerestory.errors.InputError: 2 states for 3 time steps; equal numbers expected
    """
    counts = f"{len(one)} {what} for {len(other)} {of}"
    require(len(one) == len(other), f"{counts}; equal numbers expected")


def has_shape(
    array: npt.NDArray[Any],
    shape: tuple[int, ...],
    what: str,
    *,
    file: str | Path | None = None,
    error: type[InputError] = InputError,
) -> None:
    """Require an array of a given shape.

    >>> has_shape(np.zeros(3), (2, 3), "score")
    Traceback (most recent call last):
    clerestory.errors.InputError: score has shape (3,); (2, 3) expected
    """
    message = f"{what} has shape {array.shape}; {shape} expected"
    require(array.shape == shape, message, file=file, error=error)


def distinct(names: Iterable[str], what: str) -> None:
    """Require names without duplicates.

    >>> distinct(["a", "b", "a"], "windows")
    Traceback (most recent call last):
    clerestory.errors.InputError: several windows are named 'a'; unique names expected
    """
    repeated = [repr(name) for name, count in Counter(names).items() if count > 1]
    message = f"several {what} are named {', '.join(repeated)}; unique names expected"
    require(not repeated, message)


def _require_all(
    valid: npt.NDArray[np.bool_],
    number: npt.NDArray[np.float64],
    what: str,
    unit: str,
    expected: str,
) -> None:
    # Require that all numbers are valid
    if not np.all(valid):
        first = f"{number[~valid].flat[0]:g} {unit}".strip()
        raise InputError(f"{what} is {first}; {expected} expected")


def _shown(value: object) -> str:
    # Text of a value in a message, shortened if long
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
