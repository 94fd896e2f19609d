"""Interface of readers of goniophotometer files, and parsing of tables of numbers.

Each module of this package that defines `FORMAT` is registered as a file format.
"""

import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import Function
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.scattering_measurement import Measurement, Scan

Facing = Literal["room", "sky"]


@dataclass(frozen=True)
class FileHead:
    """First bytes of a file, from which its format is recognized."""

    data: bytes  # first bytes of the file
    # Non-blank lines of text in lower case; empty for binary files
    lines: tuple[str, ...]

    def has_line(self, *starts: str) -> bool:
        """Whether a line starts with one of the given texts."""
        return any(line.startswith(starts) for line in self.lines)


@dataclass(frozen=True)
class ReadOptions:
    """Properties of a measurement that some file formats do not state."""

    # Measured scattering function; None for the default of the format
    function: Function | None = None
    facing: Facing = "room"  # side to which the normal of the sample points
    # File of readings without a sample; None if not available
    blank: Path | None = None


@dataclass(frozen=True)
class FileFormat:
    """Reader of one goniophotometer file format."""

    name: str  # name of the format, as in the option `--format`
    # Function that returns whether the first bytes of a file are in the format
    recognizes: Callable[[FileHead], bool]
    # Function that returns the measurements in a file, one per scattering function and
    # channel; the caller adds the file name to errors
    read: Callable[[Path, ReadOptions], Iterable[Measurement]]


Line = tuple[int, str]

_SEPARATOR = re.compile(r"[,;\s]+")

# Upper limit of the polar angles of scattered directions [°].
_LARGEST_THETA_DEG = 89.99

# Largest number in a file; larger ones overflow when multiplied
_LARGEST = 1e15


def numbered_lines(path: Path, *, comment: str | None = None) -> list[Line]:
    """Return the non-blank lines of a file, with line numbers from 1.

    `comment`: prefix of comment lines, which are skipped.
    """
    return [
        (number, text)
        for number, text in enumerate(read_text(path).splitlines(), 1)
        if text.strip() and not (comment and text.lstrip().startswith(comment))
    ]


def number(text: str, *, what: str, line: int) -> float:
    """Parse a text as a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    valid = abs(value) <= _LARGEST
    require(valid, f"{text[:40]!r}; {what} expected", line=line)
    return value


def table(
    lines: Iterable[Line], *, columns: int, what: str
) -> Float[np.ndarray, "rows columns"]:
    """Parse lines as a table of numbers; blank lines and # lines are skipped.

    >>> table([(1, "1, 2"), (2, "3 4")], columns=2, what="pairs").tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    rows: list[list[float]] = []
    for place, text in lines:
        line = text.strip()
        if not line or line.startswith("#"):
            continue
        words = _SEPARATOR.split(line)
        found = f"number of columns is {len(words)}; {columns} expected: {what}"
        require(len(words) == columns, found, line=place)
        rows.append([number(word, what=what, line=place) for word in words])
    require(rows, f"no data; lines of {what} expected")
    return np.array(rows)


def check_angles(theta_deg: Values, *, most: float, what: str = "θ") -> None:
    """Require polar angles from 0 to `most` [°]."""
    wrong = theta_deg[(theta_deg < 0) | (theta_deg > most)]
    if wrong.size:
        found = f"{what} is {wrong[0]:g}°; 0 to {most:g}° expected"
        raise InputError(f"{found}; are the columns of θ and φ swapped?")


def scan_of_rows(
    incident: Sequence[float], data: Float[np.ndarray, "rows 3"], path: Path
) -> Scan:
    """Return a scan from incident θ and φ [°] and rows of θ, φ [°] and BSDF [1/sr].

    Incident and scattered φ are measured from the same axis.
    """
    check_angles(np.array(incident[:1]), most=90, what="incident θ")
    check_angles(data[:, 0], most=90)
    leaving = from_degrees(np.minimum(data[:, 0], _LARGEST_THETA_DEG), data[:, 1])
    return Scan(from_degrees(*incident), leaving, data[:, 2], str(path))


def scan_of_block(lines: Sequence[Line], path: Path, *, scale: float = 1.0) -> Scan:
    """Return a scan from a line of incident θ and φ [°] and lines of θ, φ and BSDF.

    The incident φ is the azimuth of propagation: mirror reflection is at the same φ.
    """
    ((theta, phi),) = table(lines[:1], columns=2, what="incident θ and φ [°]")
    data = table(lines[1:], columns=3, what="θ, φ [°] and BSDF [1/sr]")
    return scan_of_rows((float(theta), float(phi) + 180), data * [1, 1, scale], path)
