"""Numbers in table cells of text files, with line numbers in error messages."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.checks import require
from clerestory.errors import located


def numbers(
    cells: Sequence[str], fields: Mapping[str, int], line: int = 1
) -> list[float]:
    """Return the finite numbers in the cells with the given names and indices."""
    found = []
    for name, index in fields.items():
        require(
            index < len(cells),
            f"{len(cells)} fields; {name} expected as field {index + 1}",
            line=line,
        )
        try:
            value = float(cells[index])
        except ValueError:
            value = np.nan
        require(
            np.isfinite(value),
            f"{name} is {cells[index].strip()!r}; a number expected",
            line=line,
        )
        found.append(value)
    return found


@dataclass(frozen=True, eq=False)
class DataRows:
    """Cells of the table rows of a text file, and line number of each row."""

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
        end = max(len(rows), 1)
        require(kept, "no data rows after the header", file=file, line=end)
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
        values = np.full(len(self.cells), np.nan)
        for i, row in enumerate(self.cells):
            blank = index < len(row) and row[index].strip().lower() in ("", "nan", "na")
            if not (may_miss and blank):
                with located(file=self.file):
                    (values[i],) = numbers(row, {name: index}, int(self.lines[i]))
        return values

    def require(
        self, valid: Bool[np.ndarray, " row"], message: Callable[[int], str]
    ) -> None:
        """Raise `InputError` with the line number of the first invalid row, if any."""
        if not np.all(valid):
            i = int(np.argmin(valid))
            require(False, message(i), file=self.file, line=int(self.lines[i]))
