"""Resampling of BSDFs between matrices and trees, and between partitions.

Each new BSDF value is the mean of the old values, weighted by the projected solid
angles of the overlaps of incident and of exit patches, which conserves flux.
"""

from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.ndimage import maximum_filter

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_overlap import patches_in_cells
from clerestory.bsdf.scattering_function import OTHER_SIDE, Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import (
    combine,
    float_bits,
    full_levels,
    level_slots,
    reduce_tree,
    xyz_functions,
)
from clerestory.bsdf.tree_parser import morton_order
from clerestory.checks import within
from clerestory.errors import InputError
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.shirley_chiu import directions_from_square

# Largest number of halvings: a rank 4 tree then has 17 million values before reduction.
_FINEST = 6

# Trees with exchanged directions: number of sample points per cell and axis, and
# fraction of the largest value of adjacent cells that is added to each cell.
_WITHIN, _SPILL = 3, 0.03


def to_matrices(bsdf: Bsdf, partition: RingPartition) -> Bsdf:
    """Convert a BSDF to matrices on one partition.

    CIE u′ and v′ are converted to CIE X and Z, which can be averaged.
    """
    functions: dict[tuple[str, Function], ScatteringFunction] = {
        (channel, name): ScatteringMatrix(
            part.average(partition, partition), partition, partition
        )
        for (channel, name), part in _tristimulus(bsdf).items()
    }
    return replace(bsdf, functions=functions)


def to_trees(bsdf: Bsdf, *, halvings: int = 5, reduction: float = 0.0) -> Bsdf:
    """Convert matrices to tensor trees of rank 4; tensor trees are unchanged.

    `halvings`: the smallest cells have edge 2^-halvings; 6 at most. `reduction`:
    percentage of the smallest cells that are merged; 0 merges only equal cells.
    """
    functions = {
        key: part
        if isinstance(part, ScatteringTree)
        else tree_from(part, halvings, reduction=reduction)
        for key, part in bsdf.functions.items()
    }
    return replace(bsdf, functions=functions)


def tree_from(
    part: ScatteringFunction, halvings: int, *, reduction: float = 0.0
) -> ScatteringTree:
    """Convert a matrix to a rank 4 tensor tree; similar or equal cells are merged."""
    if not isinstance(part, ScatteringMatrix):
        raise InputError(
            f"the BSDF is of type {type(part).__name__}; a matrix expected"
        )
    within(halvings, "number of halvings of a tensor tree", least=0, most=_FINEST)
    leave = patches_in_cells(part.exits, halvings)
    enter = patches_in_cells(part.incidents, halvings)
    area = np.pi * 0.25**halvings
    value = (enter.T @ (leave.T @ part.values).T) / area**2
    return reduce_tree(full_tree(value, halvings), reduction).tree


def reciprocal_mean(bsdf: Bsdf) -> Bsdf:
    """Return the mean of a BSDF and its reciprocal; the mean satisfies reciprocity.

    Each transmission is averaged with the reciprocal of the opposite transmission.
    Trees of rank 3 are unchanged, because the reciprocal is not a tree.
    """
    functions = dict(bsdf.functions)
    for key, one in bsdf.functions.items():
        partner = bsdf.functions.get((key[0], OTHER_SIDE.get(key[1], key[1])))
        if partner is None:
            continue
        two = partner.reciprocal()
        if isinstance(one, ScatteringMatrix):
            values = (one.values + two.average(one.exits, one.incidents)) / 2
            functions[key] = ScatteringMatrix(values, one.exits, one.incidents)
        elif isinstance(one, ScatteringTree) and isinstance(two, ScatteringTree):
            functions[key] = combine(lambda a, b: (a + b) / 2, one, two)
    return replace(bsdf, functions=functions)


def full_tree(
    value: Float[np.ndarray, "..."], halvings: int, *, rank: Literal[3, 4] = 4
) -> ScatteringTree:
    """Convert a full grid of cells to a tensor tree.

    `value`: BSDF [1/sr] of the smallest cells, in row-major order; incident cells are
    indexed by the direction of propagation.
    """
    # Store the branches of all levels, then the values in Morton order
    upper = level_slots(full_levels(rank, halvings), rank)
    leaves = float_bits(value.ravel()[morton_order(rank, halvings)])
    return ScatteringTree(np.concatenate([*upper, leaves]), rank, halvings)


def exchanged_tree(tree: ScatteringTree) -> ScatteringTree:
    """Rank 3 tree with incident and leaving directions exchanged, for sampling."""
    edge = 1 << tree.depth
    grid = (np.arange(_WITHIN) + 0.5) / _WITHIN
    radial = (np.arange(edge // 2)[:, None] + grid).ravel() / edge
    square_axis = (np.arange(edge)[:, None] + grid).ravel() / edge
    a, b = np.meshgrid(square_axis, square_axis, indexing="ij")
    other = directions_from_square(a.ravel(), b.ravel())
    value = np.zeros((edge, edge, edge))
    for step, inwards in enumerate(radial):
        # Incident direction of the new tree, with propagation towards azimuth zero
        radius = 1 - 2 * inwards
        known = np.array([-radius, 0.0, np.sqrt(1 - radius * radius)])
        found = tree.evaluate(other, np.broadcast_to(known, other.shape))
        cells = found.reshape(edge, _WITHIN, edge, _WITHIN).mean(axis=(1, 3))
        value[step // _WITHIN] += cells / _WITHIN

    # Add BSDF to adjacent cells, because old and new cells overlap only partly
    value += _SPILL * maximum_filter(value, size=3, mode="nearest")
    value[edge // 2 :] = 0
    return full_tree(value, tree.depth, rank=3)


def _tristimulus(bsdf: Bsdf) -> dict[tuple[str, Function], ScatteringFunction]:
    functions = dict(bsdf.functions)
    for channel, name in bsdf.functions:
        key_u, key_v = ("cie-u", name), ("cie-v", name)
        if channel == "visible" and key_u in functions and key_v in functions:
            x, _, z = xyz_functions(
                functions["visible", name], functions.pop(key_u), functions.pop(key_v)
            )
            functions["cie-x", name], functions["cie-z", name] = x, z
    return functions
