"""Photographs of an exposure bracket and their exposures.

The exposure is computed from exposure time, ISO speed and f-number, which are given or
read from the EXIF data.
"""

import io
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8
from PIL import ExifTags, Image

from clerestory.checks import positive, require
from clerestory.errors import InputError
from clerestory.files import read_bytes

# Exceptions that Pillow raises on damaged files
_BROKEN = (
    OSError,
    ValueError,
    SyntaxError,
    EOFError,
    LookupError,
    TypeError,
    ArithmeticError,
    struct.error,
    Image.DecompressionBombError,
)

Photograph = UInt8[np.ndarray, "row column 3"]


@dataclass(frozen=True)
class Exposure:
    """Exposure settings of a photograph.

    Attributes
    ----------
    time : exposure time [s]
    aperture : f-number
    sensitivity : ISO speed
    """

    time: float
    aperture: float = 1.0
    sensitivity: float = 100.0

    def __post_init__(self) -> None:
        positive(self.time, "exposure time", unit="s")
        positive(self.aperture, "aperture")
        positive(self.sensitivity, "sensitivity")

    def relative(self) -> float:
        """Equivalent exposure time at f/1 and ISO 100 [s]."""
        return self.time * self.sensitivity / 100 / self.aperture**2


def read_photograph(path: str | Path) -> Photograph:
    """Return the pixels of a JPEG, PNG or TIFF photograph, row 0 at the top."""
    with opened_image(path) as image:
        require(
            image.mode in ("RGB", "RGBA", "L", "P"),
            f"photograph in pixel mode {image.mode}; 8-bit RGB or grey expected",
            file=path,
        )
        return np.asarray(image.convert("RGB"))


@contextmanager
def opened_image(
    path: str | Path, *, kind: str = "a photograph"
) -> Iterator[Image.Image]:
    """Open an image file; faults found while it is open are errors with its name."""
    data = io.BytesIO(read_bytes(path))
    try:
        with Image.open(data) as image:
            yield image
    except _BROKEN as error:
        raise InputError(f"not {kind}: {error}", file=path) from error


def read_exposure(path: str | Path) -> Exposure:
    """Return exposure time, f-number and ISO speed from EXIF data of a photograph."""
    with opened_image(path) as image:
        data = image.getexif().get_ifd(ExifTags.IFD.Exif)
    tags = {
        "time": ExifTags.Base.ExposureTime,
        "aperture": ExifTags.Base.FNumber,
        "sensitivity": ExifTags.Base.ISOSpeedRatings,
    }
    numbers = {}
    for name, tag in tags.items():
        value: Any = data.get(tag)
        value = value[0] if isinstance(value, tuple) and value else value
        try:
            numbers[name] = float(value)
        except (TypeError, ValueError, ZeroDivisionError):
            raise InputError(
                f"the EXIF data lack the {name}; give the exposure times explicitly",
                file=path,
            ) from None
    return Exposure(**numbers)
