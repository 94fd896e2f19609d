"""Radiance pictures (.hdr, .pic): RGBE and XYZE pixels of four bytes.

Pixels are RGB radiance, or CIE XYZ with Y in cd/m². Ward, "Real pixels", Graphics
Gems II (1991).
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8

from clerestory.colorimetry import RADIANCE, conversion, xyz_to_rgb
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import located
from clerestory.escaping import header_line
from clerestory.files import read_bytes, replace_file
from clerestory.image.picture import Picture
from clerestory.image.radiance_header import (
    Header,
    parse_header,
    parse_resolution,
    split_header,
)
from clerestory.image.run_length import decode, encode
from clerestory.radiance.view_text import format_view, opens_view

# Offset of the exponent byte (color.h: COLXS)
_EXCESS = 128

# Longest header line that Radiance reads as one line (header.c: MAXLINE) [bytes]
_LONGEST_LINE = 2000

# Pixels without a larger component are written as black (color.c: setcolr)
_BLACK = 1e-32


def read_radiance(path: str | Path) -> Picture:
    """Read a picture in Radiance format; pixel values are divided by the exposure."""
    data = read_bytes(path)
    with located(file=path):
        lines, resolution_line, start = split_header(data)
        header = parse_header(lines)
        resolution = parse_resolution(resolution_line)
        rows, width = resolution.scanlines
        pixels = np.frombuffer(data, dtype=np.uint8)[start:]
        values, row = np.empty((rows, width, 3), np.float32), 0
        for quads in decode(pixels, rows=rows, width=width):
            values[row : row + len(quads)] = _physical(_floats(quads), header)
            row += len(quads)
    return Picture(
        resolution.upright(values),
        view=header.view,
        header=header.lines,
        pixel_aspect=header.pixel_aspect,
        quantity=header.quantity,
    )


def _floats(
    quads: UInt8[np.ndarray, "row column 4"],
) -> Float32[np.ndarray, "row column 3"]:
    # Decode a mantissa to the centre of its interval; exponent 0 is black
    unit = np.ldexp(np.float32(1), np.arange(256) - _EXCESS - 8)
    unit[0] = 0
    values = quads[..., :3].astype(np.float32)
    values += np.float32(0.5)
    values *= unit[quads[..., 3]][..., None]
    return values


def _physical(
    values: Float32[np.ndarray, "row column 3"], header: Header
) -> Float32[np.ndarray, "row column 3"]:
    if (header.scale != 1).any():
        values = values / header.scale.astype(np.float32)
    if header.encoding == "xyz":
        matrix = xyz_to_rgb() / LUMINOUS_EFFICACY
    elif header.primaries != RADIANCE:
        matrix = conversion(header.primaries, RADIANCE)
    else:
        return values
    return values @ matrix.T.astype(np.float32)


def write_radiance(
    picture: Picture, path: str | Path, *, exposure: float = 1.0, xyz: bool = False
) -> None:
    """Write a picture in Radiance format.

    Precision is 1/256 of the largest component of each pixel. Negative values become 0;
    values above 10³⁸ become the largest value of the format. All values are multiplied
    by `exposure`, which the header records. With `xyz`, CIE XYZ is written instead of
    red, green and blue.
    """
    values = picture.rgb
    scale = exposure
    if xyz:
        values = values @ np.linalg.inv(xyz_to_rgb()).T.astype(np.float32)
        # In XYZ files, Y divided by the exposure in the header is luminance in cd/m²
        scale = exposure / LUMINOUS_EFFICACY
    pixels = _quads(values * np.float32(exposure))
    with replace_file(path) as stream:
        stream.write(_header(picture, scale, xyz=xyz).encode())
        stream.write(encode(pixels))


def _header(picture: Picture, scale: float, *, xyz: bool) -> str:
    lines = [_line(line) for line in picture.header if line.strip()]
    if picture.view is not None:
        lines.append(f"VIEW= {format_view(picture.view)}")
    else:
        # Programs ignore a "VIEW=" line that starts with a tab
        lines = ["\t" + line if opens_view(line) else line for line in lines]
    lines.insert(0, "#?RADIANCE")
    if picture.quantity != parse_header(lines).quantity:
        lines.append(f"QUANTITY={picture.quantity}")
    if scale != 1:
        lines.append(f"EXPOSURE={scale:.9e}")
    if picture.pixel_aspect != 1:
        lines.append(f"PIXASPECT={picture.pixel_aspect:.9g}")
    lines.append(f"FORMAT=32-bit_rle_{'xyze' if xyz else 'rgbe'}")
    size = f"-Y {picture.rows} +X {picture.columns}"
    return "\n".join([*lines, "", size, ""])


def _line(line: str) -> str:
    # Lines of source pictures begin with a tab
    tab = "\t" if line[0].isspace() else ""
    return tab + header_line(line, longest=_LONGEST_LINE)


def _quads(
    values: Float32[np.ndarray, "row column 3"],
) -> UInt8[np.ndarray, "row column 4"]:
    values = np.clip(values, 0, np.float32(255 / 256 * 2.0**127))
    largest = np.maximum(np.maximum(values[..., 0], values[..., 1]), values[..., 2])
    _, exponent = np.frexp(np.maximum(largest, np.float32(_BLACK)))
    # The product is exact, as the factor is a power of two
    unit = np.ldexp(np.float32(1), 8 - exponent)
    quads = np.empty((*largest.shape, 4), dtype=np.uint8)
    for i in range(3):
        quads[..., i] = values[..., i] * unit
    quads[..., 3] = exponent + _EXCESS
    quads[largest <= _BLACK] = 0
    return quads
