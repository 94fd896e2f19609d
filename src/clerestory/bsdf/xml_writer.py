"""Writer of BSDF files in the XML schema of LBNL."""

import re
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

import numpy as np
from jaxtyping import Float32
from lxml import etree
from lxml.builder import ElementMaker

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Detail, Product, usual_spectra
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import morton_order
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.escaping import header_line, xml_text
from clerestory.files import replace_file
from clerestory.hemisphere.partition import RingPartition

_NAMESPACE = "http://windows.lbl.gov"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_SCHEMA = "http://windows.lbl.gov/BSDF-v1.4.xsd"
_E = ElementMaker(namespace=_NAMESPACE, nsmap={None: _NAMESPACE, "xsi": _XSI})

_LABELS = {
    label.lower(): label
    for label in ("Visible", "Solar", "NIR", "IR", "CIE-X", "CIE-Z", "CIE-u", "CIE-v")
}

# Text written for empty names: WinCalc requires text, and readers strip the space.
_BLANK = "\N{NO-BREAK SPACE}"

# Least number of slots of trees that are written with fewer digits.
_MANY_SLOTS = 10_000

# Empty element that is replaced by the BSDF values; only a comment before all data can
# contain the same text.
_NO_VALUES = b"<ScatteringData/>"


def usual_digits(bsdf: Bsdf) -> int:
    """Significant digits for files of traced, measured and converted layers.

    Matrices and small trees have 7. Trees of many cells, whose text is a hundred times
    longer, have 5: the values of single cells have errors of a per cent and more.
    """
    trees = [p for p in bsdf.functions.values() if isinstance(p, ScatteringTree)]
    return 5 if sum(len(tree.slots) for tree in trees) > _MANY_SLOTS else 7


def write_bsdf(
    path: str | Path, bsdf: Bsdf, *, digits: int | None = None, comment: str = ""
) -> None:
    """Write a BSDF with matrices or tensor trees to an XML file.

    Parameters
    ----------
    digits : significant digits of the values; None for lossless output
    comment : XML comment at the start of the file, such as the origin of the data

    Raises
    ------
    InputError : matrices and trees are mixed, two partitions share a name, or the name
        of an element is not allowed in XML
    OutputError : the file cannot be written
    """
    try:
        root = _window_element(bsdf, comment)
    except ValueError as error:
        raise InputError(f"BSDF {bsdf.product.name!r}: {error}") from error
    etree.indent(root, space=" ")
    text = etree.tostring(root, xml_declaration=True, encoding="UTF-8")

    # Write BSDF values line by line: the text of a deep tree can exceed 100 MB
    head, *rest = text.rsplit(_NO_VALUES, len(bsdf.functions))
    with replace_file(path) as stream:
        stream.write(head)
        for part, after in zip(bsdf.functions.values(), rest, strict=True):
            stream.write(b"<ScatteringData>")
            stream.writelines(line.encode() for line in _lines(part, digits))
            stream.write(b"</ScatteringData>" + after)
        stream.write(b"\n")


def _window_element(bsdf: Bsdf, comment: str) -> etree._Element:
    definition = _E.DataDefinition(
        _E.IncidentDataStructure(_structure(bsdf)), *map(_basis, _partitions(bsdf))
    )
    layer = _E.Layer(
        _material(bsdf.product), *_geometry(bsdf.product), definition, *_data(bsdf)
    )
    root = _E.WindowElement(
        _E.WindowElementType("System"), _E.FileType("BSDF"), _E.Optical(layer)
    )
    root.set(f"{{{_XSI}}}schemaLocation", f"{_NAMESPACE} {_SCHEMA}")
    if comment:
        # XML does not allow two hyphens in a comment
        text = re.sub("-(?=-)", "- ", header_line(comment))
        root.insert(0, etree.Comment(f" {text} "))
    return root


def _material(product: Product) -> etree._Element:
    # Write the thickness in millimetres: WinCalc ignores the unit attribute
    thickness = Decimal(repr(float(product.thickness or 0))) * 1000
    return _E.Material(
        _E.Name(xml_text(product.name) or _BLANK),
        _E.Manufacturer(xml_text(product.manufacturer) or _BLANK),
        _E.Thickness(f"{thickness.normalize():f}", unit="Millimeter"),
        *_number("Width", product.width, unit="Meter"),
        *_number("Height", product.height, unit="Meter"),
        _E.DeviceType(xml_text(product.device_type)),
        *_number("EmissivityFront", product.emissivity_front),
        *_number("EmissivityBack", product.emissivity_back),
        *(_detail(one) for one in product.details if "/" not in one.name),
    )


def _number(
    name: str, value: float | None, **attributes: str
) -> Iterator[etree._Element]:
    if value is not None:
        yield _E(name, repr(float(value)), **attributes)


def _detail(detail: Detail) -> etree._Element:
    unit = {"unit": xml_text(detail.unit)} if detail.unit else {}
    return _E(detail.name.rpartition("/")[2], xml_text(detail.text), **unit)


def _geometry(product: Product) -> Iterator[etree._Element]:
    geometry = product.geometry
    details = [_detail(d) for d in product.details if d.name.startswith("Geometry/")]
    if geometry is not None:
        # Write other units as an MGF scaling transform: the schema allows few units
        text = geometry.text
        if geometry.metres != 1:
            text = f"xf -s {geometry.metres!r}\n{text}\nxf\n"
        yield _E.Geometry(
            *details, _E.MGFblock(xml_text(text), unit="meter"), format="MGF"
        )
    elif details:
        yield _E.Geometry(*details)


def _structure(bsdf: Bsdf) -> str:
    # A file contains either matrices or trees of one rank
    kinds = {
        f"TensorTree{part.rank}"
        if isinstance(part, ScatteringTree)
        else "Columns"
        if isinstance(part, ScatteringMatrix)
        else type(part).__name__
        for part in bsdf.functions.values()
    }
    require(
        len(kinds) < 2 and kinds <= {"Columns", "TensorTree3", "TensorTree4"},
        f"BSDF {bsdf.product.name!r} contains {' and '.join(sorted(kinds))};"
        " matrices only, or trees of one rank only, expected",
    )
    return kinds.pop() if kinds else "Columns"


def _partitions(bsdf: Bsdf) -> list[RingPartition]:
    # Require unique names: Radiance and WINDOW identify partitions by name
    found: dict[str, RingPartition] = {}
    for part in bsdf.functions.values():
        for partition in part.own_partitions() or ():
            known = found.setdefault(partition.name.lower(), partition)
            require(
                known.matches(partition),
                f"two different angle bases ({len(known)} and {len(partition)} patches)"
                f" are named {partition.name!r}; different names expected",
            )
    return list(found.values())


def _basis(partition: RingPartition) -> etree._Element:
    limits = np.round(np.degrees(partition.theta), 9)
    rings = zip(partition.count, limits[:-1], limits[1:], strict=True)
    blocks = [
        _E.AngleBasisBlock(
            _E.Theta(f"{0 if count == 1 and low == 0 else (low + high) / 2:.9g}"),
            _E.nPhis(str(count)),
            _E.ThetaBounds(_E.LowerTheta(f"{low:.9g}"), _E.UpperTheta(f"{high:.9g}")),
        )
        for count, low, high in rings
    ]
    return _E.AngleBasis(_E.AngleBasisName(xml_text(partition.name)), *blocks)


def _data(bsdf: Bsdf) -> Iterator[etree._Element]:
    spectra = {one.channel: one for one in bsdf.product.spectra}
    for (channel, name), part in bsdf.functions.items():
        weighting = spectra.get(channel) or usual_spectra(channel)
        direction = name.replace("_", " ").title()
        bases = [_E.AngleBasis("LBNL/Shirley-Chiu")]
        if isinstance(part, ScatteringMatrix):
            column, row = xml_text(part.incidents.name), xml_text(part.exits.name)
            bases = [_E.ColumnAngleBasis(column), _E.RowAngleBasis(row)]
        yield _E.WavelengthData(
            _E.LayerNumber("System"),
            _wavelength(channel),
            _E.SourceSpectrum(xml_text(weighting.source)),
            _E.DetectorSpectrum(xml_text(weighting.detector)),
            _E.WavelengthDataBlock(
                _E.WavelengthDataDirection(direction),
                *bases,
                _E.ScatteringDataType(f"B{direction[0]}DF"),
                _E.ScatteringData(),
            ),
        )


def _wavelength(channel: str) -> etree._Element:
    # Data at a wavelength have the unit of WINDOW's schema; others are integrals
    number, _, unit = channel.partition(" ")
    if unit == "nm" and number.replace(".", "", 1).isdecimal():
        return _E.Wavelength(number, unit="Nanometer")
    return _E.Wavelength(xml_text(_LABELS.get(channel, channel)), unit="Integral")


def _lines(part: ScatteringFunction, digits: int | None) -> Iterator[str]:
    # Yield the BSDF values of a scattering function as text
    if isinstance(part, ScatteringTree):
        for line in tree_lines(part, digits=digits):
            yield line + "\n"
    if not isinstance(part, ScatteringMatrix):
        return

    # Shorten 0.0 to 0: most values of a clear pane are zero
    def write(value: float) -> str:
        text = repr(value) if digits is None else f"{value:.{digits}g}"
        return text.removesuffix(".0")

    rows = (",".join(map(write, row)) for row in part.values.tolist())
    yield "\n" + ",\n".join(rows) + "\n"


def tree_lines(tree: ScatteringTree, *, digits: int | None = None) -> Iterator[str]:
    """Yield the text of a tree line by line; a line is a brace or a block of values."""
    slots, width = tree.slots, 1 << tree.rank
    blocks = slots[1:].reshape(-1, width)
    full = np.all(blocks >= 0, axis=1)
    order = np.argsort(morton_order(tree.rank, 1))

    # Stack of slots to write; None stands for a closing brace
    waiting: list[int | None] = [int(slots[0])]
    while waiting:
        code = waiting.pop()
        if code is None:
            yield "}"
        elif code >= 0:
            yield _row(np.array([code], dtype=np.int32).view(np.float32), digits)
        elif full[number := ~code // width]:
            yield _row(blocks[number][order].view(np.float32), digits)
        else:
            yield "{"
            waiting.append(None)
            waiting.extend(blocks[number][::-1].tolist())


def _row(values: Float32[np.ndarray, " value"], digits: int | None) -> str:
    # One format string per row is several times faster than a string per value
    if digits is None:
        texts = " ".join(str(value).removesuffix(".0") for value in values)
    else:
        texts = f"%.{digits}g " * len(values) % tuple(values.tolist())
    # Omit leading zeros: trees are large, and all readers accept .5 and 2e-5
    short = f" {texts}".replace(" 0.", " .").replace("e-0", "e-")
    return f"{{{short.strip()}}}"
