"""Panes of windows among the surfaces of a scene, by the names of their materials.

Models that are exported as a whole contain the glazing that window groups replace.
"""

from collections.abc import Sequence
from dataclasses import replace

from clerestory.checks import require
from clerestory.scene.material import error_at
from clerestory.scene.model import Scene
from clerestory.scene.surface import Polygon


def without_glazing(scene: Scene, materials: Sequence[str]) -> Scene:
    """Return the scene without the surfaces of some materials.

    Raises
    ------
    InputError : no surface has one of the materials
    """
    if not materials:
        return scene
    _require_panes(scene, materials)
    kept = tuple(s for s in scene.surfaces if s.material not in materials)
    return replace(scene, surfaces=kept)


def glazing_panes(scene: Scene, materials: Sequence[str]) -> dict[str, list[Polygon]]:
    """Return the polygons of the panes by material.

    Raises
    ------
    InputError : no surface has one of the materials, or one is not a polygon
    """
    _require_panes(scene, materials)
    found: dict[str, list[Polygon]] = {name: [] for name in materials}
    for surface in scene.surfaces:
        if surface.material not in found:
            continue
        if not isinstance(surface, Polygon):
            kind = type(surface).__name__.lower()
            raise error_at(
                getattr(surface, "source", None),
                f'the glazing "{surface.material}" has surfaces of type {kind};'
                " polygons expected",
            )
        found[surface.material].append(surface)
    return found


def _require_panes(scene: Scene, materials: Sequence[str]) -> None:
    used = sorted({surface.material for surface in scene.surfaces})
    for name in materials:
        require(
            name in used,
            f'no surface of the scene is made of the glazing "{name}"; one of'
            f" {', '.join(used[:20])} expected",
        )
