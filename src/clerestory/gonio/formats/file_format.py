"""Interface of goniophotometer file formats.

Each module of this package that defines `FORMAT` is registered as a file format.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from clerestory.bsdf.scattering_function import Function
from clerestory.gonio.scattering_measurement import Measurement

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
    """Information about a measurement that some file formats do not contain."""

    # Measured scattering function; None for the default of the format
    function: Function | None = None
    facing: Facing = "room"  # side to which the normal of the sample points
    # File of readings without a sample; None if not available
    blank: Path | None = None


@dataclass(frozen=True)
class FileFormat:
    """Reader of one goniophotometer file format."""

    name: str  # name of the format, as in the option `--format`
    # Function that returns whether a file with a given head is in the format
    recognizes: Callable[[FileHead], bool]
    # Function that returns the measurements in a file, one per scattering function and
    # channel; errors without a file name refer to this file
    read: Callable[[Path, ReadOptions], Iterable[Measurement]]
