"""Panes of windows, doors and curtain walls in IFC files.

Glass is found by surface style: its transparency or name. In windows without such a
style, thin plates are panes; in windows that are a box or only an opening, the outline.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.formats.building_model import seamed
from clerestory.formats.ifc_process import Mesh, Product, Style
from clerestory.formats.triangle_outlines import (
    area_normals,
    connected_parts,
    extents,
    outlines,
)

# Transparency of the style from which a surface is glass
_TRANSPARENT = 0.3

# Words for glass, and for insulation made of it
_GLASS = re.compile(
    r"gla[sz]|verre|vetro|vidrio|vidro|cristal|szkł|lasi\b|玻璃|ガラス", re.I
)
_WOOL = re.compile(r"woo?l|fib|foam|schaum|laine|lana|lã|isol|insul|dämm", re.I)

# Linear members, to which programs give the style of the panes between them
_STRUCTURE = ("IfcMember", "IfcBeam", "IfcColumn")

# Largest distance between parallel panes of one glazing [m]
_GAP = 0.1

# Least cosine between the normals of a pane and of its large faces
_FACING = 0.9

# Panes without a style: largest thickness, least height [m], least fraction of their
# bounding rectangle, and of the area of the largest plate
_THICK, _HIGH, _FILLED, _SHARE = 0.06, 0.1, 0.8, 0.1

Found = Literal["style", "shape", "outline", "opening"]


@final
@dataclass(frozen=True, eq=False)
class Glazing:
    """The panes of a product.

    Attributes
    ----------
    panes : outline of each pane [m]
    frames : outlines of opaque surfaces around panes that replace the triangles [m]
    opaque : whether each triangle remains as an opaque surface
    found : how the panes were found
    style : name of the style of the glass
    """

    panes: tuple[Float[np.ndarray, "_ 3"], ...]
    frames: tuple[Float[np.ndarray, "_ 3"], ...]
    opaque: Bool[np.ndarray, " triangle"]
    found: Found
    style: str = ""


def glazing_of(mesh: Mesh) -> Glazing | None:
    """Return the panes of a product; None without glass.

    Mullions, beams and columns are opaque, whatever their style.
    """
    if mesh.product.kind in _STRUCTURE:
        return None
    if mesh.product.opening:
        return _outline(mesh, "opening")
    clear = _glass_triangles(mesh)
    if clear.any():
        names = {_style(mesh.product, number).name for number in mesh.style[clear]}
        return Glazing(_panes(mesh, clear), (), ~clear, "style", min(names))
    if mesh.product.kind != "IfcWindow":
        return None
    return _plates(mesh) or _outline(mesh, "outline")


def is_glass(name: str) -> bool:
    """Whether the name of a material or style is that of glass.

    >>> [is_glass(name) for name in ("Clear glazing", "Vidrio", "Glass wool", "Oak")]
    [True, True, False, False]
    """
    return bool(_GLASS.search(name)) and not _WOOL.search(name)


def _glass_triangles(mesh: Mesh) -> Bool[np.ndarray, " triangle"]:
    product = mesh.product
    numbers = range(-1, max(len(product.styles), int(mesh.style.max()) + 1))
    known = {n: _is_clear(_style(product, n)) for n in numbers}
    clear = np.array([known[int(n)] for n in mesh.style], dtype=bool)
    named = [is_glass(name) for name in product.materials]
    unnamed = not any(style.name for style in product.styles)
    if product.kind == "IfcPlate" and unnamed and named and all(named):
        clear[:] = True
    return clear


def _style(product: Product, number: int) -> Style:
    return product.styles[number] if 0 <= number < len(product.styles) else Style()


def _is_clear(style: Style) -> bool:
    return style.transparency >= _TRANSPARENT or is_glass(style.name)


def _panes(
    mesh: Mesh, clear: Bool[np.ndarray, " triangle"]
) -> tuple[Float[np.ndarray, "_ 3"], ...]:
    # Outlines of glass, without the narrow faces around flat plates
    kept = np.zeros(len(clear), dtype=bool)
    for plate in _connected(mesh, clear):
        area = area_normals(mesh.vertices[mesh.faces[plate]])
        normal, size = extents(_points(mesh, plate), area)
        facing = np.abs(area @ normal) > _FACING * np.linalg.norm(area, axis=1)
        kept[plate] = facing | (size[0] > _GAP)
    return tuple(outlines(mesh.vertices[mesh.faces[kept]], gap=_GAP))


def _plates(mesh: Mesh) -> Glazing | None:
    # Connected surfaces that are thin, filled and not small are panes
    found, areas = [], []
    for plate in _connected(mesh, np.ones(len(mesh.faces), dtype=bool)):
        area = area_normals(mesh.vertices[mesh.faces[plate]])
        normal, (thick, high, wide) = extents(_points(mesh, plate), area)
        facing = float(np.abs(area @ normal).sum() / 2)
        if thick <= _THICK and high >= _HIGH and facing >= _FILLED * high * wide:
            found.append(plate)
            areas.append(facing)
    clear = np.zeros(len(mesh.faces), dtype=bool)
    for plate, area_m2 in zip(found, areas, strict=True):
        clear[plate] = area_m2 >= _SHARE * max(areas)
    if not clear.any():
        return None
    return Glazing(_panes(mesh, clear), (), ~clear, "shape")


def _outline(mesh: Mesh, found: Found) -> Glazing | None:
    # The outline of a box; its opaque part is given by the fraction of glazing
    corners = mesh.vertices[mesh.faces]
    area = area_normals(corners)
    _, _, axes = np.linalg.svd(mesh.vertices - mesh.vertices.mean(axis=0))
    normal = axes[-1]
    facing = np.abs(area @ normal) > _FACING * np.linalg.norm(area, axis=1)
    whole = outlines(corners[facing], gap=float(np.ptp(mesh.vertices @ normal)) + _GAP)
    opaque = np.zeros(len(mesh.faces), dtype=bool)
    share = mesh.product.numbers.get("GlazingAreaFraction", 1.0)
    if not 0 < share < 1:
        return Glazing(tuple(whole), (), opaque, found) if whole else None
    panes = [_shrunk(outline, share) for outline in whole]
    frames = [
        seamed([outline, pane]) for outline, pane in zip(whole, panes, strict=True)
    ]
    return Glazing(tuple(panes), tuple(frames), opaque, found) if whole else None


def _shrunk(
    outline: Float[np.ndarray, "point 3"], share: float
) -> Float[np.ndarray, "point 3"]:
    middle = outline.mean(axis=0)
    return np.asarray(middle + np.sqrt(share) * (outline - middle))


def _connected(
    mesh: Mesh, chosen: Bool[np.ndarray, " triangle"]
) -> Iterator[Int[np.ndarray, " some"]]:
    # Triangles of each connected surface among the chosen triangles
    index = np.flatnonzero(chosen)
    number = connected_parts(mesh.faces[index], mesh.part[index])
    for each in range(int(number.max(initial=-1)) + 1):
        yield index[number == each]


def _points(
    mesh: Mesh, triangles: Int[np.ndarray, " some"]
) -> Float[np.ndarray, "point 3"]:
    return np.asarray(mesh.vertices[np.unique(mesh.faces[triangles])])
