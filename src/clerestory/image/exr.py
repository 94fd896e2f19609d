"""OpenEXR pictures: red, green and blue in 16 or 32 bits, with header attributes.

These standard attributes of OpenEXR are used: chromaticities of the primaries,
whiteLuminance of the colour (1, 1, 1) [cd/m²], pixelAspectRatio (width over height),
and comments (header lines). The custom attributes `radianceView` and `quantity` contain
the view, and whether pixels are radiance or irradiance.
"""

import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from jaxtyping import Float32

from clerestory.checks import positive, require
from clerestory.colorimetry import RADIANCE, Primaries, conversion
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError, located
from clerestory.escaping import header_line
from clerestory.files import read_bytes, replace_file
from clerestory.image.picture import Picture
from clerestory.image.radiance_header import check_size
from clerestory.radiance.view_text import format_view, parse_view

# Largest finite half-precision number (IEEE 754 binary16)
_LARGEST_HALF = 65504.0

# Largest ratio of the pixels of a picture to those that are stored
_MOST_BORDER = 1000

# File descriptors of standard output and error; one thread at a time redirects them
_STREAMS = (1, 2)
_SILENCE = threading.Lock()


def read_exr(path: str | Path) -> Picture:
    """Read an OpenEXR picture, and convert it to the primaries of Radiance.

    Default chromaticities are the primaries of Radiance. Without whiteLuminance, pixels
    are radiances in W/(m²·sr). A file with a single channel Y gives a grey picture.
    """
    read_bytes(path)  # raises InputError with the reason if the file is unreadable
    try:
        with located(file=path), _silent():
            header = OpenEXR.File(str(path), header_only=True).header()
            _window(header["dataWindow"])
            channels = OpenEXR.File(str(path), separate_channels=True).channels()
            return _picture(_in_display_window(_colours(channels), header), header)
    except (RuntimeError, ValueError, TypeError, KeyError, UnicodeError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"damaged OpenEXR file: {reason}", file=path) from error


@contextmanager
def _silent() -> Iterator[None]:
    # Discard what the OpenEXR library prints about damaged files, on both streams
    with _SILENCE:
        kept = [os.dup(number) for number in _STREAMS]
        nothing = os.open(os.devnull, os.O_WRONLY)
        try:
            for number in _STREAMS:
                os.dup2(nothing, number)
            yield
        finally:
            for number, before in zip(_STREAMS, kept, strict=True):
                os.dup2(before, number)
                os.close(before)
            os.close(nothing)


def _window(corners: Any) -> tuple[int, int, int, int]:
    # Left column, top row, number of columns, number of rows
    (left, top), (right, bottom) = corners
    columns, rows = int(right) - int(left) + 1, int(bottom) - int(top) + 1
    check_size(columns, rows)
    return int(left), int(top), columns, rows


def _colours(channels: dict[str, Any]) -> Float32[np.ndarray, "row column 3"]:
    names = "RGB" if set("RGB") <= set(channels) else "YYY" if "Y" in channels else ""
    planes = [np.asarray(channels[name].pixels, dtype=np.float32) for name in names]
    require(
        len({plane.shape for plane in planes}) == 1,
        f"channels {', '.join(sorted(channels)) or 'none'}; R, G, B of equal size"
        " or Y expected",
    )
    return np.stack(planes, axis=-1)


def _in_display_window(
    values: Float32[np.ndarray, "row column 3"], header: dict[str, Any]
) -> Float32[np.ndarray, "rows columns 3"]:
    # The view refers to the display window; stored pixels may cover only part of it
    left, top, columns, rows = _window(header["displayWindow"])
    first_column, first_row = np.asarray(header["dataWindow"][0]) - [left, top]
    stored = values.shape[0] * values.shape[1]
    require(
        rows * columns <= _MOST_BORDER * stored,
        f"displayWindow has {rows * columns} pixels for {stored} that are stored; at"
        f" most {_MOST_BORDER} times as many expected",
    )
    whole = np.zeros((rows, columns, 3), dtype=np.float32)
    row = np.arange(values.shape[0]) + first_row
    column = np.arange(values.shape[1]) + first_column
    shown = np.ix_((row >= 0) & (row < rows), (column >= 0) & (column < columns))
    whole[np.ix_(row[shown[0].ravel()], column[shown[1].ravel()])] = values[shown]
    return whole


def _picture(
    values: Float32[np.ndarray, "row column 3"], header: dict[str, Any]
) -> Picture:
    if "chromaticities" in header:
        x = [float(number) for number in header["chromaticities"]]
        primaries = Primaries(*zip(x[::2], x[1::2], strict=True))
        if not np.allclose(x, np.ravel(_flat(RADIANCE)), atol=1e-6):
            values = values @ conversion(primaries, RADIANCE).T.astype(np.float32)
    white = float(header.get("whiteLuminance", LUMINOUS_EFFICACY))
    positive(white, "whiteLuminance")
    if white != LUMINOUS_EFFICACY:
        values = values * np.float32(white / LUMINOUS_EFFICACY)
    view = header.get("radianceView")
    return Picture(
        values,
        view=parse_view(view) if isinstance(view, str) else None,
        header=tuple(str(header.get("comments", "")).splitlines()),
        pixel_aspect=1 / max(float(header.get("pixelAspectRatio", 1.0)), 1e-30),
        quantity="irradiance" if header.get("quantity") == "irradiance" else "radiance",
    )


def _flat(primaries: Primaries) -> tuple[float, ...]:
    return tuple(chain.from_iterable(astuple(primaries)))


def write_exr(picture: Picture, path: str | Path, *, half: bool = False) -> None:
    """Write a picture as OpenEXR with lossless compression.

    With `half`, values have 16 bits instead of 32: three digits, at most 65504.
    """
    values = picture.rgb
    if half:
        largest = np.abs(values).max()
        require(
            largest <= _LARGEST_HALF,
            f"the largest value is {largest:.4g}; up to {_LARGEST_HALF:g} expected in"
            " 16-bit OpenEXR, or 32 bits",
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
        header["comments"] = "\n".join(map(header_line, picture.header))
    if picture.view is not None:
        header["radianceView"] = format_view(picture.view)
    # The OpenEXR library writes only to named files
    with replace_file(path) as stream, tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "picture.exr"
        OpenEXR.File(header, {"RGB": np.ascontiguousarray(values)}).write(str(whole))
        stream.write(whole.read_bytes())
