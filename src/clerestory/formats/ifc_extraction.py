"""Program that writes the triangles and properties of an IFC file, by ifcopenshell.

    python ifc_extraction.py MODEL.ifc FOLDER

writes `products.json` and `triangles.npz`. It is a process of its own, since damaged
files can end the process or never finish; `ifc_process` runs it and reads its output.
"""

import json
import sys
from collections.abc import Iterator
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

# Exit status if the file cannot be read
UNREADABLE = 3

# Largest number of triangles: 24 bytes each, and 24 bytes a vertex
_MOST_TRIANGLES = 20_000_000

# Files with the products and their triangles
PRODUCTS, TRIANGLES = "products.json", "triangles.npz"

# Arrays of the triangles of all products
_ARRAYS = ("vertices", "faces", "styles", "parts")

# Names of numbers in property sets, of elements and of their materials
_NUMBERS = (
    "VisibleLightTransmittance",
    "VisibleTransmittance",
    "Visual Light Transmittance",
    "Translucency",
    "GlazingAreaFraction",
    "GlassLayers",
)
_GLAZED = ("IfcWindow", "IfcDoor", "IfcPlate", "IfcCurtainWall", "IfcMember")


def main(file: str, folder: str) -> int:
    """Write the content of an IFC file to a folder; return the exit status."""
    library = import_module("ifcopenshell")
    try:
        model = library.open(file)
        content = _content(model)
        products, bare, triangles = _products(model)
    except Exception as error:
        reason = str(error).strip().splitlines()
        sys.stderr.write(f"{reason[0] if reason else type(error).__name__}\n")
        return UNREADABLE
    content.update(products=products, without_surfaces=bare)
    Path(folder, PRODUCTS).write_text(json.dumps(content), encoding="utf-8")
    np.savez(Path(folder, TRIANGLES), **triangles)  # type: ignore[arg-type]
    return 0


# ------------------------------------- Project -------------------------------------
def _content(model: Any) -> dict[str, Any]:
    project = next(iter(model.by_type("IfcProject")), None)
    sites = [_site(model, site) for site in model.by_type("IfcSite")]
    return {
        "schema": model.schema,
        "name": _text(project, "LongName") or _text(project, "Name"),
        "north": _north(model),
        "site": next((site for site in sites if site), None),
    }


def _north(model: Any) -> list[float] | None:
    # Direction of north in the plane of the model
    for context in model.by_type("IfcGeometricRepresentationContext", False):
        if context.ContextType == "Model" and context.TrueNorth:
            return [float(x) for x in context.TrueNorth.DirectionRatios[:2]]
    return None


def _site(model: Any, site: Any) -> dict[str, Any] | None:
    if not (site.RefLatitude and site.RefLongitude):
        return None
    units = import_module("ifcopenshell.util.unit")
    height = (site.RefElevation or 0.0) * units.calculate_unit_scale(model)
    return {
        "latitude_deg": _angle(site.RefLatitude),
        "longitude_deg": _angle(site.RefLongitude),
        "elevation": height,
    }


def _angle(parts: Any) -> float:
    # Degrees, minutes, seconds and millionths of a second
    units = (1, 60, 3600, 3.6e9)
    return float(sum(part / unit for part, unit in zip(parts, units, strict=False)))


# ------------------------------------- Products -------------------------------------
def _products(
    model: Any,
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], dict[str, np.ndarray]]:
    # Products with surfaces, those without, and all triangles
    products, bare = [], {each.id(): _described(each) for each in _shown(model)}
    found: dict[str, list[np.ndarray]] = {name: [] for name in _ARRAYS}
    total = 0
    for product, hosted, shape in _shapes(model):
        mesh = shape.geometry
        faces = np.array(mesh.faces, dtype=np.int32).reshape(-1, 3)
        total += len(faces)
        if total > _MOST_TRIANGLES:
            raise ValueError(f"more than {_MOST_TRIANGLES:,} triangles")
        if not len(faces):
            continue
        bare.pop(product.id(), None)
        found["vertices"].append(np.array(mesh.verts, dtype=float).reshape(-1, 3))
        found["faces"].append(faces)
        found["styles"].append(np.array(mesh.material_ids, dtype=np.int32))
        found["parts"].append(np.array(mesh.item_ids, dtype=np.int32))
        products.append(
            {
                **_described(product),
                "opening": hosted,
                "vertices": len(found["vertices"][-1]),
                "triangles": len(faces),
                "styles": [_style(model, each) for each in mesh.materials],
            }
        )
    arrays = {name: np.concatenate(each) for name, each in found.items() if each}
    return products, list(bare.values()), arrays


def _shown(model: Any) -> list[Any]:
    # Products whose shapes are read, if they have one
    return [
        product
        for product in model.by_type("IfcProduct")
        if product.Representation and _is_read(product)
    ]


def _shapes(model: Any) -> Iterator[tuple[Any, bool, Any]]:
    # Products with their shapes; of windows without shape, the opening in the wall
    geometry = import_module("ifcopenshell.geom")
    settings = geometry.settings()
    settings.set("use-world-coords", True)
    shown = _shown(model)
    if shown:
        shapes = geometry.iterator(settings, model, 1, include=shown)
        more = shapes.initialize()
        while more:
            shape = shapes.get()
            yield model.by_id(shape.id), False, shape
            more = shapes.next()
    for window in model.by_type("IfcWindow"):
        for fills in window.FillsVoids if not window.Representation else ():
            opening = fills.RelatingOpeningElement
            yield window, True, geometry.create_shape(settings, opening)


def _is_read(product: Any) -> bool:
    if product.is_a("IfcElement"):
        excluded = ("IfcFeatureElementSubtraction", "IfcVirtualElement")
        return not any(map(product.is_a, excluded))
    return any(map(product.is_a, ("IfcSpace", "IfcSite", "IfcProxy")))


def _described(product: Any) -> dict[str, Any]:
    element = import_module("ifcopenshell.util.element")
    materials = element.get_materials(product)
    numbers: dict[str, float] = {}
    if any(map(product.is_a, _GLAZED)):
        for owner in (product, *materials):
            numbers = {**_numbers(element.get_psets(owner)), **numbers}
    return {
        "guid": _text(product, "GlobalId"),
        "kind": product.is_a(),
        "type": str(element.get_predefined_type(product) or ""),
        "name": _text(product, "Name"),
        "long_name": _text(product, "LongName"),
        "materials": [text for each in materials if (text := _text(each, "Name"))],
        "numbers": numbers,
    }


def _numbers(sets: dict[str, dict[str, Any]]) -> dict[str, float]:
    found: dict[str, float] = {}
    for values in sets.values():
        for name in _NUMBERS:
            value = values.get(name)
            if isinstance(value, int | float) and isfinite(value):
                found.setdefault(name, float(value))
    return found


def _style(model: Any, style: Any) -> dict[str, Any]:
    # Styles without a number are default styles of ifcopenshell
    number = style.instance_id()
    if not number:
        return {}
    clear = float(style.transparency) if style.has_transparency() else 0.0
    return {
        "name": _text(model.by_id(number), "Name"),
        "transparency": clear if isfinite(clear) else 0.0,
    }


def _text(entity: Any, attribute: str) -> str:
    return str(getattr(entity, attribute, None) or "")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
