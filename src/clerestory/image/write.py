"""Pictures to files; the ending tells the format."""

from pathlib import Path

from clerestory.errors import InputError
from clerestory.image.exr import write_exr
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import write_radiance


def write_picture(picture: Picture, path: str | Path) -> None:
    """Write a picture: .hdr and .pic are Radiance's format, .exr is OpenEXR's.

    Raises
    ------
    InputError : another ending
    OutputError : the file cannot be written
    """
    ending = Path(path).suffix.lower()
    if ending in (".hdr", ".pic"):
        write_radiance(picture, path)
    elif ending == ".exr":
        write_exr(picture, path)
    else:
        raise InputError(f'picture file "{path}"; .hdr, .pic or .exr expected')
