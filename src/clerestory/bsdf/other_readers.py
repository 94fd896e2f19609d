"""Compatibility of BSDF files with Radiance and pyWinCalc, the engine of WINDOW.

Our reader removes white space around texts, as XML schemas do; other programs compare
them exactly. The rules follow the source code of Radiance (bsdf.c, bsdf_m.c, bsdf_t.c)
and the behaviour of pyWinCalc 3.3.1.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from lxml import etree

from clerestory.bsdf.quality_finding import Finding, Severity
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.xml_document import Document, is_number, parse_document

READERS = ("Radiance", "pyWinCalc")

# Length units, channels and directions that Radiance reads
_UNITS = ("meter", "foot", "inch", "centimeter", "millimeter")
_CHANNELS = ("visible", "cie-x", "cie-z", "cie-u", "cie-v")
_DIRECTIONS = tuple(name.replace("_", " ") for name in FUNCTIONS)

# Names of the angle bases built into Radiance; largest number of rings in any other
# basis, and of other bases in a file
_BASES = tuple(f"lbnl/klems {name}" for name in ("full", "half", "quarter"))
_TREE_BASIS = "lbnl/shirley-chiu"
_MOST_RINGS, _MOST_BASES = 46, 4
_RING_TOLERANCE = 1e-6

# An element and the reason why a program refuses or ignores it
_Reason = tuple[etree._Element, str]


def check_readers(path: str | Path) -> Iterator[Finding]:
    """Yield a finding for each program that refuses a BSDF file or part of its data."""
    document = parse_document(path)
    for reader, reasons in zip(
        READERS, (_radiance(document), _window(document)), strict=True
    ):
        first = next(reasons, None)
        if first is not None:
            element, what = first
            # Many files are not meant for WINDOW
            severity: Severity = "warning" if reader == "Radiance" else "info"
            effect = f"{reader} refuses the file or ignores these data"
            what = f"line {document.line(element)}: {what}"
            yield Finding("reader", severity, 0.0, what, reader, effect)


def _raw(element: etree._Element | None) -> str:
    return "" if element is None else (element.text or "")


def _radiance(document: Document) -> Iterator[_Reason]:
    root = document.root
    if root.prefix:
        yield root, f"element names have the prefix {root.prefix!r}; none expected"
    kind = document.find(root, "FileType")
    if kind is not None and _raw(kind) != "BSDF":
        yield kind, f"FileType is {_raw(kind)[:40]!r}; 'BSDF' expected"
    layer = document.require(root, "Optical/Layer")
    yield from _dimensions(layer, document)
    definition = document.require(layer, "DataDefinition")
    yield from _spaced(document.require(definition, "IncidentDataStructure"))
    names = [*_BASES, _TREE_BASIS]
    for number, basis in enumerate(document.children(definition, "AngleBasis")):
        name = _raw(document.find(basis, "AngleBasisName")).lower()
        if name not in _BASES:
            names.append(name)
            yield from _rings(basis, number, document)
    for data in document.children(layer, "WavelengthData"):
        wavelength = document.find(data, "Wavelength")
        if wavelength is None or _raw(wavelength).strip().lower() not in _CHANNELS:
            continue
        yield from _spaced(wavelength)
        for block in document.children(data, "WavelengthDataBlock"):
            yield from _block(block, names, document)


def _spaced(element: etree._Element) -> Iterator[_Reason]:
    # White space around a text that Radiance compares exactly
    text = _raw(element)
    if text != text.strip():
        name = etree.QName(element).localname
        yield element, f"{name} is {text[:40]!r}; no white space expected"


def _block(
    block: etree._Element, names: list[str], document: Document
) -> Iterator[_Reason]:
    direction = document.find(block, "WavelengthDataDirection")
    text = _raw(direction).lower()
    if text not in _DIRECTIONS and " ".join(text.split()) in _DIRECTIONS:
        what = (
            f"WavelengthDataDirection is {text[:40]!r}; no extra white space expected"
        )
        yield block if direction is None else direction, what
    for kind in ("ColumnAngleBasis", "RowAngleBasis", "AngleBasis"):
        basis = document.find(block, kind)
        if basis is not None and _raw(basis).lower() not in names:
            yield basis, f"{kind} is {_raw(basis)[:40]!r}; the name of a basis expected"
    values = document.find(block, "ScatteringData")
    if values is not None and re.search(r"^\s*,|,\s*,", _raw(values)):
        yield values, "two commas without a number between them; numbers expected"


def _dimensions(layer: etree._Element, document: Document) -> Iterator[_Reason]:
    for name in ("Thickness", "Width", "Height"):
        element = document.find(layer, f"Material/{name}")
        if element is None:
            continue
        unit, text = element.get("unit"), _raw(element).strip()
        size = float(text) if is_number(text) else 0.0
        if size and unit is not None and unit.lower() not in _UNITS:
            yield element, f"unit is {unit[:40]!r}; one of {', '.join(_UNITS)} expected"
        elif size < 0:
            yield element, f"{name} is {text[:40]}; a positive length expected"
    geometry = document.find(layer, "Geometry")
    if geometry is None:
        return
    style = geometry.get("format")
    if style is not None and style.lower() != "mgf":
        yield geometry, f"format is {style[:40]!r}; 'MGF' expected"
    block = document.find(geometry, "MGFblock")
    if block is not None and _raw(block).strip():
        unit = block.get("unit", "meter")
        if unit.lower() not in _UNITS:
            yield block, f"unit is {unit[:40]!r}; one of {', '.join(_UNITS)} expected"


def _rings(basis: etree._Element, number: int, document: Document) -> Iterator[_Reason]:
    # Rings of a basis that Radiance does not know by name
    rings = document.children(basis, "AngleBasisBlock")
    if number >= _MOST_BASES or len(rings) > _MOST_RINGS:
        what = f"{number + 1} angle bases, {len(rings)} rings; at most {_MOST_BASES}"
        yield basis, f"{what} bases and {_MOST_RINGS} rings expected"
    before = 0.0
    for ring in rings:
        lower, upper = (
            float(document.text(ring, f"ThetaBounds/{name}"))
            for name in ("LowerTheta", "UpperTheta")
        )
        if before and abs(lower / before - 1) > _RING_TOLERANCE:
            yield ring, f"LowerTheta is {lower:g}; {before:g} expected"
        if before and document.text(ring, "nPhis") == "1":
            yield ring, "a ring off the normal has one patch; two or more expected"
        before = upper


def _window(document: Document) -> Iterator[_Reason]:
    root = document.root
    if root.prefix:
        yield root, f"element names have the prefix {root.prefix!r}; none expected"
    if any(note.startswith("text before the XML") for note in document.notes):
        yield root, "text before the XML; none expected"
    layer = document.require(root, "Optical/Layer")
    structure = document.require(layer, "DataDefinition/IncidentDataStructure")
    if "tree" in _raw(structure).lower():
        yield structure, "tensor trees; matrices expected"
    yield from _product(layer, document)
    channels = set()
    for data in document.children(layer, "WavelengthData"):
        wavelength = document.find(data, "Wavelength")
        channels.add(_raw(wavelength).strip().lower())
        unit = "" if wavelength is None else wavelength.get("unit", "")
        if unit.lower() != "integral":
            yield (
                wavelength,
                f"unit of Wavelength is {unit[:40]!r}; 'Integral' expected",
            )
        for block in document.children(data, "WavelengthDataBlock"):
            yield from _window_block(block, document)
    for channel in ("visible", "solar"):
        if channel not in channels:
            yield layer, f"no {channel} data; visible and solar data expected"


def _product(layer: etree._Element, document: Document) -> Iterator[_Reason]:
    for name in ("Name", "Manufacturer", "Thickness"):
        element = document.find(layer, f"Material/{name}")
        text = _raw(element).strip(" \t\r\n")
        if element is None or not (text or name == "Thickness"):
            yield layer, f"no {name} of the material; one expected"
        elif name == "Thickness" and element.get("unit") is None:
            yield element, "no unit of Thickness; one expected"
        elif name == "Thickness" and text and not re.match(r"[-+]?\.?\d", text):
            yield element, f"Thickness is {text[:40]!r}; a number expected"


def _window_block(block: etree._Element, document: Document) -> Iterator[_Reason]:
    direction = document.find(block, "WavelengthDataDirection")
    text = _raw(direction).strip().lower()
    if text not in _DIRECTIONS and " ".join(text.split()) in _DIRECTIONS:
        what = f"WavelengthDataDirection is {text[:40]!r}; single spaces expected"
        yield block if direction is None else direction, what
    data = document.find(block, "ScatteringData")
    values = _raw(data).strip()
    if data is not None and re.search(r"[\d.]\s+[-+.\d]", values):
        yield data, "values are not separated by commas; commas expected"
    elif data is not None and re.search(r"^\s*,|,\s*,", values):
        yield data, "two commas without a number between them; numbers expected"
    names = [document.text(block, f"{s}AngleBasis").lower() for s in ("Row", "Column")]
    if names[0] != names[1]:
        yield block, "rows and columns have different angle bases; one basis expected"
