"""Pictures from files, whatever their format; the contents tell it, not the name."""

from pathlib import Path

from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.image.exr import read_exr
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import read_radiance

_EXR = b"\x76\x2f\x31\x01"


def read_picture(path: str | Path) -> Picture:
    """Return the picture of a file: Radiance's .hdr or .pic, or OpenEXR.

    Raises
    ------
    InputError : the file is missing, broken, or in another format
    """
    start = read_bytes(path)[:4]
    if start.startswith(b"#?"):
        return read_radiance(path)
    if start == _EXR:
        return read_exr(path)
    raise InputError(
        "not a picture; Radiance's, which begins with #?, or OpenEXR expected",
        file=path,
    )
