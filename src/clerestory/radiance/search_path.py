"""Files that scenes name without a folder: where Radiance would find them."""

import os
from pathlib import Path

from clerestory.errors import InputError


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
    folders = dict.fromkeys([Path(beside).parent, Path(), *listed])
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    tried = ", ".join(str(folder) for folder in folders)
    raise InputError(
        f'the file "{name}" is missing; looked for in {tried}', file=beside, line=line
    )
