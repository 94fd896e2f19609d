"""Picture files: Radiance (.hdr, .pic) and OpenEXR (.exr).

Readers detect the format from the first bytes; writers choose it by the extension.
"""

from pathlib import Path

from clerestory.checks import one_of
from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.image.exr import read_exr, write_exr
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import read_radiance, write_radiance

SUFFIXES = (".hdr", ".pic", ".exr")
_EXR = b"\x76\x2f\x31\x01"


def read_picture(path: str | Path) -> Picture:
    """Return the picture in a Radiance or OpenEXR file.

    Raises
    ------
    InputError : the file is missing, damaged, or in another format
    """
    start = read_bytes(path)[:4]
    if start.startswith(b"#?"):
        return read_radiance(path)
    if start == _EXR:
        return read_exr(path)
    raise InputError(
        "not a picture; a Radiance picture (starting with #?) or OpenEXR expected",
        file=path,
    )


def write_picture(picture: Picture, path: str | Path) -> None:
    """Write a picture in Radiance format (.hdr, .pic) or OpenEXR (.exr).

    Raises
    ------
    InputError : unknown extension
    OutputError : the file cannot be written
    """
    suffix = Path(path).suffix.lower()
    one_of(suffix, f"extension of {path}", choices=SUFFIXES)
    write = write_exr if suffix == ".exr" else write_radiance
    write(picture, path)
