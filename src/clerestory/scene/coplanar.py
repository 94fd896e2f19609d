"""Overlapping coplanar surfaces, of which rounding decides which one a ray meets.

Triangles are grouped by plane. In each plane, a sweep finds overlapping bounding boxes
of triangles with different labels, and the separating axis test those that overlap.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Vector
from clerestory.scene.model import Material, Scene, Sphere, same_material
from clerestory.scene.proximity import Triangulation, first_hits
from clerestory.scene.surface import surface_label

# Distance below which planes coincide: fraction of the scene's size, and maximum [m]
_SAME, _MOST_APART = 1e-6, 2e-5

# Width of the bins of plane offsets, as a multiple of that distance; not a round
# number, so that planes at round coordinates are not at the limit of two bins
_CLASS = 12.345678

# Number of triangles whose planes are found together
_BLOCK = 100_000

# Largest number of triangle pairs per plane that are tested; further pairs are skipped
_MOST_PAIRS = 4_000_000

# Largest number of pairs of surfaces whose surroundings are examined
_MOST_EXAMINED = 20


def check_coplanar(scene: Scene, triangles: Triangulation) -> Iterator[str]:
    """Yield a warning about coplanar overlapping surfaces of different materials.

    Faces of opposite orientation that touch inside a solid, such as furniture on a
    floor, are no overlap. Spheres have no plane.
    """
    corner, surface = triangles.corner, triangles.surface
    plane = np.array([not isinstance(each, Sphere) for each in scene.surfaces])
    if not plane.all():
        corner, surface = corner[plane[surface]], surface[plane[surface]]
    if not len(corner):
        return
    label = np.array(_material_numbers(scene))[surface]
    low, high = corner.min(axis=(0, 1)), corner.max(axis=(0, 1))
    near = min(_SAME * float((high - low).max()), _MOST_APART)
    found = overlapping_pairs(corner, label, near)
    if not len(found):
        return
    both, first = np.unique(np.sort(surface[found], axis=1), axis=0, return_index=True)
    visible = [
        pair
        for pair, (a, b) in zip(
            both[:_MOST_EXAMINED], found[first[:_MOST_EXAMINED]], strict=True
        )
        if not _in_contact(corner, int(a), int(b), near)
    ]
    if visible:
        one, other = (scene.surfaces[int(i)] for i in visible[0])
        count = len(visible) - 1
        more = f" (and {count} more pairs)" if count else ""
        yield (
            f'{surface_label(one)} of "{one.material}" and {surface_label(other)} of'
            f' "{other.material}" lie in one plane and overlap{more}: rays meet one or'
            " the other at random"
        )


def _material_numbers(scene: Scene) -> list[int]:
    # Number of each surface's material; equal materials have one number
    number: dict[str, int] = {}
    known: dict[object, list[str]] = {}
    for name, material in scene.materials.items():
        group = known.setdefault(_figures(material), [])
        alike = (n for n in group if same_material(material, scene.materials[n]))
        number[name] = number.get(next(alike, ""), len(number))
        group.append(name)
    return [number[surface.material] for surface in scene.surfaces]


def _figures(material: Material) -> tuple[object, ...]:
    # Kind and numbers of a material, by which few of those that differ are alike
    values = vars(material).values()
    numbers = (v for v in values if isinstance(v, float | int | np.ndarray))
    return type(material), *(tuple(np.ravel(v).tolist()) for v in numbers)


def overlapping_pairs(
    corner: Float[np.ndarray, "triangle 3 3"],
    label: Int[np.ndarray, " triangle"],
    near: float,
) -> Int[np.ndarray, "pair 2"]:
    """Return pairs of overlapping triangles in one plane that have different labels.

    Planes coincide, and edges touch, within the distance `near`.
    """
    middle = corner.reshape(-1, 3).mean(axis=0)
    blocks = [
        _keys(corner[first : first + _BLOCK] - middle, max(near, 1e-300))
        for first in range(0, len(corner), _BLOCK)
    ]
    pairs = [
        _pairs(corner[of] - middle, label[of], of, near)
        for of in _planes(np.concatenate(blocks), label)
    ]
    return np.concatenate([np.empty((0, 2), dtype=int), *pairs])


def _keys(
    corner: Float[np.ndarray, "triangle 3 3"], near: float
) -> Int[np.ndarray, " triangle"]:
    # Hash of the rounded normal and offset of each plane; 0 without area
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal /= np.where(length > 0, length, 1)[:, None]
    lead = np.argmax(np.abs(normal) > 1e-6, axis=1)
    normal *= np.sign(normal[np.arange(len(normal)), lead])[:, None]
    offset = np.einsum("tx,tx->t", normal, corner.mean(axis=1))
    x, y, z = np.round(normal * 1e5).astype(np.int64).T
    height = np.round(offset / (_CLASS * near)).astype(np.int64)
    key = ((x * 1_000_003 + y) * 1_000_003 + z) * 2_654_435_761 + height
    return np.asarray(np.where(length > 0, key, 0))


def _planes(
    key: Int[np.ndarray, " triangle"], label: Int[np.ndarray, " triangle"]
) -> Iterator[Int[np.ndarray, " triangle"]]:
    # Triangles of each plane that has more than one label
    order = np.argsort(key, kind="stable")
    order = order[key[order] != 0]
    starts = np.flatnonzero(np.diff(key[order], prepend=key[order][:1] - 1))
    if not len(starts):
        return
    labels = label[order]
    least = np.minimum.reduceat(labels, starts)
    mixed = np.flatnonzero(least != np.maximum.reduceat(labels, starts))
    ends = np.append(starts[1:], len(order))
    for plane in mixed:
        yield order[starts[plane] : ends[plane]]


def _in_contact(
    corner: Float[np.ndarray, "triangle 3 3"], one: int, other: int, near: float
) -> bool:
    # Whether two faces of opposite orientation touch inside a solid
    normal = [_normal(corner[number]) for number in (one, other)]
    if normal[0] @ normal[1] > 0:
        return False
    small = min((one, other), key=lambda n: float(np.linalg.norm(_normal(corner[n]))))
    facing = _normal(corner[small])
    facing = facing / np.linalg.norm(facing)
    # A point inside; the centroid could lie on a diagonal of the opposite rectangle
    middle = np.array([0.47, 0.31, 0.22]) @ corner[small]
    return any(
        _inside(middle + side * 30 * near * facing, side * facing, corner, near)
        for side in (-1, 1)
    )


def _inside(
    point: Vector, along: Vector, corner: Float[np.ndarray, "triangle 3 3"], near: float
) -> bool:
    # Whether a ray first meets the back of a face; a coincident front does not hide it
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    leaving = normal @ along > 0
    back, front = (
        first_hits(point, along[None], corner[which])[0]
        for which in (leaving, ~leaving)
    )
    return bool(np.isfinite(back) and back < front + near)


def _normal(corner: Float[np.ndarray, "3 3"]) -> Vector:
    return np.asarray(np.cross(corner[1] - corner[0], corner[2] - corner[0]))


def _pairs(
    corner: Float[np.ndarray, "triangle 3 3"],
    label: Int[np.ndarray, " triangle"],
    number: Int[np.ndarray, " triangle"],
    near: float,
) -> Int[np.ndarray, "pair 2"]:
    # Project along the largest component of the normal
    normal = np.cross(corner[0, 1] - corner[0, 0], corner[0, 2] - corner[0, 0])
    flat = np.delete(corner, int(np.argmax(np.abs(normal))), axis=2)
    low, high = flat.min(axis=1) + near, flat.max(axis=1) - near
    order = np.argsort(low[:, 0])
    flat, low, high = flat[order], low[order], high[order]
    label, number = label[order], number[order]

    # Find pairs of overlapping bounding boxes by a sweep along the first axis
    last = np.searchsorted(low[:, 0], high[:, 0])
    count = np.maximum(last - np.arange(len(flat)) - 1, 0)
    total = np.minimum(np.cumsum(count), _MOST_PAIRS)
    count = np.diff(np.concatenate([[0], total]))
    one = np.repeat(np.arange(len(flat)), count)
    start = np.repeat(np.cumsum(count) - count, count)
    other = one + 1 + np.arange(len(one)) - start
    near_by = (low[one, 1] < high[other, 1]) & (low[other, 1] < high[one, 1])
    near_by &= label[one] != label[other]
    one, other = one[near_by], other[near_by]
    cross = _overlap(flat[one], flat[other], near)
    return np.stack([number[one[cross]], number[other[cross]]], axis=1)


def _overlap(
    one: Float[np.ndarray, "pair 3 2"],
    other: Float[np.ndarray, "pair 3 2"],
    near: float,
) -> Bool[np.ndarray, " pair"]:
    # Separating axis test for two triangles
    apart = np.zeros(len(one), dtype=bool)
    for part in (one, other):
        edge = np.roll(part, -1, axis=1) - part
        axis = np.stack([-edge[..., 1], edge[..., 0]], axis=-1)
        axis /= np.maximum(np.linalg.norm(axis, axis=-1, keepdims=True), 1e-300)
        a = np.einsum("pex,pcx->pec", axis, one)
        b = np.einsum("pex,pcx->pec", axis, other)
        gap = np.maximum(b.min(axis=2) - a.max(axis=2), a.min(axis=2) - b.max(axis=2))
        apart |= np.any(gap > -near, axis=1)
    return ~apart
