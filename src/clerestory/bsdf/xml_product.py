"""Name and dimensions of the product in a BSDF file."""

import math

from lxml import etree

from clerestory.bsdf.product import Geometry, Product
from clerestory.bsdf.xml_document import Document

_METRES = {
    "meter": 1.0,
    "decimeter": 0.1,
    "centimeter": 0.01,
    "millimeter": 0.001,
    "micron": 1e-6,
    "inch": 0.0254,
    "foot": 0.3048,
}


def read_product(layer: etree._Element, document: Document) -> Product:
    """Return what the Material element of a layer says; empty where it says nothing."""
    geometry = _geometry(layer, document)
    material = document.find(layer, "Material")
    if material is None:
        return Product(geometry=geometry)
    return Product(
        name=document.text(material, "Name"),
        manufacturer=document.text(material, "Manufacturer"),
        device_type=document.text(material, "DeviceType") or "Other",
        thickness=_length(material, "Thickness", document),
        width=_length(material, "Width", document),
        height=_length(material, "Height", document),
        emissivity_front=_number(document.text(material, "EmissivityFront")),
        emissivity_back=_number(document.text(material, "EmissivityBack")),
        geometry=geometry,
    )


def _geometry(layer: etree._Element, document: Document) -> Geometry | None:
    # MGF stands in a block of its own, in files of old genBSDF in the element itself
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
    metres = _METRES.get((holder.get("unit") or "meter").strip().lower())
    if not text.strip() or metres is None:
        return None
    return Geometry(text, metres, document.line(holder))


def _number(text: str) -> float | None:
    # These values are informative: what cannot be understood counts as not said
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _length(material: etree._Element, name: str, document: Document) -> float | None:
    element = document.find(material, name)
    if element is None:
        return None
    value = _number((element.text or "").strip())
    metres = _METRES.get((element.get("unit") or "meter").strip().lower())
    return None if value is None or metres is None else value * metres
