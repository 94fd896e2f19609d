"""Images for displays: 8 bits in sRGB, written as PNG or JPEG.

The input is display-referred: red, green and blue in Radiance's primaries, linear,
0 black and 1 the display's white; the tone mappings of this package make it.
"""

from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from clerestory.colorimetry import RADIANCE, SRGB, conversion
from clerestory.errors import InputError
from clerestory.files import replace_file

# Endings of files and Pillow's names of their formats
_FORMATS: dict[str, Literal["PNG", "JPEG"]] = {
    ".png": "PNG",
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
}


def to_srgb(
    display: Float[np.ndarray, "row column 3"],
) -> UInt8[np.ndarray, "row column 3"]:
    """Linear display values as sRGB code values.

    White stays white. What the display cannot show is cut: brighter than white, or a
    colour outside its triangle.

    References
    ----------
    IEC 61966-2-1:1999

    >>> to_srgb(np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]])).tolist()
    [[[0, 0, 0], [255, 255, 255]]]
    """
    matrix = conversion(RADIANCE, SRGB).T.astype(display.dtype)
    linear = np.clip(display @ matrix, 0, 1)
    curved = np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    )
    codes: np.ndarray = np.round(255 * curved).astype(np.uint8)
    return codes


def write_display(pixels: UInt8[np.ndarray, "row column 3"], path: str | Path) -> None:
    """Write sRGB code values as .png or .jpg.

    Raises
    ------
    InputError : another ending
    OutputError : the file cannot be written
    """
    kind = _FORMATS.get(Path(path).suffix.lower())
    if kind is None:
        raise InputError(f'"{path}"; a name ending in {", ".join(_FORMATS)} expected')
    with replace_file(path) as stream:
        Image.fromarray(pixels).save(stream, format=kind, quality=92, optimize=True)
