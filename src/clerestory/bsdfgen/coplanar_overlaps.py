"""Detection of overlapping coplanar surfaces, whose intersections are ambiguous."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdfgen.naming import item
from clerestory.scene.model import Scene
from clerestory.scene.tessellate import meshes

# Tolerance of coplanarity and of overlaps at common edges, as a share of the size of
# the system.
_SAME = 1e-6

# Most pairs of triangles that are tested; larger systems are tested in part.
_MOST_PAIRS = 4_000_000


def overlapping(scene: Scene) -> Iterator[str]:
    """Yield the first pair of overlapping coplanar surfaces and their number."""
    parts = meshes(scene)
    corner = np.concatenate([m.vertices[m.faces] for m in parts])
    surface = np.concatenate([m.surface for m in parts])
    size = float(np.ptp(corner.reshape(-1, 3), axis=0).max())
    pairs = [
        _pairs(corner[of], surface[of], of, _SAME * size)
        for of in _planes(corner, _SAME * size)
    ]
    found = np.concatenate([np.empty((0, 2), dtype=int), *pairs])
    if not len(found):
        return
    both = np.unique(np.sort(surface[found], axis=1), axis=0)
    one, other = (scene.surfaces[int(i)] for i in both[0])
    more = f"; {len(both) - 1} more such pairs" if len(both) > 1 else ""
    yield (
        f"{item(one)} and {item(other)} lie in one plane and overlap{more}; one surface"
        " in each place expected"
    )


def _planes(
    corner: Float[np.ndarray, "triangle 3 3"], near: float
) -> Iterator[Int[np.ndarray, " triangle"]]:
    # Triangles grouped by their plane
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    flat = np.flatnonzero(length > 0)
    normal = normal[flat] / length[flat, None]
    lead = np.argmax(np.abs(normal) > 1e-6, axis=1)
    normal *= np.sign(normal[np.arange(len(flat)), lead])[:, None]
    offset = np.einsum("tx,tx->t", normal, corner[flat].mean(axis=1))
    key = np.column_stack(
        [np.round(normal, 5), np.round(offset / max(10 * near, 1e-12))]
    )
    _, which, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(which.ravel(), kind="stable")
    for part in np.split(flat[order], np.cumsum(count)[:-1]):
        if len(part) > 1:
            yield part


def _pairs(
    corner: Float[np.ndarray, "triangle 3 3"],
    surface: Int[np.ndarray, " triangle"],
    number: Int[np.ndarray, " triangle"],
    near: float,
) -> Int[np.ndarray, "pair 2"]:
    # Project along the largest component of the normal
    normal = np.cross(corner[0, 1] - corner[0, 0], corner[0, 2] - corner[0, 0])
    flat = np.delete(corner, int(np.argmax(np.abs(normal))), axis=2)
    low, high = flat.min(axis=1) + near, flat.max(axis=1) - near
    order = np.argsort(low[:, 0])
    flat, low, high = flat[order], low[order], high[order]
    surface, number = surface[order], number[order]

    # Sweep along the first axis
    last = np.searchsorted(low[:, 0], high[:, 0])
    count = np.maximum(last - np.arange(len(flat)) - 1, 0)
    total = np.minimum(np.cumsum(count), _MOST_PAIRS)
    count = np.diff(np.concatenate([[0], total]))
    one = np.repeat(np.arange(len(flat)), count)
    start = np.repeat(np.cumsum(count) - count, count)
    other = one + 1 + np.arange(len(one)) - start
    near_by = (low[one, 1] < high[other, 1]) & (low[other, 1] < high[one, 1])
    near_by &= surface[one] != surface[other]
    one, other = one[near_by], other[near_by]
    cross = _overlap(flat[one], flat[other], near)
    return np.stack([number[one[cross]], number[other[cross]]], axis=1)


def _overlap(
    one: Float[np.ndarray, "pair 3 2"],
    other: Float[np.ndarray, "pair 3 2"],
    near: float,
) -> Bool[np.ndarray, " pair"]:
    # Separating axis test on the normals of the edges
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
