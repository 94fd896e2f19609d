"""Reader of IES files (LM-63 of 1986, 1991, 1995, 2002 and 2019).

The candela multiplier and the ballast factor are applied; in files before 1995, also
the ballast-lamp factor. As in Radiance, horizontal cylinders are replaced by boxes, and
ellipses by circles or boxes.

References: IES LM-63-86, -91, -95, -02, -19; meaning of negative dimensions in each
version: R. Fritz's comments in Radiance's ies2rad.
"""

import re
import warnings
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, located
from clerestory.files import is_file, read_text
from clerestory.formats.photometry.luminaire import (
    Luminaire,
    LuminousShape,
    PhotometricType,
    TiltTable,
)
from clerestory.formats.photometry.unfold import unfold_sides, unfold_type_c
from clerestory.formats.word_reader import WordReader

# Feet to metres
_FOOT = 0.3048

# Diameter that represents a point source [m]
POINT = 0.001

_MOST_ANGLES = 10_000
_YEARS = {"IESNA91": 1991, "LM-63-1995": 1995, "LM-63-2002": 2002, "LM-63-2019": 2019}
_WORD = re.compile(r"[^\s,]+")
_KEYWORD = re.compile(r"\s*\[([^\]]+)\]\s*(.*)")


def read_ies(path: str | Path) -> Luminaire:
    """Read a luminaire from an IES file."""
    text = read_text(path)
    head, mark, rest = text.partition("TILT=")
    require(mark, "no line TILT=; an IES file (LM-63) expected", file=path)
    how, _, body = rest.partition("\n")
    year = _year(head)
    line = 1 + head.count("\n")
    numbers = _words(body, path, line + 1)
    tilt = _tilt(how.strip(), numbers, Path(path), line)
    with located(file=path):
        made = _luminaire(numbers, year, _keywords(head, Path(path)), tilt)
    more = len(numbers.words) - numbers.at
    if more:
        first = f"the first is {numbers.words[numbers.at][:20]!r}"
        message = f"{path}: {more} words after the last intensity are ignored; {first}"
        warnings.warn(message, ClerestoryWarning, stacklevel=2)
    return made


def _words(text: str, path: str | Path, line: int) -> WordReader:
    # Words of a text, with the line number of each word
    words, lines, at = [], [], 0
    for match in _WORD.finditer(text):
        line += text.count("\n", at, match.start())
        at = match.start()
        words.append(match.group())
        lines.append(line)
    return WordReader(words, path=path, lines=lines)


def _year(head: str) -> int:
    first = head.lstrip("\ufeff").splitlines()[0].strip() if head.strip() else ""
    return next((year for tag, year in _YEARS.items() if tag in first), 1986)


def _keywords(head: str, path: Path) -> dict[str, str]:
    found: dict[str, str] = {"file": path.name}
    last = ""
    for line in head.splitlines():
        match = _KEYWORD.match(line)
        if match is None:
            continue
        key, value = match[1].strip().upper(), match[2].strip()
        if key == "MORE" and last:
            found[last] = f"{found[last]} {value}"
        else:
            last = key
            found[key] = f"{found[key]} {value}" if key in found else value
    return found


def _tilt(how: str, numbers: WordReader, path: Path, line: int) -> TiltTable | None:
    if how.upper() == "NONE":
        return None
    if how.upper() == "INCLUDE":
        return _tilt_table(numbers)
    other = path.parent / how
    message = f"TILT={how}: NONE, INCLUDE or the name of a file beside it expected"
    require(how and is_file(other), message, file=path, line=line)
    return _tilt_table(_words(read_text(other), other, 1))


def _tilt_table(numbers: WordReader) -> TiltTable:
    geometry = numbers.whole("the lamp-to-luminaire geometry", 1, 3)
    count = numbers.whole("the number of tilt angles", 1, _MOST_ANGLES)
    angle = numbers.several(count, "a tilt angle")
    factor = numbers.several(count, "a tilt multiplier")
    valid = np.all(np.diff(angle) > 0) and factor.min() >= 0
    message = "tilt angles decrease or a multiplier is negative; a table expected"
    require(valid, message, file=numbers.path)
    return TiltTable(geometry, tuple(angle.tolist()), tuple(factor.tolist()))


def _luminaire(
    numbers: WordReader, year: int, keywords: dict[str, str], tilt: TiltTable | None
) -> Luminaire:
    lamps = numbers.real("the number of lamps")
    lumens = numbers.real("the lumens of a lamp")
    multiplier = numbers.real("the candela multiplier")
    counts = [
        numbers.whole(f"the number of {what} angles", least, _MOST_ANGLES)
        for what, least in (("vertical", 2), ("horizontal", 1))
    ]
    types: dict[int, PhotometricType] = {1: "C", 2: "B", 3: "A"}
    photometry = types[numbers.whole("the photometric type", 1, 3)]
    feet = numbers.whole("the type of units", 1, 2) == 1
    sizes = numbers.several(3, "a dimension") * (_FOOT if feet else 1.0)
    ballast = numbers.real("the ballast factor")
    future = numbers.real("the ballast-lamp photometric factor")
    watts = numbers.real("the input power")
    vertical = numbers.several(counts[0], "a vertical angle")
    horizontal = numbers.several(counts[1], "a horizontal angle")
    table = numbers.several(counts[0] * counts[1], "an intensity")
    scale = multiplier * ballast * (future if year < 1995 else 1.0)
    intensity = scale * table.reshape(counts[1], counts[0])
    grow = np.all(np.diff(horizontal) > 0)
    require(grow, "horizontal angles decrease; increasing angles expected")
    unfold = unfold_type_c if photometry == "C" else unfold_sides
    horizontal, intensity = unfold(horizontal, intensity)
    if photometry != "C":
        vertical, turned = unfold_sides(vertical, intensity.T)
        intensity = turned.T
    return Luminaire(
        keywords.get("LUMCAT") or keywords.get("LUMINAIRE") or keywords["file"],
        photometry,
        horizontal,
        vertical,
        intensity,
        _shape(sizes.tolist(), year),
        lamp_lumens=None if lumens < 0 else lamps * lumens,
        watts=watts,
        keywords=keywords,
        tilt=tilt,
    )


def _shape(sizes: list[float], year: int) -> LuminousShape:
    # Negative sizes mean round shapes; which shape depends on the version
    width, length, height = map(abs, sizes)
    round_width, round_length, round_height = (size < 0 for size in sizes)
    if width == length == height == 0:
        return LuminousShape("sphere", POINT, POINT, POINT)
    flat_z = height if height > POINT / 2 else 0.0
    if round_width and round_length and round_height:
        if max(width, length, height) < 1.5 * min(width, length, height):
            mean = (width + length + height) / 3
            return LuminousShape("sphere", mean, mean, mean)
        return _box(length, width, flat_z)
    if year == 1995 and round_width and round_height and length == 0:
        return LuminousShape("sphere", width, width, width)
    if round_width and (round_length or length == 0):
        return _cylinder(width, length or width, flat_z)
    if (round_width or round_length) and not round_height and year < 2002:
        # An ellipse or an elliptical cylinder
        return _cylinder(width, length or width, flat_z)
    return _box(length, width, flat_z)


def _cylinder(width: float, length: float, height: float) -> LuminousShape:
    if max(width, length) >= 1.5 * min(width, length):
        return _box(length, width, height)
    mean = float(np.sqrt(width * length))
    return LuminousShape("cylinder", mean, mean, height)


def _box(length: float, width: float, height: float) -> LuminousShape:
    # The length is along the photometric 0° direction (+x)
    return LuminousShape("box", max(length, POINT), max(width, POINT), height)
