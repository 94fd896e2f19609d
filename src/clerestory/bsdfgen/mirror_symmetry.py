"""Mirror symmetry of shading systems, for tracing fewer incident patches.

If a system has left–right or up–down mirror symmetry, mirror-image incident patches
have mirror-image BSDFs. Only one patch of each group of mirror images is traced.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Directions, Indices, Vector
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.model import (
    Cone,
    Dielectric,
    Glass,
    Interface,
    Metal,
    Plastic,
    Polygon,
    Scene,
    Trans,
)

# Tolerance for coinciding corners, relative to the size of the system.
_SAME = 1e-5

# Offset before rounding; without it, corners of regular grids may be halfway values.
_OFF_GRID = 0.381966

_ISOTROPIC = Plastic | Metal | Trans | Glass | Dielectric | Interface

Flip = tuple[int, int]

_FLIPS: tuple[Flip, ...] = (1, 1), (1, -1), (-1, 1), (-1, -1)

# The identity, for systems without symmetry.
NO_MIRROR = _FLIPS[:1]


def mirror_flips(scene: Scene, area: SampleArea) -> tuple[Flip, ...]:
    """Sign changes of x and y that map a system onto itself, the identity first.

    The mirror planes pass through the centre of the sample area. Systems with surfaces
    other than polygons and cones, or with anisotropic materials, count as asymmetric.
    """
    surfaces = [s for s in scene.surfaces if isinstance(s, Polygon | Cone)]
    plain = all(
        isinstance(m, _ISOTROPIC) and getattr(m, "up", None) is None
        for m in scene.materials.values()
    )
    if not plain or len(surfaces) < len(scene.surfaces):
        return NO_MIRROR
    middle = area.bounds.mean(axis=0)
    unit = _SAME * float(area.size.max())
    whole = Counter(_key(s, middle, (1, 1), unit) for s in surfaces)
    return tuple(
        flip
        for flip in _FLIPS
        if Counter(_key(s, middle, flip, unit) for s in surfaces) == whole
    )


@dataclass(frozen=True, eq=False)
class Orbits:
    """Groups of patches that are mirror images of each other.

    `chosen`: indices of the traced patches, one of each group. `flips`: index of the
    mirror image of each patch, for each mirror operation.
    """

    chosen: Int[np.ndarray, " kind"]
    flips: Int[np.ndarray, "mirror patch"]

    @classmethod
    def of(cls, partition: RingPartition, mirror_flips: Sequence[Flip]) -> "Orbits":
        """Group the patches of a partition under given mirror operations.

        Operations that do not map patches onto patches are ignored.
        """
        centre = partition.centres()
        found = []
        for flip in mirror_flips:
            image = centre * [*flip, 1]
            patch = partition.find(image)
            if np.allclose(centre[patch], image, atol=1e-6):
                found.append(patch)
        flips = np.array(found)
        return cls(np.unique(flips.min(axis=0)), flips)

    @property
    def kind(self) -> Indices:
        """Index of the group of each patch."""
        return np.asarray(np.searchsorted(self.chosen, self.flips.min(axis=0)))

    def unfolded(
        self, table: Float[np.ndarray, "*more kind exit"]
    ) -> Float[np.ndarray, "*more patch exit"]:
        """Extend a table of values for traced incident patches to all incident patches.

        If an incident patch is its own mirror image, values of mirror-image exit
        patches are averaged.
        """
        kind = self.kind
        total = np.zeros((*table.shape[:-2], len(kind), table.shape[-1]), table.dtype)
        count = np.zeros(len(kind), dtype=int)
        for flip in self.flips:
            ends = flip == self.chosen[kind]
            total[..., ends, :] += table[..., kind[ends], :][..., flip]
            count += ends
        total /= count[:, None].astype(table.dtype)
        return total


def _key(
    surface: Polygon | Cone, middle: Vector, flip: Flip, unit: float
) -> tuple[object, ...]:
    # Key for comparing surfaces: material, and rounded coordinates of the mirror image
    def grid(points: Directions) -> list[tuple[int, ...]]:
        moved = (points - middle) * [*flip, 1] / unit + _OFF_GRID
        return [tuple(row) for row in np.round(moved).astype(int).tolist()]

    if isinstance(surface, Cone):
        ends = grid(np.stack([surface.base, surface.top]))
        radii = surface.base_radius, surface.top_radius
        rims = sorted(zip(ends, radii, strict=True))
        return surface.material, surface.inward, *rims
    corners = grid(surface.vertices)
    if flip[0] * flip[1] < 0:
        corners.reverse()
    lowest = min(corners)
    starts = [i for i, corner in enumerate(corners) if corner == lowest]
    return (surface.material, *min(corners[i:] + corners[:i] for i in starts))
