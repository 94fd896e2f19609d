"""Plausibility checks of the geometry of a shading system.

Findings are warnings, except for a system that is entirely in the room, which is an
error.
"""

from collections.abc import Iterator

import numpy as np

from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.closed_solids import open_solids
from clerestory.bsdfgen.coplanar_overlaps import overlapping
from clerestory.bsdfgen.naming import item
from clerestory.errors import InputError
from clerestory.scene.model import Scene
from clerestory.scene.surface import extent

# Largest z of surfaces [m], as in genBSDF.
_IN_ROOM = 1e-5

# Largest thickness, largest and smallest width of plausible systems in metres.
_THICKEST, _WIDEST, _NARROWEST = 1.5, 60.0, 2e-5

# Largest distance behind z = 0 as a share of the size, as in genBSDF.
_FAR_BEHIND = 0.1


def check_system(scene: Scene, area: SampleArea) -> tuple[str, ...]:
    """Return warnings about a system, with the surface and its line.

    Detects surfaces in the room, systems far behind z = 0, units other than metres,
    open or inverted dielectric solids, and overlapping coplanar surfaces.

    >>> from clerestory.scene.model import Plastic, Polygon
    >>> corner = np.array([[0, 0, 0.01], [1, 0, -0.1], [0, 1, -0.1]])
    >>> slat = Polygon(corner, "grey", "slat")
    >>> scene = Scene({"grey": Plastic("grey", np.full(3, 0.5))}, (slat,))
    >>> check_system(scene, SampleArea(scene.bounds()))[0]
    'polygon "slat" reaches 10 mm into the room; nothing at z > 0 expected'
    """
    if not scene.surfaces:
        return ()
    low, high = scene.bounds()
    if low[2] >= 0 and high[2] > _IN_ROOM:
        raise InputError(
            f"all surfaces lie in the room, from z = {low[2]:.4g} m up; a system behind"
            " z = 0, with z pointing into the room, expected"
        )
    return (
        *_units(scene),
        *_in_room(scene),
        *_far_behind(area),
        *open_solids(scene, area),
        *overlapping(scene),
    )


def _units(scene: Scene) -> Iterator[str]:
    width, height, depth = np.ptp(scene.bounds(), axis=0)
    if depth > _THICKEST or max(width, height) > _WIDEST:
        yield (
            f"the system is {width:.4g} m wide, {height:.4g} m high and {depth:.4g} m"
            " deep; is it in millimetres? `!xform -s 0.001` scales"
        )
    elif max(width, height) < _NARROWEST:
        yield (
            f"the system is {width:.4g} m wide and {height:.4g} m high;"
            " is it in metres?"
        )


def _in_room(scene: Scene) -> Iterator[str]:
    high = np.array([extent(surface)[:, 2].max() for surface in scene.surfaces])
    inside = np.flatnonzero(high > _IN_ROOM)
    if len(inside):
        worst = scene.surfaces[int(inside[np.argmax(high[inside])])]
        more = f", as do {len(inside) - 1} more" if len(inside) > 1 else ""
        yield (
            f"{item(worst)} reaches {high.max() * 1e3:.3g} mm into the room{more};"
            " nothing at z > 0 expected"
        )


def _far_behind(area: SampleArea) -> Iterator[str]:
    width, height, _ = area.size
    gap = -float(area.bounds[1, 2])
    if gap > _FAR_BEHIND * np.sqrt(width * height):
        yield (
            f"the system ends {gap:.4g} m behind z = 0, where the BSDF stands;"
            " less than a tenth of its size expected"
        )
