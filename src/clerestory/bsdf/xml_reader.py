"""Reader of BSDF files in the XML schema of LBNL (WINDOW, genBSDF, wrapBSDF).

The partition of the hemisphere is read from the rings in the file and checked against
the number of values. The basis name is not sufficient: "LBNL/Klems Half" has been used
for 73 and for 77 patches.
"""

import warnings
from pathlib import Path
from typing import Literal

import numpy as np
from lxml import etree

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS, Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdf.xml_basis import Bases, choose_bases, read_bases
from clerestory.bsdf.xml_document import (
    Document,
    is_number,
    parse_document,
    read_numbers,
)
from clerestory.bsdf.xml_product import read_product
from clerestory.errors import ClerestoryWarning
from clerestory.hemisphere.klems import klems
from clerestory.spectra import wavelength_unit_nm

# Scattering functions by WavelengthDataDirection in lower case.
_NAMES: dict[str, Function] = {name.replace("_", " "): name for name in FUNCTIONS}

# Channels that are integrals over a spectrum, whatever the unit of their wavelength.
_INTEGRALS = ("visible", "solar", "nir", "cie-x", "cie-z", "cie-u", "cie-v")

# Ranks of tensor trees by IncidentDataStructure, and angle basis of trees.
_RANKS: dict[str, Literal[3, 4]] = {"tensortree3": 3, "tensortree4": 4}
_BASIS = "LBNL/Shirley-Chiu"

# Transmittance or reflectance above this limit causes a warning, as in Radiance.
_ENERGY_LIMIT = 1.01


def read_bsdf(path: str | Path) -> Bsdf:
    """Read a BSDF from an XML file with matrices or tensor trees.

    Harmless irregularities (text before the XML, a repeated block, slightly negative
    values) are listed in `Bsdf.notes`.

    Raises
    ------
    InputError : the file is not a BSDF file, is damaged or has no data

    Warns
    -----
    ClerestoryWarning : the scattered flux exceeds the incident flux
    """
    document = parse_document(path)
    layer = document.require(document.root, "Optical/Layer")
    definition = document.require(layer, "DataDefinition")
    document.refuse_repeated(document.require(document.root, "Optical"))
    document.refuse_repeated(layer, but="WavelengthData")
    document.refuse_repeated(definition, but="AngleBasis")
    structure = document.require(definition, "IncidentDataStructure")
    kind = (structure.text or "").strip()
    rank = _RANKS.get(kind.lower())
    document.check(
        rank or kind.lower() in ("columns", "rows"),
        structure,
        f"IncidentDataStructure is {kind[:40]!r}; Columns, Rows, TensorTree3 or"
        " TensorTree4 expected",
    )
    bases = read_bases(definition, document)

    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for data in document.children(layer, "WavelengthData"):
        channel = _channel(data, document)
        document.refuse_repeated(data, but="WavelengthDataBlock")
        for block in document.children(data, "WavelengthDataBlock"):
            document.refuse_repeated(block)
            direction = document.text(block, "WavelengthDataDirection")
            name = _NAMES.get(" ".join(direction.lower().split()))
            if name is None:
                document.note(block, f"the unknown direction {direction!r} is ignored")
                continue
            if (channel, name) in functions:
                twice = f"{channel} {direction} is given twice"
                document.notes.append(f"{twice}; the last one is used")
            functions[channel, name] = (
                _read_matrix(block, bases, kind.lower() == "rows", document)
                if rank is None
                else _read_tree(block, rank, document)
            )
    document.check(functions, layer, "no scattering data; WavelengthDataBlock expected")
    bsdf = Bsdf(
        functions, read_product(layer, document), tuple(document.notes), str(path)
    )
    _warn_of_energy(bsdf, path)
    return bsdf


def _channel(data: etree._Element, document: Document) -> str:
    # "visible", whatever its unit, or "550 nm" for data at a wavelength
    text = document.text(data, "Wavelength").lower()
    element = document.find(data, "Wavelength")
    unit = "" if element is None else element.get("unit", "")
    unit_nm = wavelength_unit_nm(unit)
    if unit_nm is None or text in _INTEGRALS:
        return text
    document.check(
        is_number(text) and 0 < float(text) * unit_nm < np.inf,
        data,
        f"the wavelength is {text[:40]!r}; a number above 0 expected",
    )
    return f"{float(text) * unit_nm:.9g} nm"


def _read_matrix(
    block: etree._Element, bases: Bases, by_rows: bool, document: Document
) -> ScatteringMatrix:
    # Find the partitions that fit the basis names and the number of values
    data = document.require(block, "ScatteringData")
    values = read_numbers(data, document)
    rows, columns = choose_bases(block, bases, count=len(values), document=document)
    table = values.reshape(len(rows), len(columns))

    # "Columns": one incident direction per column; "Rows": one per row
    exits, incidents = (columns, rows) if by_rows else (rows, columns)
    table = np.ascontiguousarray(table.T) if by_rows else table

    # Set small negative BSDF values (noise, interpolation) to zero
    weights = exits.projected_solid_angles()
    lost = float(np.max(weights @ np.maximum(-table, 0)))
    document.accept_negative(lost, data)
    return ScatteringMatrix(np.maximum(table, 0), exits, incidents)


def _warn_of_energy(bsdf: Bsdf, path: str | Path) -> None:
    for (channel, name), part in bsdf.functions.items():
        if channel in ("cie-u", "cie-v"):
            continue
        _, incidents = part.own_partitions() or (None, klems("quarter"))
        most = float(part.hemispherical(incidents.centres() * [-1, -1, 1]).max())
        if most > _ENERGY_LIMIT:
            warnings.warn(
                f"{path}: {channel} {name.replace('_', ' ')} scatters {most:.3f} times"
                " the incident flux; at most 1 expected",
                ClerestoryWarning,
                stacklevel=3,
            )


def _read_tree(
    block: etree._Element, rank: Literal[3, 4], document: Document
) -> ScatteringTree:
    data = document.require(block, "ScatteringData")
    basis = document.text(block, "AngleBasis")
    message = f"angle basis of a tensor tree is {basis[:60]!r}; {_BASIS!r} expected"
    document.check(basis.lower() == _BASIS.lower(), block, message)
    message = "a tensor tree contains an element or a comment; only numbers expected"
    document.check(not len(data), data, message)
    number = document.trees.find(data.text)
    if number is None:
        found = " ".join((data.text or "").split())[:40]
        message = f"no tensor tree but {found!r}; numbers in braces {{…}} expected"
        raise document.error(data, message)
    line = document.lines_before + document.trees.first_line[number]
    text = document.trees.texts[number]
    table = parse_tree(text, rank=rank, file=document.path, line=line)

    # Half of a rank 3 tree is unused: the mean over the used half is twice as large
    document.accept_negative(3.1416 * table.negative * (2 if rank == 3 else 1), data)
    return ScatteringTree(table.slots, rank, table.depth)
