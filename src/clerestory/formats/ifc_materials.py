"""Materials of products in IFC files: a material map, property sets, default values.

IFC files describe the colours of pictures, not reflectances. Without an entry in the
material map, reflectances are those that IES LM-83 assumes, and the transmittance of
glass is taken from property sets.

Reference: IES LM-83-23, surface reflectances of spaces.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping

import numpy as np
from jaxtyping import Float, Int

from clerestory.formats.ifc_glazing import Glazing
from clerestory.formats.ifc_process import Mesh, Product
from clerestory.formats.triangle_outlines import area_normals
from clerestory.scene.materials.glass import transmissivity
from clerestory.scene.model import Glass, Material, Plastic

# Reflectances of floors, walls and other surfaces, ceilings, and the ground outdoors
_FLOOR, _WALL, _CEILING, _GROUND = 0.2, 0.5, 0.7, 0.1

# Elements whose upper side is a floor and whose lower side is a ceiling
_SLABS = (
    "IfcSlab",
    "IfcRoof",
    "IfcStair",
    "IfcStairFlight",
    "IfcRamp",
    "IfcRampFlight",
)
_OUTDOORS = ("IfcSite", "IfcGeographicElement")

# Visible transmittance of glass without properties: honeybee's generic double glazing
_TRANSMITTANCE, _INDEX = 0.64, 1.52

# Properties with the visible transmittance, in the order of preference
_PROPERTIES = (
    "VisibleLightTransmittance",
    "VisibleTransmittance",
    "Visual Light Transmittance",
    "Translucency",
)


class Materials:
    """Materials by name in a map, default materials, and the assumptions made.

    `given` has the materials of styles, IFC materials and classes by name, and "*" for
    all other opaque surfaces.
    """

    def __init__(self, given: Mapping[str, Material]) -> None:
        self.given = given
        self.assumed: defaultdict[str, set[str]] = defaultdict(set)

    def opaque(
        self, mesh: Mesh, triangles: Int[np.ndarray, " some"]
    ) -> Iterator[tuple[Material, Int[np.ndarray, " part"]]]:
        """Yield each material of opaque triangles, and its triangles."""
        styles = mesh.product.styles
        for number in np.unique(mesh.style[triangles]):
            part = triangles[mesh.style[triangles] == number]
            style = styles[number].name if 0 <= number < len(styles) else ""
            known = self._known(style, *mesh.product.materials, mesh.product.kind)
            if known or "*" in self.given:
                yield known or self.given["*"], part
            else:
                yield from self._default(mesh, part)

    def frame(self, product: Product) -> Material:
        """Return the material of the opaque part of a window that is a box."""
        known = self._known(*product.materials, product.kind)
        return known or self.given.get("*") or self._grey(product, _WALL)

    def glass(self, product: Product, glazing: Glazing) -> Material:
        """Return the material of the panes of a product."""
        known = self._known(glazing.style, *product.materials)
        if known:
            return known
        for name in _PROPERTIES:
            value = product.numbers.get(name, 0.0)
            share = value / 100 if 1 < value <= 100 else value
            if 0 < share <= 1:
                return _glass(share)
        text = (
            f"visible transmittance {_TRANSMITTANCE:g} of the glass of {product.kind}"
        )
        self.assumed[text].add(product.guid)
        return _glass(_TRANSMITTANCE)

    def _known(self, *names: str) -> Material | None:
        return next((self.given[n] for n in names if n in self.given), None)

    def _default(
        self, mesh: Mesh, triangles: Int[np.ndarray, " some"]
    ) -> Iterator[tuple[Material, Int[np.ndarray, " part"]]]:
        product = mesh.product
        if product.kind in _SLABS:
            up = _upward(mesh.vertices[mesh.faces[triangles]])
            for place, reflectance, chosen in (
                ("upper side", _FLOOR, up > _STEEP),
                ("lower side", _CEILING, up < -_STEEP),
                ("edges", _WALL, np.abs(up) <= _STEEP),
            ):
                if chosen.any():
                    part = triangles[chosen]
                    yield self._grey(product, reflectance, place), part
            return
        reflectance = _GROUND if product.kind in _OUTDOORS else _WALL
        place = product.type.lower() if product.type in _COVERINGS else ""
        reflectance = _COVERINGS.get(product.type, reflectance)
        yield self._grey(product, reflectance, place), triangles

    def _grey(self, product: Product, reflectance: float, place: str = "") -> Material:
        named = f"{product.kind} ({place})" if place else product.kind
        self.assumed[f"reflectance {reflectance:g} of {named}"].add(product.guid)
        return Plastic(f"{product.kind}_{reflectance:.2f}", np.full(3, reflectance))

    def assumptions(self) -> tuple[str, ...]:
        """Return the assumed values, with the number of products."""
        found = sorted(self.assumed.items())
        return tuple(f"{text}: {len(products)}" for text, products in found)


# Reflectances by predefined type, and the steepest floor (sine of its angle)
_COVERINGS = {"CEILING": _CEILING, "FLOORING": _FLOOR, "ROOFING": _FLOOR}
_STEEP = 0.7


def _upward(corners: Float[np.ndarray, "some 3 3"]) -> Float[np.ndarray, " some"]:
    # Vertical component of the unit normals
    area = area_normals(corners)
    length = np.maximum(np.linalg.norm(area, axis=1), 1e-30)
    return np.asarray(area[:, 2] / length)


def _glass(share: float) -> Glass:
    value = float(transmissivity(np.array(share), _INDEX))
    return Glass(f"glazing_{share:.2f}", np.full(3, value), _INDEX)
