"""Reader of IFC models: scene with glass, floors of spaces, north and site.

Reference: ISO 16739-1, Industry Foundation Classes; read by ifcopenshell.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.formats.building_model import BuildingModel, RoomFloor, SitePosition
from clerestory.formats.ifc_glazing import Found, Glazing, glazing_of
from clerestory.formats.ifc_materials import Materials
from clerestory.formats.ifc_process import Content, Mesh, Product, read_products
from clerestory.formats.triangle_outlines import area_normals, lowest, outlines
from clerestory.scene.model import (
    Material,
    Polygon,
    Scene,
    Surface,
    TriangleMesh,
    insert_material,
)
from clerestory.scene.surface import area_vector

# Distance from the origin beyond which a model is moved, and farthest corner then [m]
_FARTHEST = 10_000.0

# Floors of a space: sine of the steepest, distance of levels that are one [m], and
# height [m] and fraction of area of a sill, which is not a floor
_STEEP, _LEVEL, _SILL, _SMALL = 0.5, 0.05, 0.3, 0.1

_HOW: dict[Found, str] = {
    "shape": "panes: thin plates, as no style is glass",
    "outline": "pane: the outline, as there are neither glass nor thin plates",
    "opening": "pane: the outline of the opening, as the window has no shape",
}


def read_ifc(
    path: str | Path,
    *,
    materials: Mapping[str, Material] | None = None,
    seconds: float | None = None,
) -> BuildingModel:
    """Read an IFC model (`.ifc`, schemas IFC2X3, IFC4 and IFC4X3), in metres.

    Panes become single surfaces of glass in the mean plane of their sheets; frames and
    all other elements are opaque. The floors of spaces are read for sensor grids.

    Parameters
    ----------
    materials : materials by name of surface style, IFC material or class, such as
        `IfcWall`; "*" for all other opaque surfaces. Others: reflectances of IES LM-83;
        visible transmittance of property sets, else 0.64
    seconds : time limit of reading [s]; None: a minute, and a minute for each megabyte

    Raises
    ------
    InputError : the file is damaged, has no element with surfaces, or extends over more
        than 10 km
    ClerestoryError : ifcopenshell is not installed

    Examples
    --------
    >>> read_ifc("missing.ifc")
    Traceback (most recent call last):
    clerestory.errors.InputError: missing.ifc: cannot be read: No such file or directory
    """
    found = read_products(path, seconds=seconds)
    message = "no element with surfaces; walls, slabs or windows expected"
    solid = [mesh for mesh in found.meshes if mesh.product.kind != "IfcSpace"]
    require(solid, message, file=path)
    offset = _offset(found.meshes)
    meshes = [_placed(mesh, offset, path) for mesh in found.meshes]
    reading = _Reading(materials or {})
    for mesh in meshes:
        if mesh.product.kind != "IfcSpace":
            reading.element(mesh)
    content = found.content
    return BuildingModel(
        name=content.name or Path(path).stem,
        scene=Scene(reading.used, tuple(reading.surfaces)),
        windows=(),
        grids={},
        labels={},
        rooms=tuple(_floor(m) for m in meshes if m.product.kind == "IfcSpace"),
        views={},
        unsupported=tuple(_bare(content)),
        assumptions=(*_position(content, offset), *reading.assumptions()),
        north_deg=_north_deg(content),
        site=_site(content),
    )


class _Reading:
    # Surfaces and materials of elements, and what was assumed
    def __init__(self, given: Mapping[str, Material]) -> None:
        self.materials = Materials(given)
        self.used: dict[str, Material] = {}
        self.surfaces: list[Surface] = []
        self.notes: list[str] = []

    def element(self, mesh: Mesh) -> None:
        """Add the surfaces of an element."""
        product, glazing = mesh.product, glazing_of(mesh)
        opaque = np.arange(len(mesh.faces))
        if glazing is not None:
            opaque = opaque[glazing.opaque]
            self.glazing(product, glazing)
        for material, triangles in self.materials.opaque(mesh, opaque):
            index, place = np.unique(mesh.faces[triangles], return_inverse=True)
            faces, key = place.reshape(-1, 3), insert_material(self.used, material)
            kept = TriangleMesh(mesh.vertices[index], faces, key, _label(product))
            self.surfaces.append(kept)

    def glazing(self, product: Product, glazing: Glazing) -> None:
        """Add the panes of an element, and frames that replace its triangles."""
        key = insert_material(self.used, self.materials.glass(product, glazing))
        label = _label(product)
        self.surfaces += [Polygon(pane, key, label) for pane in glazing.panes]
        if glazing.frames:
            key = insert_material(self.used, self.materials.frame(product))
            self.surfaces += [Polygon(frame, key, label) for frame in glazing.frames]
        if glazing.found in _HOW:
            self.notes.append(f"{_named(product)}: {_HOW[glazing.found]}")

    def assumptions(self) -> tuple[str, ...]:
        """Return descriptions of the assumed values."""
        return (*self.materials.assumptions(), *self.notes)


def _offset(meshes: tuple[Mesh, ...]) -> Vector:
    # Position, in whole metres, that becomes the origin if the model is far from it
    centres = np.array([mesh.vertices.mean(axis=0) for mesh in meshes])
    middle = np.round(np.median(centres, axis=0))
    return middle if np.abs(middle).max() > _FARTHEST / 2 else np.zeros(3)


def _placed(mesh: Mesh, offset: Vector, path: str | Path) -> Mesh:
    # Move a mesh, orient its triangles outwards and drop those without area
    vertices = mesh.vertices - offset
    farthest = float(np.abs(vertices).max())
    message = (
        f"{_named(mesh.product)} is {farthest / 1000:.4g} km from the other elements;"
        f" at most {_FARTHEST / 1000:g} km expected"
    )
    require(farthest <= _FARTHEST, message, file=path)
    corners = vertices[mesh.faces]
    area = area_normals(corners)
    inwards = np.einsum("ij,ij->", corners.mean(axis=1) - vertices.mean(axis=0), area)
    faces = mesh.faces[:, ::-1] if inwards < 0 else mesh.faces
    good = np.any(area != 0, axis=1)
    return replace(
        mesh,
        vertices=vertices,
        faces=faces[good],
        style=mesh.style[good],
        part=mesh.part[good],
    )


def _floor(mesh: Mesh) -> RoomFloor:
    # Lowest faces, without the sills of windows; in some files faces look anywhere
    corners = mesh.vertices[mesh.faces]
    area = area_normals(corners)
    level = corners[np.abs(area[:, 2]) > _STEEP * np.linalg.norm(area, axis=1)]
    chosen = level[lowest(level, gap=_LEVEL)]
    floors = outlines(chosen, gap=_LEVEL)
    areas = [abs(area_vector(outline)[2]) for outline in floors]
    bottom = min((outline[:, 2].min() for outline in floors), default=0.0)
    kept = tuple(
        outline
        for outline, each in zip(floors, areas, strict=True)
        if outline[:, 2].min() <= bottom + _SILL or each >= _SMALL * max(areas)
    )
    top = float(mesh.vertices[:, 2].max())
    return RoomFloor(mesh.product.guid, _space(mesh.product), kept, top)


def _space(product: Product) -> str:
    # Number and name of a space
    parts = dict.fromkeys(filter(None, (product.name, product.long_name)))
    return " ".join(parts) or product.guid


def _label(product: Product) -> str:
    return product.name or product.guid


def _named(product: Product) -> str:
    return f'{product.kind} "{_label(product)}"'


def _bare(content: Content) -> Iterator[str]:
    for product in content.without_surfaces:
        yield f"{_named(product)}: its geometry has no surfaces"


def _north_deg(content: Content) -> float:
    # Angle from +y to north, counter-clockwise
    if content.north is None or not any(content.north):
        return 0.0
    x, y = content.north
    return round(float(np.degrees(np.arctan2(-x, y))), 6) + 0.0


def _site(content: Content) -> SitePosition | None:
    if content.site is None:
        return None
    return SitePosition(content.site.latitude_deg, content.site.longitude_deg)


def _position(content: Content, offset: Vector) -> Iterator[str]:
    if content.north is None:
        yield "north: the direction +y, as the file has none"
    if offset.any():
        x, y, z = (float(value) for value in offset)
        yield f"origin of the scene: ({x:.0f}, {y:.0f}, {z:.0f}) m of the model"
    if not any(product.kind == "IfcSpace" for product in content.products):
        yield "no spaces: add sensors to the study"
