"""Search path of library files (RAYPATH)."""

import os
from collections.abc import Sequence
from pathlib import Path

from clerestory.errors import InputError, located
from clerestory.files import is_file


def library_file(name: str, *, beside: str | Path, line: int) -> Path:
    """Return the path of a file to which a scene file refers; errors give the line.

    The folder of the scene file is searched, then the current directory and the folders
    in the environment variable RAYPATH. Absolute paths are used as they are.
    """
    listed = [Path(f) for f in os.environ.get("RAYPATH", "").split(os.pathsep) if f]
    with located(file=beside, line=line):
        return found_in(name, [Path(beside).parent, Path(), *listed])


def found_in(name: str, folders: Sequence[Path]) -> Path:
    """Return the path of a file in the first folder that contains it."""
    for folder in dict.fromkeys(folders):
        if is_file(folder / name):
            return folder / name
    tried = ", ".join(str(folder) for folder in dict.fromkeys(folders))
    raise InputError(f'the file "{name}" is missing; searched in {tried}')
