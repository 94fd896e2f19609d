"""What looks wrong with a system before it is traced, one line for each finding.

The findings are doubts, not errors, but for one: a system that lies wholly in the room.
"""

from collections.abc import Iterator

import numpy as np

from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.closed_solids import open_solids
from clerestory.bsdfgen.coplanar_overlaps import overlapping
from clerestory.bsdfgen.naming import item
from clerestory.errors import InputError
from clerestory.scene.model import Scene

# Beyond z = 0 by more than this is in the room [m], as in genBSDF.
_IN_ROOM = 1e-5

# Systems thicker than this are hardly in metres, and thinner ones hardly either [m].
_THICKEST, _WIDEST, _NARROWEST = 1.5, 60.0, 2e-5

# A system this share of its width behind the plane z = 0 is misplaced, as in genBSDF.
_FAR_BEHIND = 0.1


def check_system(scene: Scene, area: SampleArea) -> tuple[str, ...]:
    """Return what looks wrong with a system, naming the item and its line.

    Looks for surfaces in the room, systems far behind the plane z = 0, units other
    than metres, dielectrics that do not enclose a solid or are inside out, and
    surfaces that lie in each other.

    Raises
    ------
    InputError : all of it is in the room

    Examples
    --------
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
    high = np.array(
        [Scene(scene.materials, (s,)).bounds()[1, 2] for s in scene.surfaces]
    )
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
