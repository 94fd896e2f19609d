"""Headers of Radiance pictures: text lines, an empty line and the resolution.

Each program that processes a picture adds a line. Lines from the headers of source
pictures begin with a tab and are ignored.
"""

import re
import warnings
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float, Float32

from clerestory.checks import one_of, require
from clerestory.colorimetry import RADIANCE, Primaries
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.image.picture import Quantity
from clerestory.radiance.view_text import opens_view, parse_view
from clerestory.scene.transform import number
from clerestory.scene.view import View

_LONGEST = 1 << 20
_MOST_PIXELS = 1 << 27
_RESOLUTION = re.compile(r"([-+])([XY]) *(\d{1,9}) +([-+])([XY]) *(\d{1,9})\s*$")

# Programs that write irradiance pictures with the option -i
_RENDERERS = re.compile(r"(?:\S*/)?(?:rpict|rtpict|rvu|rpiece|rtrace)\s")
_FORMATS: dict[str, Literal["rgb", "xyz"]] = {
    "32-bit_rle_rgbe": "rgb",
    "32-bit_rle_xyze": "xyz",
}


@dataclass(frozen=True)
class Resolution:
    """Size of a picture, and order of its pixels in the file.

    Scanlines may be columns (`by_column`); rows may start at the bottom (`upward`), and
    columns at the right (`leftward`).
    """

    columns: int
    rows: int
    by_column: bool
    upward: bool
    leftward: bool

    @property
    def scanlines(self) -> tuple[int, int]:
        """Number of scanlines, and number of pixels in each scanline."""
        shape = (self.rows, self.columns)
        return shape[::-1] if self.by_column else shape

    def upright(
        self, pixels: Float32[np.ndarray, "lines width 3"]
    ) -> Float32[np.ndarray, "row column 3"]:
        """Pixels reordered into rows from the top and columns from the left."""
        if self.by_column:
            pixels = pixels.transpose(1, 0, 2)
        return pixels[:: -1 if self.upward else 1, :: -1 if self.leftward else 1]


@dataclass
class Header:
    """Contents of the header of a Radiance picture.

    `scale` is the factor by which the pixels of each channel have been multiplied: the
    product of exposures and colour corrections.
    """

    encoding: Literal["rgb", "xyz"] = "rgb"
    scale: Float[np.ndarray, "3"] = field(default_factory=lambda: np.ones(3))
    pixel_aspect: float = 1.0
    primaries: Primaries = RADIANCE
    view: View | None = None
    quantity: Quantity = "radiance"
    lines: tuple[str, ...] = ()


def split_header(data: bytes) -> tuple[list[str], str, int]:
    """Return the header lines, the resolution line, and the offset of the pixels."""
    end = re.search(rb"\n\r?\n", data[:_LONGEST])
    stop = -1 if end is None else data.find(b"\n", end.end(), end.end() + 100)
    if end is None or stop < 0:
        raise InputError(
            "the header does not end with an empty line and a size like -Y 600 +X 800"
        )
    lines = [line.rstrip("\r") for line in _text(data[: end.start()]).split("\n")]
    return lines[1:], _text(data[end.end() : stop]), stop + 1


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def parse_resolution(line: str) -> Resolution:
    """Return size and pixel order from a line such as "-Y 600 +X 800"."""
    match = _RESOLUTION.match(line)
    if match is None or match[2] == match[5]:
        raise InputError(
            f'resolution "{line[:40].strip()}"; a line such as "-Y 600 +X 800" expected'
        )
    sign = {match[2]: match[1], match[5]: match[4]}
    size = {match[2]: int(match[3]), match[5]: int(match[6])}
    check_size(size["X"], size["Y"])
    return Resolution(
        columns=size["X"],
        rows=size["Y"],
        by_column=match[2] == "X",
        upward=sign["Y"] == "+",
        leftward=sign["X"] == "-",
    )


def check_size(columns: int, rows: int) -> None:
    """Raise an error unless a picture has 1 to 134 million pixels."""
    require(
        min(columns, rows) > 0 and columns * rows <= _MOST_PIXELS,
        f"picture of {columns} × {rows} pixels;"
        f" 1 to {_MOST_PIXELS / 1e6:.0f} million expected",
    )


def parse_header(lines: list[str]) -> Header:
    """Return the contents of a header from its lines.

    Repeated exposures, pixel aspects and colour corrections are multiplied. View
    options override the same options in earlier lines.
    """
    header = Header()
    kept = []
    for i, line in enumerate(lines, start=2):
        with located(file=None, line=i):
            if not _take(line, header):
                kept.append(line)
    header.lines = tuple(kept)
    return header


def _take(line: str, header: Header) -> bool:
    # Parse a line into `header`; return whether the text of the line can be dropped
    name, _, value = line.partition("=")
    if line.startswith("FORMAT="):
        one_of(value.strip(), "format", choices=_FORMATS)
        header.encoding = _FORMATS[value.strip()]
    elif line.startswith("EXPOSURE="):
        header.scale = header.scale * _positive(value, name)
    elif line.startswith("PIXASPECT="):
        header.pixel_aspect *= _positive(value, name)
    elif line.startswith("COLORCORR="):
        header.scale = header.scale * [_positive(x, name) for x in _words(value, 3)]
    elif line.startswith("PRIMARIES="):
        header.primaries = _primaries(value)
    elif name == "QUANTITY" and value.strip() in ("radiance", "irradiance"):
        header.quantity = "irradiance" if "irr" in value else "radiance"
    elif opens_view(line) and "-v" in line:
        _take_view(line, header)
        return line.startswith("VIEW=")
    else:
        _take_quantity(line, header)
        return False
    return True


def _take_view(line: str, header: Header) -> None:
    try:
        header.view = parse_view(line, header.view)
    except InputError as error:
        warnings.warn(
            f"the view of the picture is ignored: {error.message}",
            ClerestoryWarning,
            stacklevel=2,
        )
    _take_quantity(line, header)


def _take_quantity(line: str, header: Header) -> None:
    if _RENDERERS.match(line):
        for word in line.split():
            if word in ("-i", "-i+", "-i-"):
                header.quantity = "radiance" if word == "-i-" else "irradiance"


def _positive(word: str, name: str) -> float:
    value = number(word.strip())
    if value is None or not 1e-30 < value < 1e30:
        raise InputError(f'{name} "{word.strip()[:30]}"; a positive number expected')
    return value


def _words(value: str, count: int) -> list[str]:
    words = value.split()
    require(
        len(words) == count,
        f"{len(words)} words in {value.strip()[:40]!r}; {count} expected",
    )
    return words


def _primaries(value: str) -> Primaries:
    numbers = [number(word) for word in _words(value, 8)]
    xy = [x for x in numbers if x is not None]
    found = value.strip()[:60]
    require(len(xy) == 8, f"PRIMARIES are {found!r}; 8 numbers expected")
    return Primaries(*zip(xy[::2], xy[1::2], strict=True))
