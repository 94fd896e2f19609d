"""Angle bases of BSDF files, from basis names, rings and numbers of values."""

from dataclasses import dataclass

import numpy as np
from lxml import etree

from clerestory.bsdf.xml_document import Document
from clerestory.errors import InputError
from clerestory.hemisphere.klems import from_rings, klems
from clerestory.hemisphere.partition import RingPartition

# Largest gap or overlap of adjacent rings, and largest deviation from 0 and 90 [°].
_ROUNDING_DEG = 0.02

_MOST_RINGS = 1000
_MOST_PATCHES = 20_000

# Definitions of Klems half and quarter in Radiance versions before WINDOW's were used.
_OLD_HALF = ((0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90), (1, 8, 12, 16, 20, 12, 4))
_OLD_QUARTER = ((0, 9, 27, 46, 66, 90), (1, 8, 12, 12, 8))


@dataclass(frozen=True, eq=False)
class Bases:
    """Candidate partitions for each basis name.

    Attributes
    ----------
    known : partitions by lower-case name, in order of preference: first as defined in
        the file, then the standard partitions
    defined : lower-case names of the bases that the file defines
    """

    known: dict[str, tuple[RingPartition, ...]]
    defined: frozenset[str]


def read_bases(definition: etree._Element, document: Document) -> Bases:
    """Read the angle bases defined in a file; add the standard Klems bases."""
    known: dict[str, tuple[RingPartition, ...]] = {}
    for element in document.children(definition, "AngleBasis"):
        basis = _read_basis(element, document)
        known[basis.name.lower()] = (basis,)
    defined = frozenset(known)
    for name, candidates in _well_known().items():
        known[name] = known.get(name, ()) + candidates
    return Bases(known, defined)


def choose_bases(
    block: etree._Element, bases: Bases, *, count: int, document: Document
) -> tuple[RingPartition, RingPartition, str]:
    """Return the partitions of rows and columns that fit the number of values.

    The third value is a note, which is empty for partitions as defined in the file.
    """
    names = [document.text(block, f"{side}AngleBasis") for side in ("Row", "Column")]
    for name in names:
        if name.lower() not in bases.known:
            raise document.error(
                block,
                f"angle basis {name[:60]!r} is not defined in the file;"
                f" one of {', '.join(repr(n) for n in bases.known)} expected",
            )
    rows, columns = (bases.known[name.lower()] for name in names)
    fits = [(r, c) for r in rows for c in columns if len(r) * len(c) == count]
    if not fits:
        data = document.require(block, "ScatteringData")
        raise document.error(
            data,
            f"{count} values; {len(rows[0])} x {len(columns[0])} ="
            f" {len(rows[0]) * len(columns[0])} expected for {names[0]!r}",
        )
    chosen = fits[0]
    note = ""
    if (rows[0], columns[0]) != chosen:
        note = (
            f"line {document.line(block)}: {count} values do not fit the {len(rows[0])}"
            f" patches of {names[0]!r}; read as {len(chosen[0])} patches"
        )
    elif not bases.defined.issuperset(name.lower() for name in names):
        note = (
            f"the rings of {names[0]!r} are not in the file; the standard ones are used"
        )
    return *chosen, note


def _well_known() -> dict[str, tuple[RingPartition, ...]]:
    old = {
        "half": from_rings(
            "LBNL/Klems Half (73)",
            limits_deg=np.array(_OLD_HALF[0], dtype=float),
            count=np.array(_OLD_HALF[1]),
        ),
        "quarter": from_rings(
            "LBNL/Klems Quarter (before 2024)",
            limits_deg=np.array(_OLD_QUARTER[0], dtype=float),
            count=np.array(_OLD_QUARTER[1]),
        ),
    }
    return {
        f"lbnl/klems {name}": (klems(name), *([old[name]] if name in old else []))
        for name in ("full", "half", "quarter")
    }


def _read_basis(element: etree._Element, document: Document) -> RingPartition:
    name = document.text(element, "AngleBasisName")
    blocks = document.children(element, "AngleBasisBlock")
    if not 0 < len(blocks) <= _MOST_RINGS:
        raise document.error(
            element,
            f"{len(blocks)} rings in basis {name!r}; 1 to {_MOST_RINGS} expected",
        )
    lower = [_angle(block, "ThetaBounds/LowerTheta", document) for block in blocks]
    upper = [_angle(block, "ThetaBounds/UpperTheta", document) for block in blocks]
    count = [_patches(block, document) for block in blocks]
    if sum(count) > _MOST_PATCHES:
        raise document.error(
            element,
            f"{sum(count)} patches in {name!r}; at most {_MOST_PATCHES} expected",
        )

    # Check that the rings are contiguous from 0 to 90°
    ends = np.array([[0.0, *upper], [*lower, 90.0]])
    gap = np.abs(ends[0] - ends[1])
    if np.max(gap) > _ROUNDING_DEG:
        ring = int(np.argmax(gap))
        raise document.error(
            blocks[min(ring, len(blocks) - 1)],
            f"ring limits {ends[0][ring]:g}° and {ends[1][ring]:g}° in {name!r} differ;"
            " contiguous rings from 0 to 90° expected",
        )
    limits = np.array([0.0, *upper[:-1], 90.0])
    try:
        return from_rings(name, limits_deg=limits, count=np.array(count))
    except InputError as error:
        raise document.error(element, error.message) from error


def _angle(block: etree._Element, path: str, document: Document) -> float:
    element = document.require(block, path)
    text = (element.text or "").strip()
    try:
        angle = float(text)
    except ValueError:
        angle = float("nan")
    if not 0 <= angle <= 90 + _ROUNDING_DEG:
        raise document.error(
            element, f"angle {text[:40]!r}; degrees from 0 to 90 expected"
        )
    return angle


def _patches(block: etree._Element, document: Document) -> int:
    element = document.require(block, "nPhis")
    text = (element.text or "").strip()
    if not (text.isascii() and text.isdecimal() and 0 < int(text[:9]) <= _MOST_PATCHES):
        raise document.error(
            element, f"nPhis {text[:40]!r}; a whole number of patches expected"
        )
    return int(text)
