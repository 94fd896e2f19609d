"""Conversion of BSDF files to scene geometry, as by Radiance's pkgBSDF.

The layer is in the plane z = 0, centred at the origin, with its room side towards +z
and its up vector along +y. Without geometry in the file, the layer is one rectangle.
With geometry, two rectangles enclose the geometry (proxy geometry) and scatter light by
the BSDF; the geometry is visible and casts sharp shadows.
"""

import numpy as np

from clerestory.array_types import Vector2
from clerestory.bsdf.bsdf import Bsdf
from clerestory.errors import InputError
from clerestory.formats.mgf import parse_mgf
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import BsdfSurface, Polygon, Scene
from clerestory.scene.surface import transformed
from clerestory.scene.transform import Transform

# Distance of the enclosing rectangles from the geometry, relative to the thickness
_CLEARANCE = 2e-5

# Maximum outdoor-side reflectance for which the outer rectangle is omitted
_NO_REFLECTION = 1e-3


def layer_geometry(bsdf: Bsdf, *, transform: Transform | None = None) -> Scene:
    """Return the geometry contained in a BSDF file; an empty scene if there is none."""
    geometry = bsdf.product.geometry
    if geometry is None:
        return Scene()
    metre = Transform(np.diag([geometry.metres] * 3 + [1.0]), geometry.metres)
    place, text = metre.then(transform or Transform()), geometry.text
    return parse_mgf(text, file=bsdf.source, line=geometry.line, transform=place)


def package(bsdf: Bsdf, name: str, *, transform: Transform | None = None) -> Scene:
    """Return rectangles with the BSDF of a layer, and the layer's geometry if any.

    `name` is the prefix of the names of surfaces and materials; `transform` converts
    BSDF coordinates to scene coordinates.
    """
    product, place = bsdf.product, transform or Transform()
    if not (product.width and product.height):
        missing = "the BSDF file has no width and height of the layer; both expected"
        raise InputError(missing, file=bsdf.source)
    half = np.array([product.width, product.height]) / 2
    depth = product.thickness or 0.0
    if product.geometry is None or depth == 0:
        face = _face(bsdf, name, half, 0.0, 0.0, place)
        return face + layer_geometry(bsdf, transform=place)
    thickness = depth * (1 + 2 * _CLEARANCE)
    scene = _face(bsdf, f"{name}_f", half, thickness, depth * _CLEARANCE, place)
    part = bsdf.functions.get(("visible", "reflection_front"))
    incident = klems("full").centres() * [-1, -1, 1]
    if part and part.hemispherical(incident).max() > _NO_REFLECTION:
        behind = -depth * (1 + _CLEARANCE)
        scene = scene + _face(bsdf, f"{name}_b", half, -thickness, behind, place)
    return scene + layer_geometry(bsdf, transform=place)


def _face(
    bsdf: Bsdf, name: str, half: Vector2, thickness: float, z: float, place: Transform
) -> Scene:
    # A rectangle at the given z, facing +z
    depth, up = thickness * place.scale, np.array([0.0, 1.0, 0.0])
    turn = place.matrix[:3, :3] / place.scale
    material = BsdfSurface(f"m_{name}", bsdf, depth, up, turn)
    corner = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]) * half
    vertices = np.column_stack([corner, np.full(4, z)])
    polygon = transformed(Polygon(vertices, material.name, name), place)
    return Scene({material.name: material}, (polygon,))
