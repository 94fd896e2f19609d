"""Reader of EULUMDAT files (.ldt).

Intensities [cd/klm] are multiplied by the luminous flux of the first set of lamps. The
length of the luminaire is along the plane C90–C270.

Reference: A. Stockmar, EULUMDAT – ein Leuchtendatenformat für den europäischen
Beleuchtungsplaner, Licht '90, 1990.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.errors import located
from clerestory.files import read_text
from clerestory.formats.photometry.ies import POINT
from clerestory.formats.photometry.luminaire import Luminaire, LuminousShape
from clerestory.formats.photometry.unfold import unfold_type_c
from clerestory.formats.word_reader import WordReader

_MOST_ANGLES = 10_000
_MOST_LAMPS = 1000
_DIRECT_RATIOS = 10
_MILLIMETRE = 0.001


def read_eulumdat(path: str | Path) -> Luminaire:
    """Read a luminaire from a EULUMDAT file."""
    text = [line.strip() for line in read_text(path).splitlines()]
    numbered = range(1, len(text) + 1)
    lines = WordReader(text, path=path, lines=numbered, decimal_comma=True)
    maker = lines.word("the maker")
    lines.skip(1)
    symmetry = lines.whole("the symmetry", 0, 4)
    planes = lines.whole("the number of C planes", 1, _MOST_ANGLES)
    lines.skip(1)
    angles = lines.whole("the number of intensities in a plane", 2, _MOST_ANGLES)
    lines.skip(2)
    name, model = lines.word("a name"), lines.word("a number")
    lines.skip(2)
    shape = _shape(lines)
    lines.skip(1)
    output = lines.real("the light output ratio")
    factor = lines.real("the conversion factor")
    lines.skip(1)
    kind, lumens, watts = _lamps(lines)
    lines.skip(_DIRECT_RATIOS)
    angle = lines.several(planes, "an angle of a C plane")
    vertical = lines.several(angles, "an angle of an intensity")
    chosen = _planes(symmetry, planes)
    table = lines.several(len(chosen) * angles, "an intensity").reshape(-1, angles)
    data = {"MANUFAC": maker, "LUMCAT": model, "LAMP": kind}
    with located(file=path):
        horizontal, intensity = _unfolded(symmetry, angle, chosen, table)
        return Luminaire(
            name or model or Path(path).name,
            "C",
            horizontal,
            vertical,
            intensity * factor * lumens / 1000,
            shape,
            lamp_lumens=lumens,
            watts=watts,
            keywords=data | {"LORL": f"{output:g}"},
        )


def _lamps(lines: WordReader) -> tuple[str, float, float]:
    # Type, luminous flux [lm] and power [W] of the first set of lamps; the other sets
    # are alternatives
    found = []
    for _ in range(lines.whole("the number of sets of lamps", 1, _MOST_LAMPS)):
        lines.skip(1)
        kind, lumens = lines.word("a type"), lines.real("the flux of the lamps")
        lines.skip(2)
        found.append((kind, lumens, lines.real("the power of the lamps")))
    flux = found[0][1]
    if flux <= 0:
        raise lines.error(f"the flux of the lamps is {flux:g} lm; above 0 expected")
    return found[0]


def _shape(lines: WordReader) -> LuminousShape:
    # Luminaire size, then luminous area and its heights at C0, C90, C180 and C270 [mm]
    body = lines.several(3, "a size of the luminaire") * _MILLIMETRE
    area = lines.several(2, "a size of the luminous area") * _MILLIMETRE
    heights = lines.several(4, "a height of the luminous area") * _MILLIMETRE
    length, width = np.abs(area if area[0] > 0 else body[:2])
    height = float(np.abs(heights).max())
    height = height if height > POINT / 2 else 0.0
    if length <= 0:
        return LuminousShape("sphere", POINT, POINT, POINT)
    if width <= 0:
        return LuminousShape("cylinder", float(length), float(length), height)
    return LuminousShape("box", max(float(width), POINT), float(length), height)


def _planes(symmetry: int, planes: int) -> range:
    # Indices of the C planes whose intensities are in the file
    start = 3 * planes // 4
    return (
        range(planes),
        range(1),
        range(planes // 2 + 1),
        range(start, start + planes // 2 + 1),
        range(planes // 4 + 1),
    )[symmetry]


def _unfolded(
    symmetry: int,
    angle: Float[np.ndarray, " planes"],
    chosen: range,
    table: Float[np.ndarray, "given vertical"],
) -> tuple[Float[np.ndarray, " all"], Float[np.ndarray, "all vertical"]]:
    if symmetry == 1 or len(chosen) == 1:
        return np.zeros(1), table[:1]
    turn = np.array([angle[i % len(angle)] + 360 * (i // len(angle)) for i in chosen])
    grow = np.all(np.diff(turn) > 0)
    require(grow, "angles of C planes decrease; increasing angles expected")
    if symmetry == 3:
        turn = turn - 360
    return unfold_type_c(turn, table)
