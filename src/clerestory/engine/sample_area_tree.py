"""Scattered flux of a sample area in the finest cells of a tensor tree.

The cells are traced in blocks. A block is a square of incident cells with all their
leaving cells, in the order of the tree's branches: the cells below a node are
contiguous. A tree of rank 3 has a single block, with one common incident azimuth.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int, Int64

from clerestory.bands import RGB
from clerestory.engine.matrix_tracers import refuse_out_of_range
from clerestory.engine.primary_rays import lanes
from clerestory.engine.sample_area import Slab, follow, lower_slab, start
from clerestory.engine.sampler import points
from clerestory.engine.sinks import MatrixSink
from clerestory.engine.square import disc_from_square, square_from_disc
from clerestory.engine.sums import FIXED_POINT

__all__ = ["Grid", "Scores", "lower_slab", "trace_block"]

# Makes the random numbers differ from those of other jobs with the same seed.
_SALT = 0x2545F491

# Largest numbers of paths and of consecutive sample points in one launch.
_PATHS, _STRETCH = 1 << 22, 1 << 16


@dataclass
class Grid:
    """The finest cells of a tensor tree, divided into blocks.

    The tree has rank 3 if the BSDF is isotropic, and 4 otherwise. Its finest cells have
    an edge of 2^-depth. In the incident coordinates, a block is a square of 2^`block`
    finest cells per edge.
    """

    rank: int
    depth: int
    block: int

    @property
    def incidents(self) -> int:
        """Number of incident cells of a block."""
        return 1 << ((self.rank - 2) * self.block)

    @property
    def cells(self) -> int:
        """Number of the finest cells of a block."""
        return self.incidents << 2 * self.depth

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return 1 << ((self.rank - 2) * (self.depth - self.block))


@dataclass
class Scores:
    """Sums of path weights in the finest cells, without cells of zero sum.

    `cell` holds the indices of the cells within the block, ascending. `sums` has one
    column per channel, and a last column for the squared luminance.
    """

    cell: Int64[np.ndarray, " score"]
    sums: Float[np.ndarray, "score channel"]


@dataclass
class _IncidentCells:
    # Directions of travel in incident cells; a cell's index interleaves its coordinates
    grid: Grid

    def sample(self, cell, u, v):
        """Sample a direction within a cell uniformly by projected solid angle."""
        wide = 1 << self.grid.depth
        if self.grid.rank == 3:
            inner = 1 - 2 * (mi.Float(cell) + 1) / wide
            outer = 1 - 2 * mi.Float(cell) / wide
            square = dr.lerp(dr.square(inner), dr.square(outer), u)
            sine, cosine = dr.sincos(2 * dr.pi * v)
            disc = mi.Point2f(cosine, sine) * dr.sqrt(square)
        else:
            a = (mi.Float(_every_other(cell, self.grid.depth)) + u) / wide
            b = (mi.Float(_every_other(cell >> 1, self.grid.depth)) + v) / wide
            disc = disc_from_square(a, b)
        return mi.Vector3f(disc.x, disc.y, dr.safe_sqrt(1 - dr.squared_norm(disc)))


@dataclass
class _Cells:
    # Receiver that adds up path weights by incident cell and leaving cell
    grid: Grid
    sink: MatrixSink
    incident: mi.UInt32
    back: mi.Bool
    turn: mi.Vector2f

    def receive(self, direction, weight, active) -> None:
        """Add the path weight, and its squared luminance, to the sums of a cell."""
        grid = self.grid
        x = direction.x * self.turn.x + direction.y * self.turn.y
        y = direction.y * self.turn.x - direction.x * self.turn.y
        place = square_from_disc(x, y) * (1 << grid.depth)
        last = (1 << grid.depth) - 1
        a, b = (mi.UInt32(dr.clip(mi.Int32(c), 0, last)) for c in (place.x, place.y))
        block = a >> grid.block, b >> grid.block
        cell = _interleave(block, 2, grid.depth - grid.block)
        if grid.rank == 3:
            inside = _interleave((self.incident, a, b), 3, grid.block)
        else:
            one = _every_other(self.incident, grid.block)
            other = _every_other(self.incident >> 1, grid.block)
            inside = _interleave((one, other, a, b), 4, grid.block)
        cell = (cell << grid.rank * grid.block) | inside
        reflected = (direction.z > 0) == self.back
        cell += dr.select(reflected, mi.UInt32(grid.cells), 0)
        light = [weight[channel] for channel in range(self.sink.channels - 1)]
        luminance = light[0]
        if len(light) == 3:
            shares = RGB.shares.tolist()
            luminance = sum(w * c for w, c in zip(shares, light, strict=True))
        scores = [*light, dr.square(luminance)]
        self.sink.add(None, cell, scores, active)


def trace_block(
    slab: Slab,
    grid: Grid,
    block: int,
    groups: list[tuple[Int[np.ndarray, " row"], int, int]],
    *,
    back: bool,
    segments: int,
    seed: int,
) -> tuple[Scores, Scores]:
    """Trace paths from incident cells of a block, and return their sums.

    Each group holds indices of incident cells within the block, the number of the first
    path, and the number of paths per cell; for `back` and `segments`, see `start` and
    `follow`. Return the sums of transmitted flux, then those of reflected flux.
    """
    channels = 1 if slab.model.grey else 3
    sink = MatrixSink(dr.zeros(mi.UInt64), 2 * grid.cells, channels + 1)
    sink.sums = dr.zeros(mi.UInt64, sink.columns * sink.channels + 1)
    total = grid.blocks * grid.incidents
    offset = block * grid.incidents + (total if back else 0)
    behind = dr.opaque(mi.Bool, back)
    for rows, begin, number in _launches(groups):
        sequence = points(begin, number)
        rows = rows + offset
        paths = lanes(sequence, rows=rows, batches=1, seed=seed ^ _SALT, stream=0)
        incident = paths.number % total
        ray = start(slab, paths.numbers, _IncidentCells(grid), incident, behind)
        # Rank 3: rotate all incident azimuths to the same azimuth
        turn = _azimuth(ray.d) if grid.rank == 3 else mi.Vector2f(1, 0)
        receiver = _Cells(grid, sink, incident, behind, turn)
        follow(slab, receiver, paths.numbers, ray, segments)
        dr.eval(sink.sums)
    return _scores(sink, grid)


def _scores(sink: MatrixSink, grid: Grid) -> tuple[Scores, Scores]:
    # Sums of transmission and of reflection, without cells of zero sum
    cell = dr.arange(mi.UInt32, sink.columns)
    first = cell * sink.channels + 1
    channels = range(sink.channels)
    parts = [dr.gather(mi.UInt64, sink.sums, first + channel) for channel in channels]
    lit = dr.compress(sum(parts[1:], parts[0]) > 0)
    taken = [dr.gather(mi.UInt64, part, lit).numpy() for part in parts]
    refuse_out_of_range(int(dr.gather(mi.UInt64, sink.sums, 0)[0]))
    number = lit.numpy().astype(np.int64)
    sums = np.stack(taken, axis=1) / FIXED_POINT
    middle = int(np.searchsorted(number, grid.cells))
    transmitted = Scores(number[:middle], sums[:middle])
    return transmitted, Scores(number[middle:] - grid.cells, sums[middle:])


def _launches(groups):
    # Divide the groups into launches of limited numbers of paths and sequence points
    for rows, first, count in groups:
        together = max(1, _PATHS // min(count, _STRETCH))
        for begin in range(first, first + count, _STRETCH):
            number = min(_STRETCH, first + count - begin)
            for few in range(0, len(rows), together):
                yield rows[few : few + together], begin, number


def _azimuth(direction):
    # Cosine and sine of the azimuth of travel; (1, 0) for vertical directions
    radius = dr.sqrt(dr.square(direction.x) + dr.square(direction.y))
    scale = dr.select(radius == 0, 0, dr.rcp(radius))
    cosine = dr.select(radius == 0, 1, direction.x * scale)
    return mi.Vector2f(cosine, direction.y * scale)


def _every_other(number, bits: int):
    # One coordinate of an interleaved index: the number composed of bits 0, 2, 4 …
    found = mi.UInt32(0)
    for bit in range(bits):
        found |= (number >> bit) & (1 << bit)
    return found


def _interleave(numbers: tuple, rank: int, bits: int):
    # Interleave the bits of several numbers (Morton code), the first number lowest
    found = mi.UInt32(0)
    for dimension, number in enumerate(numbers):
        for bit in range(bits):
            found |= ((number >> bit) & 1) << (rank * bit + dimension)
    return found
