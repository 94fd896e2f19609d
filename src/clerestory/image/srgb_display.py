"""Display images in 8-bit sRGB, written as PNG or JPEG.

The input is the output of a tone mapping: linear red, green and blue in the primaries
of Radiance, from 0 (black) to 1 (display white).
"""

from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from clerestory.checks import one_of
from clerestory.colorimetry import RADIANCE, SRGB, conversion
from clerestory.files import replace_file

# File extensions, and the names of the formats in Pillow
_FORMATS: dict[str, Literal["PNG", "JPEG"]] = {
    ".png": "PNG",
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
}


def to_srgb(
    display: Float[np.ndarray, "row column 3"],
) -> UInt8[np.ndarray, "row column 3"]:
    """Convert linear display values to sRGB code values.

    White is preserved. Values above white or outside the sRGB gamut are clipped.
    Source: IEC 61966-2-1:1999.

    >>> to_srgb(np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]])).tolist()
    [[[0, 0, 0], [255, 255, 255]]]
    """
    linear = np.clip(display @ conversion(RADIANCE, SRGB).T.astype(display.dtype), 0, 1)
    curved = np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    )
    return np.asarray(np.round(255 * curved), dtype=np.uint8)


def write_display(pixels: UInt8[np.ndarray, "row column 3"], path: str | Path) -> None:
    """Write sRGB code values as .png or .jpg."""
    suffix = Path(path).suffix.lower()
    one_of(suffix, f"extension of {path}", choices=_FORMATS)
    kind = _FORMATS[suffix]
    with replace_file(path) as stream:
        Image.fromarray(pixels).save(stream, format=kind, quality=92, optimize=True)
