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
    """First bytes of a file, from which its format is recognized.

    Attributes
    ----------
    data : first bytes of the file
    lines : non-blank lines of text in lower case; empty for binary files
    """

    data: bytes
    lines: tuple[str, ...]

    def has_line(self, *starts: str) -> bool:
        """Whether a line starts with one of the given texts."""
        return any(line.startswith(starts) for line in self.lines)


@dataclass(frozen=True)
class ReadOptions:
    """Information about a measurement that some file formats do not contain.

    Attributes
    ----------
    function : measured scattering function; None for the default of the format
    facing : side to which the normal of the sample points
    blank : file of readings without a sample; None if not available
    """

    function: Function | None = None
    facing: Facing = "room"
    blank: Path | None = None


@dataclass(frozen=True)
class FileFormat:
    """Reader of one goniophotometer file format.

    Attributes
    ----------
    name : name of the format, as in the option `--format`
    recognizes : function that returns whether a file with a given head is in the format
    read : function that returns the measurements in a file, one per scattering function
        and channel; errors without a file name refer to this file
    """

    name: str
    recognizes: Callable[[FileHead], bool]
    read: Callable[[Path, ReadOptions], Iterable[Measurement]]
