"""OpenEXR pictures: red, green and blue in 16 or 32 bits, with header attributes.

Standard attributes of OpenEXR are chromaticities (of the primaries), whiteLuminance
[cd/m²] (of the colour (1, 1, 1)), pixelAspectRatio (width over height) and comments
(header lines). The view and the quantity are stored in the custom attributes
`radianceView` and `quantity`.
"""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from jaxtyping import Float32

from clerestory.colorimetry import RADIANCE, Primaries, conversion
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.files import read_bytes, replace_file
from clerestory.image.picture import Picture
from clerestory.radiance.view_text import format_view, parse_view

_MOST_PIXELS = 1 << 27

# Largest finite half-precision number (IEEE 754 binary16)
_LARGEST_HALF = 65504.0


def read_exr(path: str | Path) -> Picture:
    """Return an OpenEXR picture, converted to the primaries of Radiance.

    Default chromaticities are the primaries of Radiance; without whiteLuminance, values
    are radiances in W/(m²·sr). A single channel Y gives a grey picture.

    Raises
    ------
    InputError : the file is missing or damaged, has other channels, or contains values
        that are not finite
    """
    read_bytes(path)  # raises InputError with the reason if the file is unreadable
    try:
        header = OpenEXR.File(str(path), header_only=True).header()
        low, high = header["dataWindow"]
        size = [int(b) - int(a) + 1 for a, b in zip(low, high, strict=True)]
        if min(size) < 1 or size[0] * size[1] > _MOST_PIXELS:
            raise InputError(
                f"picture of {size[0]} × {size[1]} pixels;"
                f" 1 to {_MOST_PIXELS / 1e6:.0f} million expected"
            )
        channels = OpenEXR.File(str(path), separate_channels=True).channels()
        values = _in_display_window(_colours(channels), header)
        return _picture(values, header)
    except InputError as error:
        raise InputError(error.message, file=path) from error
    except (RuntimeError, ValueError, TypeError, KeyError, UnicodeError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"damaged OpenEXR file: {reason}", file=path) from error


def _colours(channels: dict[str, Any]) -> Float32[np.ndarray, "row column 3"]:
    names = "RGB" if set("RGB") <= set(channels) else "YYY" if "Y" in channels else ""
    planes = [np.asarray(channels[name].pixels, dtype=np.float32) for name in names]
    if len({plane.shape for plane in planes}) != 1:
        raise InputError(
            f"channels {', '.join(sorted(channels)) or 'none'}; R, G, B of equal size"
            " or Y expected"
        )
    return np.stack(planes, axis=-1)


def _in_display_window(
    values: Float32[np.ndarray, "row column 3"], header: dict[str, Any]
) -> Float32[np.ndarray, "rows columns 3"]:
    # The view refers to the display window; data may cover only part of it
    (left, top), (right, bottom) = header["displayWindow"]
    shift = np.asarray(header["dataWindow"][0]) - [left, top]
    columns, rows = int(right) - int(left) + 1, int(bottom) - int(top) + 1
    if (rows, columns) == values.shape[:2] and not shift.any():
        return values
    if min(rows, columns) < 1 or rows * columns > _MOST_PIXELS:
        raise InputError("the display window is empty or too large")
    whole = np.zeros((rows, columns, 3), dtype=np.float32)
    row = np.arange(values.shape[0]) + shift[1]
    column = np.arange(values.shape[1]) + shift[0]
    seen_row, seen_column = (
        (row >= 0) & (row < rows),
        (column >= 0) & (column < columns),
    )
    target = np.ix_(row[seen_row], column[seen_column])
    whole[target] = values[np.ix_(seen_row, seen_column)]
    return whole


def _picture(
    values: Float32[np.ndarray, "row column 3"], header: dict[str, Any]
) -> Picture:
    if "chromaticities" in header:
        x = [float(number) for number in header["chromaticities"]]
        primaries = Primaries((x[0], x[1]), (x[2], x[3]), (x[4], x[5]), (x[6], x[7]))
        if not np.allclose(x, np.ravel(_flat(RADIANCE)), atol=1e-6):
            matrix = conversion(primaries, RADIANCE)
            values = values @ matrix.T.astype(np.float32)
    white = float(header.get("whiteLuminance", LUMINOUS_EFFICACY))
    if not 0 < white < np.inf:
        raise InputError(f"whiteLuminance {white}; a positive number expected")
    if white != LUMINOUS_EFFICACY:
        values = values * np.float32(white / LUMINOUS_EFFICACY)
    view = header.get("radianceView")
    comments = header.get("comments", "")
    return Picture(
        values,
        view=parse_view(view) if isinstance(view, str) else None,
        header=tuple(str(comments).splitlines()),
        pixel_aspect=1 / max(float(header.get("pixelAspectRatio", 1.0)), 1e-30),
        quantity="irradiance" if header.get("quantity") == "irradiance" else "radiance",
    )


def _flat(primaries: Primaries) -> tuple[float, ...]:
    parts = (primaries.red, primaries.green, primaries.blue, primaries.white)
    return tuple(x for point in parts for x in point)


def write_exr(picture: Picture, path: str | Path, *, half: bool = False) -> None:
    """Write a picture as OpenEXR with lossless compression.

    Parameters
    ----------
    picture, path : picture to write, and path of the file
    half : whether to write 16 instead of 32 bits per value (3 digits, up to 65504)

    Raises
    ------
    InputError : a value too large for 16 bits
    OutputError : the file cannot be written
    """
    values = picture.rgb
    if half:
        if np.abs(values).max() > _LARGEST_HALF:
            raise InputError(
                f"a value of {np.abs(values).max():.4g} in 16 bits; up to"
                f" {_LARGEST_HALF:g} expected, or 32 bits"
            )
        values = values.astype(np.float16)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": _flat(RADIANCE),
        "whiteLuminance": LUMINOUS_EFFICACY,
        "pixelAspectRatio": 1 / picture.pixel_aspect,
        "quantity": picture.quantity,
    }
    if picture.header:
        header["comments"] = "\n".join(picture.header)
    if picture.view is not None:
        header["radianceView"] = format_view(picture.view)
    # The OpenEXR library writes only to named files
    with replace_file(path) as stream, tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "picture.exr"
        OpenEXR.File(header, {"RGB": np.ascontiguousarray(values)}).write(str(whole))
        stream.write(whole.read_bytes())
