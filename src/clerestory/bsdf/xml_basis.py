"""Angle bases of BSDF files, found from basis names, rings and numbers of values."""

from dataclasses import dataclass

import numpy as np
from lxml import etree

from clerestory.bsdf.xml_document import Document, is_number
from clerestory.errors import InputError
from clerestory.hemisphere.klems import from_rings, klems
from clerestory.hemisphere.partition import RingPartition

# Tolerance of gaps and overlaps of rings, and of the outer limits 0 and 90° [°].
_ROUNDING_DEG = 0.02

_MOST_RINGS = 1000
_MOST_PATCHES = 20_000

# Definitions of Klems half and quarter in old Radiance versions, unlike WINDOW's.
_OLD = {
    "lbnl/klems half": (
        "LBNL/Klems Half (73)",
        (0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90),
        (1, 8, 12, 16, 20, 12, 4),
    ),
    "lbnl/klems quarter": (
        "LBNL/Klems Quarter (before 2024)",
        (0, 9, 27, 46, 66, 90),
        (1, 8, 12, 12, 8),
    ),
}


@dataclass(frozen=True, eq=False)
class Bases:
    """Candidate partitions for each basis name."""

    # Partitions by lower-case name, in order of preference: first as defined in the
    # file, then the standard partitions
    known: dict[str, tuple[RingPartition, ...]]
    defined: frozenset[str]  # lower-case names of the bases that the file defines


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
) -> tuple[RingPartition, RingPartition]:
    """Return the partitions of rows and columns that fit the number of values.

    Partitions other than those defined in the file are noted in the document.
    """
    names = [document.text(block, f"{side}AngleBasis") for side in ("Row", "Column")]
    known = ", ".join(map(repr, bases.known))
    for name in names:
        message = f"angle basis {name[:60]!r} is not defined; one of {known} expected"
        document.check(name.lower() in bases.known, block, message)
    rows, columns = (bases.known[name.lower()] for name in names)
    fits = [(r, c) for r in rows for c in columns if len(r) * len(c) == count]
    document.check(
        fits,
        document.require(block, "ScatteringData"),
        f"{count} values; {len(rows[0])} x {len(columns[0])} ="
        f" {len(rows[0]) * len(columns[0])} expected for {names[0]!r}",
    )
    chosen = fits[0]
    if (rows[0], columns[0]) != chosen:
        fault = f"{count} values do not fit the {len(rows[0])} patches of {names[0]!r}"
        document.note(block, f"{fault}; read as {len(chosen[0])} patches")
    elif not bases.defined.issuperset(name.lower() for name in names):
        missing = f"the rings of {names[0]!r} are not in the file"
        document.notes.append(f"{missing}; the standard rings of that name are used")
    return chosen


def _well_known() -> dict[str, tuple[RingPartition, ...]]:
    known: dict[str, tuple[RingPartition, ...]] = {
        f"lbnl/klems {name}": (klems(name),) for name in ("full", "half", "quarter")
    }
    for name, (title, limits_deg, count) in _OLD.items():
        old = from_rings(
            title, limits_deg=np.array(limits_deg, dtype=float), count=np.array(count)
        )
        known[name] += (old,)
    return known


def _read_basis(element: etree._Element, document: Document) -> RingPartition:
    name = document.text(element, "AngleBasisName")
    blocks = document.children(element, "AngleBasisBlock")
    message = f"{len(blocks)} rings in basis {name!r}; 1 to {_MOST_RINGS} expected"
    document.check(0 < len(blocks) <= _MOST_RINGS, element, message)
    lower, upper, count = zip(
        *(_read_ring(block, document) for block in blocks), strict=True
    )
    message = f"{sum(count)} patches in {name!r}; at most {_MOST_PATCHES} expected"
    document.check(sum(count) <= _MOST_PATCHES, element, message)

    # Check that the rings are contiguous from 0 to 90°
    ends = np.array([[0.0, *upper], [*lower, 90.0]])
    gap = np.abs(ends[0] - ends[1])
    ring = int(np.argmax(gap))
    document.check(
        gap[ring] <= _ROUNDING_DEG,
        blocks[min(ring, len(blocks) - 1)],
        f"ring limits {ends[0][ring]:g}° and {ends[1][ring]:g}° in {name!r} differ;"
        " contiguous rings from 0 to 90° expected",
    )
    limits = np.array([0.0, *upper[:-1], 90.0])
    try:
        return from_rings(name, limits_deg=limits, count=np.array(count))
    except InputError as error:
        raise document.error(element, error.message) from error


def _read_ring(block: etree._Element, document: Document) -> tuple[float, float, int]:
    # Lower limit, upper limit [°] and number of patches of a ring
    limits = []
    for path in ("ThetaBounds/LowerTheta", "ThetaBounds/UpperTheta"):
        element = document.require(block, path)
        text = document.text(block, path)
        limits.append(float(text) if is_number(text) else np.nan)
        message = f"angle is {text[:40]!r}; degrees from 0 to 90 expected"
        document.check(0 <= limits[-1] <= 90 + _ROUNDING_DEG, element, message)
    element, text = document.require(block, "nPhis"), document.text(block, "nPhis")
    whole = text.isascii() and text.isdecimal() and 0 < int(text[:9]) <= _MOST_PATCHES
    message = f"nPhis is {text[:40]!r}; a whole number of patches expected"
    document.check(whole, element, message)
    return limits[0], limits[1], int(text)
