"""Pictures from files, whatever their format; the contents tell it, not the name."""

from pathlib import Path

from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import read_radiance


def read_picture(path: str | Path) -> Picture:
    """Return the picture of a file: Radiance's .hdr or .pic.

    Raises
    ------
    InputError : the file is missing, broken, or in another format
    """
    start = read_bytes(path)[:4]
    if start.startswith(b"#?"):
        return read_radiance(path)
    raise InputError("not a picture; Radiance's #? expected", file=path)
