"""Tensor trees of a traced system, block by block, joined to whole trees."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int32

from clerestory.bsdf.tree import ScatteringTree
from clerestory.bsdf.tree_combine import bits_of
from clerestory.bsdfgen.bands import band_values, chromaticity
from clerestory.bsdfgen.branches import joined
from clerestory.bsdfgen.count import BlockCells, Counter
from clerestory.bsdfgen.refine import Light, chosen_cells, coarser_light
from clerestory.bsdfgen.request import Functions, Traced, TraceRequest
from clerestory.constants import LUMINANCE_WEIGHTS
from clerestory.scene.model import Scene

# Most finest cells in a block of a rank 4 tree, for both functions and all channels.
_MOST_SUMS = 1 << 24


@dataclass(frozen=True, eq=False)
class _Structure:
    # A tree whose values are still numbers of cells
    slots: Int32[np.ndarray, " slot"]
    value: Float[np.ndarray, "cell channel"]
    noise: Float[np.ndarray, " cell"]


def trace_trees(
    engine: Any, scene: Scene, request: TraceRequest, *, rank: int, depth: int
) -> Traced:
    """Return trees of transmission and reflection for light from some sides.

    Parameters
    ----------
    engine : module `engine.sample_area_tree`
    rank : 3 if every azimuth is alike, 4 otherwise
    depth : halvings of each coordinate down to the finest cells
    """
    area, effort = request.area, request.effort
    slab = engine.lower_slab(scene, area.slab(), periodic=area.periodic)
    weights = np.array([1.0]) if slab.grey else np.array(LUMINANCE_WEIGHTS)
    grid = engine.Grid(rank, depth, _block(rank, depth, len(weights) + 1))
    functions: Functions = {}
    paths, reached = 0, True
    for number, back in enumerate(request.backs):
        found = []
        for block in range(grid.blocks):
            if effort.progress is not None:
                share = (number + block / grid.blocks) / len(request.backs)
                effort.progress(share, f"block {block + 1} of {grid.blocks}")
            counter = Counter(engine, slab, grid, block, back, weights)
            found.append(counter.count(effort))
            paths, reached = paths + found[-1].paths, reached and found[-1].reached
        side = "back" if back else "front"
        for kind in ("transmission", "reflection"):
            blocks = [getattr(part, kind) for part in found]
            structure = _joined(blocks, weights, grid)
            name: Any = f"{kind}_{side}"
            made = _trees(structure, grid, request)
            functions |= {(band, name): tree for band, tree in made.items()}
    if effort.progress is not None:
        effort.progress(1.0, "done")
    return Traced(functions, paths, reached)


def _block(rank: int, depth: int, channels: int) -> int:
    # Halvings within a block: as many as fit the memory, all of them for rank 3
    if rank == 3:
        return depth
    within = depth
    while within > 0 and 2 * channels << 2 * (depth + within) > _MOST_SUMS:
        within -= 1
    return within


def _joined(
    blocks: list[BlockCells],
    weights: Float[np.ndarray, " channel"],
    grid: Any,
) -> _Structure:
    # Put the blocks below the levels above them, whose cells may join whole blocks
    rank, levels = grid.rank, grid.depth - grid.block
    roots = len(blocks[0].roots.mean)
    block, root = np.divmod(np.arange(len(blocks) * roots), roots)
    place = joined(block, root, rank=rank, levels=levels)
    parts = {
        name: np.concatenate([getattr(b.roots, name) for b in blocks])
        for name in ("mean", "noise", "cost", "split")
    }
    order = np.argsort(place)
    lowest = Light(**{name: part[order] for name, part in parts.items()})
    above = [lowest]
    for height in range(1, levels + 1):
        cells = 1 << rank * (grid.block + height)
        up = coarser_light(above[-1], weights, width=1 << rank, cells=cells)
        up.split[above[-1].split.reshape(-1, 1 << rank).any(axis=1)] = True
        above.append(up)
    unsplit = Light(lowest.mean, lowest.noise, lowest.cost, np.zeros_like(lowest.split))
    top = chosen_cells([*above[:0:-1], unsplit], rank=rank)

    # Number slots and cells of all blocks after those of the top
    slots, value, noise = [top.slots.copy()], [top.value], [top.noise]
    size, count = len(top.slots), len(top.value)
    entry = []
    for part in blocks:
        codes = part.cells.slots
        moved = np.where(codes < 0, ~(~codes - roots + size), codes + count)
        entry.append(moved[:roots])
        slots.append(moved[roots:].astype(np.int32))
        value.append(part.cells.value)
        noise.append(part.cells.noise)
        size += len(codes) - roots
        count += len(part.cells.value)

    # Lead from the top into the blocks
    ends = np.flatnonzero(top.slots >= 0)
    cell = top.slots[ends]
    inner = top.height[cell] == 0
    source = order[top.place[cell[inner]]]
    slots[0][ends[inner]] = np.concatenate(entry)[source]
    return _Structure(
        np.concatenate(slots), np.concatenate(value), np.concatenate(noise)
    )


def _trees(
    structure: _Structure, grid: Any, request: TraceRequest
) -> dict[str, ScatteringTree]:
    # Values of each band on the same cells; errors are those of the luminous value
    channels = structure.value.T
    weights = LUMINANCE_WEIGHTS if len(channels) == 3 else (1.0, 0.0, 0.0)
    luminous = band_values(channels, weights)
    relative = np.divide(
        np.sqrt(structure.noise),
        luminous,
        out=np.zeros_like(luminous),
        where=luminous > 0,
    )

    def tree(
        value: Float[np.ndarray, " cell"], error: ScatteringTree | None
    ) -> ScatteringTree:
        inner = structure.slots < 0
        cell = np.where(inner, 0, structure.slots)
        slots = np.where(inner, structure.slots, bits_of(value)[cell])
        return ScatteringTree(slots.astype(np.int32), grid.rank, grid.depth, error)

    made = {}
    for band, of in request.bands.items():
        value = band_values(channels, of)
        made[band] = tree(value, tree(value * relative, None))
    if request.colour:
        u, v = chromaticity(channels)
        made |= {"cie-u": tree(u, None), "cie-v": tree(v, None)}
    return made
