"""Numbers in table cells of text files, with line numbers in error messages."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from clerestory.errors import InputError


def number(
    cells: Sequence[str], index: int, *, name: str, file: str | Path, line: int
) -> float:
    """Return the number in a cell; raise `InputError` if it is not a finite number."""
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


@dataclass(frozen=True, eq=False)
class DataRows:
    """Table rows of a text file.

    Attributes
    ----------
    file : name of the file
    cells : texts of the cells of each row
    lines : line number of each row in the file
    """

    file: str | Path
    cells: Sequence[Sequence[str]]
    lines: Int[np.ndarray, " row"]

    @classmethod
    def below(
        cls, header_lines: int, rows: Iterable[Sequence[str]], *, file: str | Path
    ) -> "DataRows":
        """Return the non-empty rows below a header."""
        rows = list(rows)
        kept = [i for i, row in enumerate(rows) if i >= header_lines and row]
        if not kept:
            raise InputError(
                "no data rows after the header", file=file, line=max(len(rows), 1)
            )
        return cls(file, [rows[i] for i in kept], np.array(kept) + 1)

    def column(
        self, index: int, name: str, *, may_miss: bool = False
    ) -> Float[np.ndarray, " row"]:
        """Return a column of numbers; with `may_miss`, empty cells are NaN."""
        try:
            values = np.array([row[index] for row in self.cells], dtype=float)
            if np.all(np.isfinite(values)):
                return values
        except (ValueError, IndexError):
            pass

        # Convert cell by cell, to report the line of an invalid cell
        values = np.empty(len(self.cells))
        for i, row in enumerate(self.cells):
            blank = index < len(row) and row[index].strip().lower() in ("", "nan", "na")
            line = int(self.lines[i])
            values[i] = (
                np.nan
                if may_miss and blank
                else number(row, index, name=name, file=self.file, line=line)
            )
        return values
