"""Reduction, reciprocity and written trees against Radiance's own programs."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import reciprocal_mean
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import combine, reduce_tree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf

pyradiance = pytest.importorskip("pyradiance")
library = pytest.importorskip("pyradiance.bsdf")
PROGRAM = Path(pyradiance.__file__).parent / "bin" / "rttree_reduce"
LOADED = []


def peaks(rank, cells=16):
    """Smooth lobe with noise, on a grid; the unused half of rank 3 is zero."""
    axes = np.meshgrid(*[(np.arange(cells) + 0.5) / cells - 0.5] * rank, indexing="ij")
    turned = axes[:2] if rank == 4 else [axes[0] * 0, 2 * axes[0] + 0.5]
    away = sum((a - b) ** 2 for a, b in zip(turned, axes[-2:], strict=True))
    noise = np.random.default_rng(1).random((cells,) * rank)
    value = 5 * np.exp(-60 * away) + 0.1 * (axes[-1] + 0.5) + 0.02 * noise**4
    if rank == 3:
        value[cells // 2 :] = 0
    return value.astype(np.float32)


def reduced(grid, percent, *options):
    """Tree that `rttree_reduce -h -ff -r RANK -g 4 -t PERCENT` makes of a grid."""
    rank = grid.ndim
    used = grid[: len(grid) // 2] if rank == 3 else grid
    command = [PROGRAM, "-h", "-ff", "-r", str(rank), "-g", "4", "-t", str(percent)]
    out = subprocess.run(
        [*command, *options], input=used.tobytes(), capture_output=True, check=True
    ).stdout
    return tree(out, rank)


def tree(text, rank):
    table = parse_tree(text, rank=rank)
    return ScatteringTree(table.slots, rank, table.depth)


def whole(grid):
    return tree(("{" + " ".join(map(str, grid.ravel())) + "}").encode(), grid.ndim)


@pytest.mark.parametrize("rank", [3, 4])
@pytest.mark.parametrize("percent", [0, 50, 95, 99])
def test_reduced_tree_is_that_of_rttree_reduce(rank, percent):
    grid = peaks(rank)
    theirs, ours = reduced(grid, percent), reduce_tree(whole(grid), percent).tree
    assert len(theirs.slots) == len(ours.slots)
    difference = combine(lambda a, b: np.abs(a - b), theirs, ours)
    assert difference.extrema()[1] < 2e-6


def test_reciprocal_mean_of_a_reflection_is_that_of_rttree_reduce():
    """`-a` averages a grid with its reciprocal."""
    grid = peaks(4)
    theirs = reduced(grid, 0, "-a")
    bsdf = Bsdf({("visible", "reflection_front"): whole(grid)})
    ours = reciprocal_mean(bsdf).functions["visible", "reflection_front"]
    difference = combine(lambda a, b: np.abs(a - b), theirs, ours)
    assert difference.extrema()[1] < 2e-6


@pytest.mark.parametrize(
    "name", ["honeybee/tensortree", "pyradiance_tutorial/blindsT3"]
)
def test_radiance_reads_what_we_write_as_it_reads_the_original(
    shared_data, tmp_path, name
):
    path = shared_data / "bsdf" / f"{name}.xml"
    bsdf = read_bsdf(path)
    copy = tmp_path / f"copy_{path.name}"
    write_bsdf(copy, bsdf)
    assert read_bsdf(copy).product == bsdf.product
    LOADED.extend(library.load_file(str(file)) for file in (path, copy))
    theirs, ours = LOADED[-2:]
    angles = np.random.default_rng(1).uniform(0, 180, (2000, 4))
    values = [
        [library.query(d, *a.tolist())[1] for a in angles] for d in (theirs, ours)
    ]
    np.testing.assert_allclose(values[1], values[0], rtol=1e-6, atol=1e-9)
