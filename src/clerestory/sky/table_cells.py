"""Numbers out of the cells of text files, with the line to blame when one is not."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError


def number(
    cells: Sequence[str], index: int, *, name: str, file: str | Path, line: int
) -> float:
    """Return the finite number in one cell.

    Raises
    ------
    InputError : the cell is missing, or not a finite number
    """
    if index >= len(cells):
        raise InputError(
            f"{len(cells)} fields; {name} expected as field {index + 1}",
            file=file,
            line=line,
        )
    try:
        value = float(cells[index])
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(
            f"{name} is {cells[index].strip()!r}; a number expected",
            file=file,
            line=line,
        )
    return value


def column(
    rows: Sequence[Sequence[str]],
    index: int,
    *,
    name: str,
    file: str | Path,
    lines: Sequence[int] | np.ndarray,
    may_miss: bool = False,
) -> Float[np.ndarray, " rows"]:
    """Return one column of rows of cells; NaN where a cell is empty and may be.

    Raises
    ------
    InputError : a row ends before the column, or its cell is not a number
    """
    try:
        values = np.array([row[index] for row in rows], dtype=float)
        if np.all(np.isfinite(values)):
            return values
    except (ValueError, IndexError):
        pass

    # Slow path: find the cell to blame, or the ones that may be left out
    values = np.empty(len(rows))
    for i, row in enumerate(rows):
        blank = index < len(row) and row[index].strip().lower() in ("", "nan", "na")
        if may_miss and blank:
            values[i] = np.nan
        else:
            values[i] = number(row, index, name=name, file=file, line=int(lines[i]))
    return values
