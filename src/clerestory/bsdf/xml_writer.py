"""Writer of BSDF files in the XML schema of LBNL."""

from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

import numpy as np
from jaxtyping import Float32
from lxml import etree

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Detail, Product, usual_spectra
from clerestory.bsdf.scattering_function import ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import morton_order
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import replace_file
from clerestory.hemisphere.partition import RingPartition

_NAMESPACE = "http://windows.lbl.gov"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_SCHEMA = "http://windows.lbl.gov/BSDF-v1.4.xsd"

_LABELS = {
    label.lower(): label
    for label in ("Visible", "Solar", "NIR", "IR", "CIE-X", "CIE-Z", "CIE-u", "CIE-v")
}

# Written for empty names: WinCalc requires text, and readers strip the space.
_BLANK = "\N{NO-BREAK SPACE}"

# Empty element that is replaced by the BSDF values; only a comment before all data can
# contain the same text.
_NO_VALUES = b"<ScatteringData/>"


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
    InputError : matrices and trees are mixed, two partitions share a name, or a text is
        not allowed in XML
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
    root = etree.Element(
        f"{{{_NAMESPACE}}}WindowElement", nsmap={None: _NAMESPACE, "xsi": _XSI}
    )
    root.set(f"{{{_XSI}}}schemaLocation", f"{_NAMESPACE} {_SCHEMA}")
    if comment:
        root.append(etree.Comment(f" {comment} "))
    _add(root, "WindowElementType", "System")
    _add(root, "FileType", "BSDF")
    layer = _add(_add(root, "Optical"), "Layer")
    _add_material(layer, bsdf.product)
    _add_geometry(layer, bsdf.product)
    definition = _add(layer, "DataDefinition")
    _add(definition, "IncidentDataStructure", _structure(bsdf))
    for basis in _partitions(bsdf):
        _add_basis(definition, basis)
    spectra = {one.channel: one for one in bsdf.product.spectra}
    for (channel, name), part in bsdf.functions.items():
        weighting = spectra.get(channel) or usual_spectra(channel)
        data = _add(layer, "WavelengthData")
        _add(data, "LayerNumber", "System")
        _add(data, "Wavelength", _LABELS.get(channel, channel), unit="Integral")
        _add(data, "SourceSpectrum", weighting.source)
        _add(data, "DetectorSpectrum", weighting.detector)
        _add_block(data, name.replace("_", " ").title(), part)
    return root


def _add(
    parent: etree._Element, name: str, text: str | None = None, **attributes: str
) -> etree._Element:
    child = etree.SubElement(parent, f"{{{_NAMESPACE}}}{name}", attributes)
    child.text = text
    return child


def _add_material(layer: etree._Element, product: Product) -> None:
    material = _add(layer, "Material")
    _add(material, "Name", product.name or _BLANK)
    _add(material, "Manufacturer", product.manufacturer or _BLANK)
    # Write the thickness in millimetres: WinCalc ignores the unit attribute
    thickness = Decimal(repr(float(product.thickness or 0))) * 1000
    _add(material, "Thickness", f"{thickness.normalize():f}", unit="Millimeter")
    _add_number(material, "Width", product.width, unit="Meter")
    _add_number(material, "Height", product.height, unit="Meter")
    _add(material, "DeviceType", product.device_type)
    _add_number(material, "EmissivityFront", product.emissivity_front)
    _add_number(material, "EmissivityBack", product.emissivity_back)
    _add_details(material, [d for d in product.details if "/" not in d.name])


def _add_number(
    parent: etree._Element, name: str, value: float | None, **attributes: str
) -> None:
    if value is not None:
        _add(parent, name, repr(float(value)), **attributes)


def _add_details(parent: etree._Element, details: list[Detail]) -> None:
    for detail in details:
        unit = {"unit": detail.unit} if detail.unit else {}
        _add(parent, detail.name.rpartition("/")[2], detail.text, **unit)


def _add_geometry(layer: etree._Element, product: Product) -> None:
    geometry = product.geometry
    details = [d for d in product.details if d.name.startswith("Geometry/")]
    if geometry is None and not details:
        return
    element = _add(layer, "Geometry", **({} if geometry is None else {"format": "MGF"}))
    _add_details(element, details)
    if geometry is not None:
        # Write other units as an MGF scaling transform: the schema allows few units
        text = geometry.text
        if geometry.metres != 1:
            text = f"xf -s {geometry.metres!r}\n{text}\nxf\n"
        _add(element, "MGFblock", text, unit="meter")


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
    # Radiance and WINDOW identify partitions by name
    found: dict[str, RingPartition] = {}
    for part in bsdf.functions.values():
        for partition in part.own_partitions() or ():
            known = found.setdefault(partition.name.lower(), partition)
            require(
                known.matches(partition),
                f"two partitions of {len(known)} and {len(partition)} patches are both"
                f" named {partition.name!r}; different names expected",
            )
    return list(found.values())


def _add_basis(definition: etree._Element, partition: RingPartition) -> None:
    basis = _add(definition, "AngleBasis")
    _add(basis, "AngleBasisName", partition.name)
    limits = np.round(np.degrees(partition.theta), 9)
    for count, lower, upper in zip(partition.count, limits, limits[1:], strict=False):
        block = _add(basis, "AngleBasisBlock")
        pole = count == 1 and lower == 0
        _add(block, "Theta", f"{lower if pole else (lower + upper) / 2:.9g}")
        _add(block, "nPhis", str(count))
        bounds = _add(block, "ThetaBounds")
        _add(bounds, "LowerTheta", f"{lower:.9g}")
        _add(bounds, "UpperTheta", f"{upper:.9g}")


def _add_block(data: etree._Element, direction: str, part: ScatteringFunction) -> None:
    block = _add(data, "WavelengthDataBlock")
    _add(block, "WavelengthDataDirection", direction)
    if isinstance(part, ScatteringMatrix):
        _add(block, "ColumnAngleBasis", part.incidents.name)
        _add(block, "RowAngleBasis", part.exits.name)
    if isinstance(part, ScatteringTree):
        _add(block, "AngleBasis", "LBNL/Shirley-Chiu")
    _add(block, "ScatteringDataType", f"B{direction[0]}DF")
    _add(block, "ScatteringData")


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
    """Yield the text of a tree line by line: a brace or a block of values each."""
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
    return f"{{ {texts.rstrip()} }}"
