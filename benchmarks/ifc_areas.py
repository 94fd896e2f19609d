"""Areas of spaces and windows of IFC models, against ifcopenshell's and the file's own.

    python benchmarks/ifc_areas.py FILE... --write docs/benchmarks/ifc-areas.md

FILE is an IFC model, such as AC20-FZK-Haus.ifc of KIT (in imlerith01/Utilities on
GitHub) and Duplex_A_20110907.ifc of buildingSMART (in compas-dev/compas_ifc). The
separate area of a space is that of its body as seen from above; that of glass, of the
triangles with a transparent style, and that of a window, of all its triangles, as seen
along the normal of the pane (triangles by ifcopenshell, unions by shapely).
"""

import argparse
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import ifcopenshell
import numpy as np
from duel import stamp
from ifcopenshell.geom import create_shape, settings
from ifcopenshell.util.element import get_psets
from ifcopenshell.util.shape import get_faces, get_vertices
from shapely import Polygon as Outline
from shapely.ops import unary_union

import clerestory as cl
from clerestory.formats.building_model import BuildingModel
from clerestory.scene.model import Polygon, TriangleMesh
from clerestory.scene.surface import area_vector


@dataclass(frozen=True)
class Area:
    """Area of a space, of glass or of a window: ours, the separate one, and stated."""

    kind: str
    name: str
    ours: float
    separate: float
    stated: float | None

    def deviation(self, other: float | None) -> float | None:
        """Return the deviation of ours [%]."""
        return 100 * (self.ours / other - 1) if other else None


def shadow(polygons: Iterable[np.ndarray], normal: np.ndarray) -> float:
    """Return the area of polygons (corner, xyz) as seen along a normal."""
    side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    side /= np.linalg.norm(side)
    plane = np.stack([side, np.cross(normal, side)], axis=1)
    flat = [Outline(each @ plane).buffer(0) for each in polygons]
    return float(unary_union(flat).area)


def triangles(element, using) -> tuple[np.ndarray, np.ndarray]:
    """Return the triangles of an element, and which have a transparent style."""
    geometry = create_shape(using, element).geometry
    clear = np.array(
        [m.transparency > 0 or "glas" in m.name.lower() for m in geometry.materials]
    )
    corners = get_vertices(geometry)[get_faces(geometry)]
    style = np.array(geometry.material_ids)
    return corners, (style >= 0) & clear[style] if len(clear) else style > 0


def stated(element) -> float | None:
    """Return the area of a space by the file: of its floor, or volume over height.

    Areas by Revit extend to the middle of the walls, its volumes do not.
    """
    known = {k: v for each in get_psets(element).values() for k, v in each.items()}
    if "GrossFloorArea" in known:
        return float(known["GrossFloorArea"])
    if "Volume" in known and known.get("Unbounded Height"):
        return float(known["Volume"] / known["Unbounded Height"])
    return None


def spaces(model, using, read: BuildingModel) -> Iterator[Area]:
    """Yield the areas of the floors of spaces."""
    rooms = {room.identifier: room for room in read.rooms}
    for element in model.by_type("IfcSpace"):
        room, up = rooms[element.GlobalId], np.array([0.0, 0, 1])
        ours = sum(abs(area_vector(outline)[2]) for outline in room.outlines)
        below = shadow(triangles(element, using)[0], up)
        yield Area("space", room.name, ours, below, stated(element))


def windows(model, using, read: BuildingModel) -> Iterator[Area]:
    """Yield the areas of glass, and of windows with their frames."""
    for element in (*model.by_type("IfcWindow"), *model.by_type("IfcDoor")):
        name = element.Name or element.GlobalId
        own = [each for each in read.scene.surfaces if each.name == name]
        panes = [
            each.vertices
            for each in own
            if isinstance(each, Polygon)
            and hasattr(read.scene.materials[each.material], "transmissivity")
        ]
        if not panes:
            continue
        normal = sum(area_vector(pane) for pane in panes)
        normal = normal / np.linalg.norm(normal)
        corners, clear = triangles(element, using)
        glass = sum(abs(area_vector(pane) @ normal) for pane in panes)
        # A style that is on the frame as well does not tell where the glass is
        if clear.any() and not clear.all():
            yield Area("glass", name, glass, shadow(corners[clear], normal), None)
        if element.is_a("IfcWindow"):
            frames = (m.vertices[m.faces] for m in own if isinstance(m, TriangleMesh))
            ours = shadow([*panes, *chain.from_iterable(frames)], normal)
            size = element.OverallWidth, element.OverallHeight
            area = float(np.prod(size)) if all(size) else None
            yield Area("window", name, ours, shadow(corners, normal), area)


def areas(path: Path) -> list[Area]:
    """Return all areas of a file."""
    model, using = ifcopenshell.open(path), settings()
    using.set("use-world-coords", True)
    read = cl.read_ifc(path)
    return [*spaces(model, using, read), *windows(model, using, read)]


def agreement(deviations: list[float | None]) -> str:
    """Return how many deviate by at most 1 %, and the largest deviation."""
    given = [each for each in deviations if each is not None]
    if not given:
        return "not stated"
    close = sum(abs(each) <= 1 for each in given)
    most = round(max(given, key=abs), 2) + 0.0
    return f"{close} of {len(given)}; {most:+.2f} %"


def main() -> None:
    """Compare the areas of files and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    lines, rooms = [], []
    for path in given.files:
        found = areas(path)
        for kind in ("space", "glass", "window"):
            some = [each for each in found if each.kind == kind]
            total = sum(each.ours for each in some)
            separate = agreement([each.deviation(each.separate) for each in some])
            own = agreement([each.deviation(each.stated) for each in some])
            lines.append(
                f"| {path.name} | {kind} | {len(some)} | {total:.2f} | {separate} |"
                f" {own} |"
            )
        for each in found:
            sys.stderr.write(f"{path.name} {each}\n")
            if each.kind == "space":
                known = f"{each.stated:.3f}" if each.stated else ""
                name = re.sub(r"[|\\]", " ", each.name)
                rooms.append(
                    f"| {path.name} | {name} | {each.ours:.3f} | {each.separate:.3f} |"
                    f" {known} |"
                )
    page = f"""# Areas of IFC models

Areas of floors of spaces, of glass, and of windows with their frames as
`clerestory import` reads them (`benchmarks/ifc_areas.py`). *Separate* areas are those
of the triangles of ifcopenshell as seen from above or along the normal of the pane,
united by shapely. *Stated* areas are those of the file: the gross floor area of spaces,
or of Revit, whose areas extend into the walls, the volume over the height; width times
height of windows. Deviations are of single spaces and windows. Volume over height is
not the area of stairs and of a hall with a higher ceiling, nor width times height that
of round windows and of tilted skylights; glass whose style is also that of the frame is
left out.

{stamp()}.

| file | area of | number | sum [m²] | within 1 % of separate; largest | of stated |
|---|---|---|---|---|---|
{chr(10).join(lines)}

| file | space | here [m²] | separate [m²] | stated [m²] |
|---|---|---|---|---|
{chr(10).join(rooms)}
"""
    if given.write:
        given.write.write_text(page)
    else:
        sys.stdout.write(page)


if __name__ == "__main__":
    main()
