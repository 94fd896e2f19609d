"""Lines of numbers, as all text formats of goniophotometers have them."""

import math
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.errors import InputError

_SEPARATOR = re.compile(r"[,;\s]+")


def number(text: str, *, what: str, file: str | Path, line: int) -> float:
    """Return the finite number of a text.

    Raises
    ------
    InputError : another text; names the line

    >>> number("0.5", what="a BSDF value", file="a.txt", line=3)
    0.5
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{text[:40]!r}; {what} expected", file=file, line=line)
    return value


def table(
    lines: Iterable[tuple[int, str]], *, columns: int, what: str, file: str | Path
) -> Float[np.ndarray, "rows columns"]:
    """Return the numbers of lines that all have the same number of columns.

    Blank lines and those that start with # are passed over.

    Raises
    ------
    InputError : a line with other than numbers or columns; names the line

    >>> table([(1, "1, 2"), (2, "3 4")], columns=2, what="pairs", file="a.txt").tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    rows: list[list[float]] = []
    for place, text in lines:
        line = text.strip()
        if not line or line.startswith("#"):
            continue
        words = _SEPARATOR.split(line)
        if len(words) != columns:
            raise InputError(
                f"{len(words)} columns; {columns} expected: {what}",
                file=file,
                line=place,
            )
        rows.append([number(word, what=what, file=file, line=place) for word in words])
    if not rows:
        raise InputError(f"no data; lines of {what} expected", file=file)
    return np.array(rows)


def check_angles(
    theta_deg: Values, *, most: float, file: str | Path, what: str = "θ"
) -> None:
    """Refuse angles to the normal outside 0…most [°].

    Raises
    ------
    InputError : angles out of range, as if columns were swapped
    """
    wrong = (theta_deg < 0) | (theta_deg > most)
    if np.any(wrong):
        value = float(theta_deg[wrong][0])
        raise InputError(
            f"{what} of {value:g}°; 0 to {most:g}° expected: are the columns of θ and"
            " φ swapped?",
            file=file,
        )
