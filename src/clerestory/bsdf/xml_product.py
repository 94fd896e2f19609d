"""Reader of product information in BSDF files."""

import math
from collections.abc import Iterator
from decimal import Decimal

from lxml import etree

from clerestory.bsdf.product_data import (
    Detail,
    Geometry,
    Product,
    Spectra,
    usual_spectra,
)
from clerestory.bsdf.xml_document import Document, is_number

# Length units [m], as decimal numbers so that conversions are exact.
_METRES = {
    "meter": Decimal(1),
    "decimeter": Decimal("0.1"),
    "centimeter": Decimal("0.01"),
    "millimeter": Decimal("0.001"),
    "micron": Decimal("0.000001"),
    "inch": Decimal("0.0254"),
    "foot": Decimal("0.3048"),
}

# Child elements of Material that are stored in attributes of `Product`.
_KNOWN = (
    *("Name", "Manufacturer", "DeviceType", "Thickness", "Width", "Height"),
    *("EmissivityFront", "EmissivityBack", "Geometry"),
)


def read_product(layer: etree._Element, document: Document) -> Product:
    """Return the product information of a layer; missing entries are empty or None."""
    material = document.find(layer, "Material")
    if material is None:
        material = etree.Element("Material")
    return Product(
        geometry=_geometry(layer, document),
        details=tuple(_details(layer, document)),
        spectra=tuple(_spectra(layer, document)),
        name=document.text(material, "Name"),
        manufacturer=document.text(material, "Manufacturer"),
        device_type=document.text(material, "DeviceType") or "Other",
        thickness=_length(material, "Thickness", document),
        width=_length(material, "Width", document),
        height=_length(material, "Height", document),
        emissivity_front=_number(document.text(material, "EmissivityFront")),
        emissivity_back=_number(document.text(material, "EmissivityBack")),
    )


def _geometry(layer: etree._Element, document: Document) -> Geometry | None:
    # MGF text is in an MGFblock, or directly in Geometry in files of old genBSDF
    element = document.find(layer, "Geometry")
    if element is None:
        element = document.find(layer, "Material/Geometry")
    if element is None or (element.get("format") or "MGF").strip().upper() != "MGF":
        return None
    block = document.find(element, "MGFblock")
    if block is None and element.get("format") is None:
        return None
    holder = element if block is None else block
    text = holder.text or ""
    if not text.strip():
        return None
    metres = _metres(holder)
    if metres is None:
        unit = f"the unit of the geometry is {holder.get('unit')!r}; one of"
        raise document.error(holder, f"{unit} {', '.join(_METRES)} expected")
    return Geometry(text, float(metres), document.line(holder))


def _details(layer: etree._Element, document: Document) -> Iterator[Detail]:
    for path, prefix in (("Material", ""), ("Geometry", "Geometry/")):
        parent = document.find(layer, path)
        for element in [] if parent is None else parent.iterchildren(etree.Element):
            name, text = etree.QName(element).localname, (element.text or "").strip()
            own = name == "MGFblock" if prefix else name in _KNOWN
            if text and not own and not len(element):
                yield Detail(prefix + name, text, element.get("unit") or "")


def _spectra(layer: etree._Element, document: Document) -> Iterator[Spectra]:
    found: dict[str, Spectra] = {}
    for data in document.children(layer, "WavelengthData"):
        channel = document.text(data, "Wavelength").lower()
        source = document.text(data, "SourceSpectrum")
        detector = document.text(data, "DetectorSpectrum")
        if source or detector:
            found.setdefault(channel, Spectra(channel, source, detector))
    return (one for one in found.values() if one != usual_spectra(one.channel))


def _metres(element: etree._Element) -> Decimal | None:
    # Length unit of an element [m]; None if unknown
    return _METRES.get((element.get("unit") or "meter").strip().lower())


def _number(text: str) -> float | None:
    # Treat invalid numbers as missing: simulations do not use product data
    valid = is_number(text) and math.isfinite(float(text))
    return float(text) if valid else None


def _length(material: etree._Element, name: str, document: Document) -> float | None:
    element = document.find(material, name)
    if element is None:
        return None
    metres = _metres(element)
    text = (element.text or "").strip()
    value = _number(text)
    negative = f"{name} is {text[:40]}; 0 or more expected"
    document.check(value is None or value >= 0, element, negative)
    if metres is None and value:
        unit = element.get("unit")
        document.note(element, f"{name} in the unknown unit {unit!r} is ignored")
    return _number(str(Decimal(text) * metres)) if metres and value else None
