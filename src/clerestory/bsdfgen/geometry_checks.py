"""Plausibility checks of the geometry of a shading system.

Surfaces are checked for position, length unit and coplanar overlaps. Dielectric solids
are checked for open edges and inward normals. All findings are warnings, except that
systems entirely on the room side of z = 0 and solids turned inside out are errors.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.coplanar import overlapping_pairs
from clerestory.scene.model import Dielectric, Interface, Scene
from clerestory.scene.surface import extent, surface_label
from clerestory.scene.tessellate import Mesh, meshes

# Largest z of surfaces without a warning [m], as in genBSDF.
_IN_ROOM = 1e-5

# Largest thickness, largest width and smallest width of a plausible system [m].
_THICKEST, _WIDEST, _NARROWEST = 1.5, 60.0, 2e-5

# Largest distance of a system from z = 0, relative to the system size (genBSDF).
_FAR_BEHIND = 0.1


def check_system(scene: Scene, area: SampleArea) -> tuple[str, ...]:
    """Return warnings about a system; they name a surface and line where possible.

    Checks for surfaces at z > 0, systems far behind z = 0, units other than metres,
    open dielectric solids, and overlapping coplanar surfaces.

    Raises
    ------
    InputError : all surfaces are in the room, or a dielectric solid is inside out
    """
    if not scene.surfaces:
        return ()
    low, high = scene.bounds()
    require(
        low[2] < 0 or high[2] <= _IN_ROOM,
        f"all surfaces lie in the room, at z ≥ {low[2]:.4g} m; a system at z ≤ 0,"
        " with z pointing into the room, expected",
    )
    return (
        *_units(scene),
        *_in_room(scene),
        *_far_behind(area),
        *check_solids(scene, area),
        *check_overlaps(scene),
    )


def _units(scene: Scene) -> Iterator[str]:
    width, height, depth = np.ptp(scene.bounds(), axis=0)
    if depth > _THICKEST or max(width, height) > _WIDEST:
        yield (
            f"the system is {width:.4g} m wide, {height:.4g} m high and {depth:.4g} m"
            " deep; if it is in millimetres, scale it with `!xform -s 0.001`"
        )
    elif max(width, height) < _NARROWEST:
        yield (
            f"the system is {width:.4g} m wide and {height:.4g} m high;"
            " coordinates in metres expected"
        )


def _in_room(scene: Scene) -> Iterator[str]:
    high = np.array([extent(surface)[:, 2].max() for surface in scene.surfaces])
    inside = np.flatnonzero(high > _IN_ROOM)
    if len(inside):
        worst = scene.surfaces[int(inside[np.argmax(high[inside])])]
        more = f", as do {len(inside) - 1} more" if len(inside) > 1 else ""
        yield (
            f"{surface_label(worst)} reaches {high.max() * 1e3:.3g} mm into the"
            f" room{more}; nothing at z > 0 expected"
        )


def _far_behind(area: SampleArea) -> Iterator[str]:
    width, height, _ = area.size
    gap = -float(area.bounds[1, 2])
    if gap > _FAR_BEHIND * np.sqrt(width * height):
        yield (
            f"the system ends {gap:.4g} m behind z = 0, the plane of the BSDF;"
            " less than a tenth of its size expected"
        )


# Tolerance for coplanarity and for overlaps at common edges, relative to the size of
# the system.
_SAME = 1e-6


def check_overlaps(scene: Scene) -> Iterator[str]:
    """Yield one warning about overlapping coplanar surfaces, for the first pair."""
    parts = meshes(scene)
    corner = np.concatenate([m.vertices[m.faces] for m in parts])
    surface = np.concatenate([m.surface for m in parts])
    size = float(np.ptp(corner.reshape(-1, 3), axis=0).max())
    found = overlapping_pairs(corner, surface, _SAME * size)
    if not len(found):
        return
    both = np.unique(np.sort(surface[found], axis=1), axis=0)
    one, other = (surface_label(scene.surfaces[int(i)]) for i in both[0])
    more = f"; {len(both) - 1} more such pairs" if len(both) > 1 else ""
    yield (
        f"{one} and {other} are coplanar and overlap{more}; surfaces without overlap"
        " expected"
    )


def check_solids(scene: Scene, area: SampleArea) -> Iterator[str]:
    """Yield warnings about dielectric solids with open edges; refuse inward normals.

    Each edge of a solid belongs to two faces that traverse it in opposite directions.
    Open edges on the sides of a periodic unit cell are allowed.
    """
    for mesh in meshes(scene):
        if not isinstance(mesh.material, Dielectric | Interface):
            continue
        corner, faces = _welded(mesh, _SAME * float(np.ptp(area.bounds, axis=0).max()))
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        lone = _lone(edges)
        if area.periodic:
            lone &= ~_in_sides(corner[edges], area)
        name = f'{type(mesh.material).__name__.lower()} "{mesh.material.name}"'
        if lone.any():
            owner = np.tile(mesh.surface, 3)[lone]
            surface = surface_label(scene.surfaces[int(owner[0])])
            yield (
                f"{surface} has an open edge: {name} does not enclose a solid"
                f" ({int(lone.sum())} edges without a second face); closed surfaces"
                " with outward normals expected"
            )
            continue
        inverted = _inverted(corner, faces)
        if inverted.any():
            surface = surface_label(scene.surfaces[int(mesh.surface[inverted][0])])
            raise InputError(
                f"{surface}: {name} is inside out, its fronts face the inside of the"
                " solid; faces with outward normals expected"
            )


def _welded(
    mesh: Mesh, distance: float
) -> tuple[Float[np.ndarray, "corner 3"], Int[np.ndarray, "face 3"]]:
    place = np.round(mesh.vertices / max(distance, 1e-12)).astype(np.int64)
    _, first, which = np.unique(place, axis=0, return_index=True, return_inverse=True)
    faces = which.ravel()[mesh.faces]
    solid = np.all(faces != np.roll(faces, 1, axis=1), axis=1)
    return mesh.vertices[first], np.where(solid[:, None], faces, 0)


def _lone(edges: Int[np.ndarray, "edge 2"]) -> Bool[np.ndarray, " edge"]:
    # Edges that are not traversed equally often in both directions
    start, end = edges.T
    count = int(edges.max()) + 1
    forth = coo_array((np.ones(len(edges), int), (start, end)), shape=(count, count))
    return np.asarray((forth - forth.T).tocsr()[start, end] != 0)


def _in_sides(
    ends: Float[np.ndarray, "edge 2 3"], area: SampleArea
) -> Bool[np.ndarray, " edge"]:
    # Edges on or outside the sides of the unit cell
    near = _SAME * float(area.size.max())
    low, high = area.bounds[0, :2] + near, area.bounds[1, :2] - near
    beyond = np.concatenate([ends[..., :2] <= low, ends[..., :2] >= high], axis=-1)
    return np.asarray(beyond.all(axis=1).any(axis=-1))


def _inverted(
    corner: Float[np.ndarray, "corner 3"], faces: Int[np.ndarray, "face 3"]
) -> Bool[np.ndarray, " face"]:
    # Faces of solids with inward normals. Volumes are computed by Gauss's theorem for
    # the field (0, 0, z), to which vertical faces contribute zero
    count = len(corner)
    joined = np.concatenate([faces[:, :2], faces[:, 1:]])
    links = coo_array((np.ones(len(joined)), tuple(joined.T)), shape=(count, count))
    _, label = connected_components(links, directed=False)
    solid = label[faces[:, 0]]
    a, b, c = np.moveaxis(corner[faces] - corner.mean(axis=0), 1, 0)
    upwards = np.cross(b - a, c - a)[:, 2] / 2
    volume = np.bincount(solid, upwards * (a + b + c)[:, 2] / 3, minlength=count)

    # Cavities within another solid have inward normals
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, label, corner)
    np.maximum.at(high, label, corner)
    outer = np.flatnonzero(volume > 0)
    for part in np.flatnonzero(volume < 0):
        within = np.all((low[outer] < low[part]) & (high[outer] > high[part]), axis=1)
        volume[part] *= -1 if within.any() else 1
    return np.asarray(volume[solid] < 0)
