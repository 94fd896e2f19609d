"""Tensor trees: BSDFs of variable angular resolution.

The Shirley–Chiu map takes directions, projected onto the unit disc, to points of the
unit square. A rank 4 tree subdivides the two coordinates of the incident and of the
exit direction where values differ. A rank 3 tree describes an isotropic layer: its
first coordinate is half the distance of the projected incident direction from the rim
of the disc, and exit azimuths are relative to the incident azimuth. The conventions are
those of Radiance's bsdf_t.c.

A tree is one array of 32-bit slots. A non-negative slot contains the bits of a float
value. A negative slot is a branch node: the bitwise complement of the index at which
the 2^rank children start. Dimension i is bit i of the child number. Slot 0 is the root.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, final

import numpy as np
from jaxtyping import Float, Int32, Int64

from clerestory.array_types import (
    Directions,
    ExitIncident,
    Indices,
    Points2,
    Slots,
    Values,
)
from clerestory.brief_repr import brief
from clerestory.bsdf.inverse_sampling import choose_cells
from clerestory.bsdf.reciprocal_function import ReciprocalFunction
from clerestory.bsdf.scattering_function import CHUNK, CellValues, ScatteringFunction
from clerestory.bsdf.tree_average import average_tree
from clerestory.bsdf.tree_lookup import (
    Slices,
    cells,
    dense_top,
    look_up,
    morton_codes,
    slices,
    values_at,
)
from clerestory.bsdf.tree_parser import MAX_DEPTH
from clerestory.checks import one_of, require, within
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import cells_from_disc, disc_from_square

# Offset of the first coordinate of rank 3 trees, so that the coordinate is below 1/2 at
# normal incidence, as in Radiance.
_OFF_MIDDLE = 1e-6

# Largest number of exit cells that are integrated together.
_MOST_EXIT_CELLS = 1 << 22

_Pairs = Float[np.ndarray, " pairs"]
_Places = Int32[np.ndarray, " pairs"]


@final
@dataclass(frozen=True, eq=False)
class ScatteringTree(ScatteringFunction):
    """One scattering function of a layer as a tensor tree, in one channel."""

    slots: Slots  # values and branch nodes, encoded as the module docstring describes
    rank: Literal[3, 4]  # 3 for isotropic layers, 4 otherwise
    depth: int  # number of levels below the root; the smallest cells have edge 2^-depth
    # Standard error [1/sr] as a tree with the same cells; None if unknown
    standard_error: "ScatteringTree | None" = None

    __repr__ = brief

    def __post_init__(self) -> None:
        one_of(self.rank, "rank of a tensor tree", choices=(3, 4))
        within(self.depth, "depth of a tensor tree", least=0, most=MAX_DEPTH)
        inner = np.flatnonzero(self.slots < 0)
        block = ~self.slots[inner]
        last = len(self.slots) - (1 << self.rank)
        require(
            len(self.slots) and np.all(block > inner) and np.all(block <= last),
            "a child index of a tensor tree is outside the tree or before the parent"
            " node; indices after the parent expected",
        )
        require(
            np.all(np.isfinite(self.slots[self.slots >= 0].view(np.float32))),
            "a tensor tree contains non-finite values; finite values expected",
        )

    def evaluate(self, incident: Directions, leaving: Directions) -> Values:
        return self._over_pairs(
            lambda place: values_at(self.slots, self._top, place, depth=self.depth),
            incident,
            leaving,
        )

    def resolution(self, incident: Directions, leaving: Directions) -> Values:
        return self._over_pairs(
            lambda place: (
                np.pi * 0.25 ** look_up(self.slots, place, depth=self.depth)[1]
            ),
            incident,
            leaving,
        )

    def cell_values(self, incident: Directions, leaving: Directions) -> CellValues:
        """Value, size and number: the Morton code of the start of the cell."""
        found = [(np.zeros(0), np.zeros(0))]

        def start(place: tuple[_Places, ...]) -> Indices:
            value, level = look_up(self.slots, place, depth=self.depth)
            found.append((value.astype(float), np.pi * 0.25**level))
            unused = self.rank * (self.depth - level.astype(np.int64))
            path = morton_codes(place, self.depth).astype(np.int64)
            return np.asarray(path >> unused << unused)

        number = self._over_pairs(start, incident, leaving, kind=np.int64)
        value, size = (np.concatenate(part) for part in zip(*found, strict=True))
        return CellValues(
            value.reshape(number.shape), size.reshape(number.shape), number
        )

    def hemispherical(self, incident: Directions) -> Values:
        x, y, _ = np.reshape(np.asarray(incident, dtype=float), (-1, 3)).T
        share = np.empty(len(x))
        for found, owner, of in self._slices(x, y):
            share[of] = np.pi * np.bincount(found.owner, found.flux)[owner]
        return share.reshape(np.shape(incident)[:-1])

    def sample(self, incident: Directions, u: Points2) -> tuple[Directions, Values]:
        x, y, _ = np.reshape(np.asarray(incident, dtype=float), (-1, 3)).T
        u = np.reshape(u, (-1, 2))
        leaving, density = np.empty((len(x), 3)), np.empty(len(x))
        for found, owner, of in self._slices(x, y):
            point, density[of] = _choose(found, owner, u[of])
            disc = disc_from_square(*point)
            if self.rank == 3:
                disc = _turn(disc, *_azimuth(x[of], y[of]))
            height = np.sqrt(np.maximum(1 - disc[0] ** 2 - disc[1] ** 2, 0))
            leaving[of] = np.stack([*disc, height], axis=-1)
        leaving[density == 0] = [0, 0, 1]
        density *= leaving[:, 2]
        shape = np.shape(incident)[:-1]
        return leaving.reshape(*shape, 3), density.reshape(shape)

    def average(self, exits: RingPartition, incidents: RingPartition) -> ExitIncident:
        return average_tree(self.slots, self.rank, exits, incidents)

    def extrema(self) -> tuple[float, float]:
        least, most = np.inf, -np.inf
        for level, place, value in cells(self.slots, self.rank):
            if self.rank == 3 and level:
                # Skip the second half of the first dimension, which is unused
                value = value[place[0] < 1 << (level - 1)]
            if len(value):
                least, most = min(least, value.min()), max(most, value.max())
        return float(least), float(most)

    def reciprocal(self) -> ScatteringFunction:
        if self.rank == 3:
            return ReciprocalFunction(self, halvings=self.depth)
        # Exchange incident and exit coordinates; complement bits to reverse directions
        bits = (np.arange(16)[:, None] >> np.array([2, 3, 0, 1])) & 1
        branch = (1 - bits) @ (1 << np.arange(4))
        slots = self.slots.copy()
        slots[1:] = self.slots[1:].reshape(-1, 16)[:, branch].ravel()
        return ScatteringTree(slots, 4, self.depth)

    def tabulated(self) -> "ScatteringTree":
        return self

    def own_partitions(self) -> None:
        """Return None, because a tree has no patches."""

    @cached_property
    def _top(self) -> tuple[int, Int32[np.ndarray, " tops"]]:
        return dense_top(self.slots, self.rank, self.depth)

    def _over_pairs(
        self,
        read: Callable[[tuple[_Places, ...]], np.ndarray],
        incident: Directions,
        leaving: Directions,
        kind: type = float,
    ) -> np.ndarray:
        incident, leaving = np.broadcast_arrays(incident, leaving)
        shape = incident.shape[:-1]
        incident, leaving = incident.reshape(-1, 3), leaving.reshape(-1, 3)
        result: np.ndarray = np.empty(len(incident), kind)
        for start in range(0, len(result), CHUNK):
            part = slice(start, start + CHUNK)
            x, y = incident[part, 0], incident[part, 1]
            place = self._incident_place(x, y), self._exit_place(leaving[part], x, y)
            result[part] = read((*place[0], *place[1]))
        return result.reshape(shape)

    def _incident_place(self, x: _Pairs, y: _Pairs) -> tuple[_Places, ...]:
        if self.rank == 4:
            return cells_from_disc(-x, -y, halvings=self.depth)
        inwards = 0.5 - _OFF_MIDDLE - 0.5 * np.sqrt(x * x + y * y)
        place = (inwards * (1 << self.depth)).astype(np.int32)
        return (np.clip(place, 0, (1 << self.depth) - 1, out=place),)

    def _exit_place(
        self, leaving: Directions, x: _Pairs, y: _Pairs
    ) -> tuple[_Places, _Places]:
        disc = leaving[:, 0], leaving[:, 1]
        if self.rank == 3:
            cosine, sine = _azimuth(x, y)
            disc = _turn(disc, cosine, -sine)
        return cells_from_disc(*disc, halvings=self.depth)

    def _slices(
        self, x: _Pairs, y: _Pairs
    ) -> Iterator[tuple[Slices, Indices, Indices]]:
        # Exit cells of groups of incident cells, with the incident cell and the index
        # of each direction in the group; a group has at most 2^22 exit cells
        place, which = np.unique(
            np.stack(self._incident_place(x, y)), axis=1, return_inverse=True
        )
        which = which.ravel()
        together = max(1, _MOST_EXIT_CELLS >> 2 * self.depth)
        for start in range(0, place.shape[1], together):
            of = np.flatnonzero((which >= start) & (which < start + together))
            part = place[:, start : start + together]
            yield slices(self.slots, part, depth=self.depth), which[of] - start, of


def _azimuth(x: _Pairs, y: _Pairs) -> tuple[_Pairs, _Pairs]:
    # Cosine and sine of the azimuth towards which light from (x, y) propagates
    radius = np.sqrt(x * x + y * y)
    upright = np.flatnonzero(radius == 0)
    radius[upright] = 1.0
    cosine, sine = -x / radius, -y / radius
    cosine[upright] = -1.0
    return cosine, sine


def _turn(
    disc: tuple[_Pairs, _Pairs], cosine: _Pairs, sine: _Pairs
) -> tuple[_Pairs, _Pairs]:
    x, y = disc
    return cosine * x - sine * y, sine * x + cosine * y


def _choose(
    found: Slices,
    owner: Int64[np.ndarray, " samples"],
    u: Float[np.ndarray, "samples 2"],
) -> tuple[Float[np.ndarray, "2 samples"], Float[np.ndarray, " samples"]]:
    # Sample points of the unit square in proportion to the flux in the exit cells of
    # each incident cell; return points and density per projected solid angle
    start = np.searchsorted(found.owner, np.arange(int(found.owner[-1]) + 2))
    cell, rest, total = choose_cells(
        found.flux, start[owner], start[owner + 1], u[:, 0]
    )
    point = found.corner[:, cell] + found.size[cell] * np.stack([rest, u[:, 1]])
    some = total > 0
    return point, np.where(
        some, found.value[cell] / np.where(some, np.pi * total, 1), 0
    )
