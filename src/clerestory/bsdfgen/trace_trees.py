"""Tensor trees of a shading system by ray tracing, block by block."""

from typing import Any

import numpy as np
from jaxtyping import Float32

from clerestory.array_types import Values
from clerestory.bands import RGB, weighted_sum
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import float_bits
from clerestory.bsdfgen.adaptive_sampling import BlockEstimator, FunctionEstimate
from clerestory.bsdfgen.channel_weights import chromaticity
from clerestory.bsdfgen.flux_preserving_merge import (
    HemisphericalFlux,
    preserve_flux,
    preserve_flux_on_both_sides,
)
from clerestory.bsdfgen.morton_codes import pair_code
from clerestory.bsdfgen.subcells import Subcells, subcell_slots, whole_cells
from clerestory.bsdfgen.trace_request import Functions, Traced, TraceRequest
from clerestory.bsdfgen.tree_pruning import (
    Cells,
    NodeValues,
    pruned_levels,
    selected_cells,
)

# Largest number of sums in a block of a rank 4 tree: smallest cells × functions ×
# channels.
_MOST_SUMS = 1 << 24


def trace_trees(request: TraceRequest, engine: Any, *, rank: int, depth: int) -> Traced:
    """Return trees of transmission and reflection for the requested incident sides.

    `engine`: module `engine.sample_area_tree`. `rank`: 3 for isotropic systems,
    otherwise 4. `depth`: number of tree levels below the root.
    """
    area, effort = request.system.area, request.effort
    slab = engine.lower_slab(request.system.scene, area.slab(), periodic=area.periodic)
    weights = np.array([1.0]) if slab.model.grey else RGB.shares
    grid = engine.Grid(rank, depth, _block(rank, depth, len(weights) + 1))
    functions: Functions = {}
    paths, reached = 0, True
    for number, back in enumerate(request.backs):
        found = []
        for block in range(grid.blocks):
            if effort.progress is not None:
                share = (number + block / grid.blocks) / len(request.backs)
                effort.progress(share, f"block {block + 1} of {grid.blocks}")
            counter = BlockEstimator(engine, slab, grid, block, back, weights)
            found.append(counter.count(effort))
            paths, reached = paths + found[-1].paths, reached and found[-1].reached
        side = "back" if back else "front"
        for kind in ("transmission", "reflection"):
            # Release the estimates of a tree as soon as the tree is built
            blocks = [counted.parts.pop(0) for counted in found]
            made = _trees(*_pieces(blocks, weights, grid), grid, request)
            name: Any = f"{kind}_{side}"
            functions |= {(band, name): tree for band, tree in made.items()}
    if effort.progress is not None:
        effort.progress(1.0, "done")
    return Traced(functions, paths, reached)


def _block(rank: int, depth: int, channels: int) -> int:
    # Largest number of tree levels per block that fits into memory; rank 3: all levels
    if rank == 3:
        return depth
    within = depth
    while within > 0 and 2 * channels << 2 * (depth + within) > _MOST_SUMS:
        within -= 1
    return within


def _pieces(
    blocks: list[FunctionEstimate], weights: Values, grid: Any
) -> tuple[Cells, list[Subcells]]:
    # Select the cells of the whole tree from the estimates of all blocks; return the
    # cells and their subcells
    rank, depth = grid.rank, grid.depth
    levels = pruned_levels(_whole(blocks, grid), weights, rank=rank, levels=depth)
    cells = selected_cells(levels, rank=rank)
    del levels
    light = HemisphericalFlux(
        np.concatenate([part.incident.share for part in blocks]),
        np.concatenate([part.incident.variance for part in blocks]),
    )
    leaving = HemisphericalFlux(
        np.sum([part.leaving.share for part in blocks], axis=0),
        np.sum([part.leaving.variance for part in blocks], axis=0),
    )
    blocks.clear()
    luminous = cells.value @ weights
    pieces = whole_cells(cells.place, cells.height, depth=depth)
    if rank == 3:
        return cells, preserve_flux(pieces, luminous, light, rank=rank)
    return cells, preserve_flux_on_both_sides(pieces, luminous, light, leaving)


def _whole(blocks: list[FunctionEstimate], grid: Any) -> NodeValues:
    # Join the blocks: convert Morton codes of a block to codes of the whole tree
    if len(blocks) == 1:
        return blocks[0].finest
    inner = grid.rank * grid.block
    places = []
    for number, part in enumerate(blocks):
        root, inside = np.divmod(part.finest.place, 1 << inner)
        block = np.full_like(root, number)
        above = pair_code(block, root, rank=grid.rank, levels=grid.depth - grid.block)
        places.append((above << inner | inside).astype(np.int32))
    place = np.concatenate(places)
    order = np.argsort(place, kind="stable")
    mean = np.concatenate([part.finest.mean for part in blocks])
    noise = np.concatenate([part.finest.noise for part in blocks])
    return NodeValues(place[order], mean[order], noise[order])


def _trees(
    cells: Cells, pieces: list[Subcells], grid: Any, request: TraceRequest
) -> dict[str, ScatteringTree]:
    # All BSDF channels use the same cells and the relative standard errors of luminance
    channels = cells.value.T
    luminous = weighted_sum(channels, RGB.shares, axis=0)
    relative = np.divide(
        np.sqrt(cells.noise), luminous, out=np.zeros_like(luminous), where=luminous > 0
    )
    slots = subcell_slots(pieces, rank=grid.rank)
    ends = slots >= 0
    cell = np.concatenate([part.cell for part in pieces])[slots[ends]]
    factor = np.concatenate([part.factor for part in pieces])[slots[ends]]

    def tree(
        value: Float32[np.ndarray, " end"], error: ScatteringTree | None
    ) -> ScatteringTree:
        held = slots.copy()
        held[ends] = float_bits(value)
        return ScatteringTree(held, grid.rank, grid.depth, error)

    made = {}
    for band, of in request.system.bands.items():
        value = weighted_sum(channels, np.array(of), axis=0).astype(np.float32)
        error = (value * relative).astype(np.float32)
        made[band] = tree(value[cell] * factor, tree(error[cell] * factor, None))
    if request.colour:
        u, v = (part.astype(np.float32)[cell] for part in chromaticity(channels))
        made |= {"cie-u": tree(u, None), "cie-v": tree(v, None)}
    return made
