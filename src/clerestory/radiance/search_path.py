"""Search path of the files that scenes name: RAYPATH."""

import os
from collections.abc import Sequence
from pathlib import Path

from clerestory.errors import InputError, located


def library_file(name: str, *, beside: str | Path, line: int) -> Path:
    """Return the path of a file that a scene names.

    Looked for in the folder of the file that names it, in the current directory and in
    the folders listed in the environment variable RAYPATH; a path from the root stands
    for itself.

    Parameters
    ----------
    beside, line : the file that names it, and where
    """
    listed = [Path(f) for f in os.environ.get("RAYPATH", "").split(os.pathsep) if f]
    with located(file=beside, line=line):
        return found_in(name, [Path(beside).parent, Path(), *listed])


def found_in(name: str, folders: Sequence[Path]) -> Path:
    """Return the path of a file in the first of some folders that has it."""
    for folder in dict.fromkeys(folders):
        if (folder / name).is_file():
            return folder / name
    tried = ", ".join(str(folder) for folder in dict.fromkeys(folders))
    raise InputError(f'the file "{name}" is missing; looked for in {tried}')
