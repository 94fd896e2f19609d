"""Description of a goniophotometer file format, as the registry holds it.

A module of this package that defines `FORMAT` is a format: nothing else needs to name
it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.gonio.scattering_measurement import Measurement

Facing = Literal["room", "sky"]


@dataclass(frozen=True)
class FileHead:
    """First bytes of a file, from which its format is recognized.

    Attributes
    ----------
    data : the bytes
    lines : lower-case lines of text that are not blank; none in binary files
    """

    data: bytes
    lines: tuple[str, ...]

    def has_line(self, *starts: str) -> bool:
        """Whether a line starts with one of some texts."""
        return any(line.startswith(starts) for line in self.lines)


@dataclass(frozen=True)
class ReadOptions:
    """Information that files of some formats lack.

    Attributes
    ----------
    function : scattering function that was measured; None for the format's default
    facing : side that the normal of the sample faces
    blank : file of readings without a sample
    """

    function: Function | None = None
    facing: Facing = "room"
    blank: Path | None = None


@dataclass(frozen=True)
class FileFormat:
    """One file format.

    Attributes
    ----------
    name : as `--format` takes it
    recognizes : whether the head of a file is of this format
    read : measurements in the files of one sample, one per function and channel
    """

    name: str
    recognizes: Callable[[FileHead], bool]
    read: Callable[[Sequence[Path], ReadOptions], tuple[Measurement, ...]]


def single_file(paths: Sequence[Path], kind: str) -> Path:
    """Return the one file of a format that has all directions in one file."""
    if len(paths) != 1:
        raise InputError(f"{len(paths)} {kind} files; one per measurement expected")
    return paths[0]
