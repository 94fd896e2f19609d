"""Texts of tensor trees are read in any nesting, or refused where they are wrong."""

import numpy as np
import pytest

from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_lookup import cells
from clerestory.bsdf.tree_parser import MAX_DEPTH, parse_tree
from clerestory.bsdf.xml_writer import tree_lines
from clerestory.errors import InputError


def grid_of(tree):
    """All values on the finest cells, indexed by dimension."""
    grid = np.full((1 << tree.depth,) * tree.rank, np.nan)
    for level, place, value in cells(tree.slots, tree.rank):
        size = 1 << tree.depth - level
        for number, one in enumerate(value):
            grid[tuple(slice(p * size, (p + 1) * size) for p in place[:, number])] = one
    return grid


def read(text, rank):
    table = parse_tree(text.encode(), rank=rank)
    return ScatteringTree(table.slots, rank, table.depth)


def nested(grid):
    """Branches down to single values; dimension i is bit i of a branch."""
    if grid.size == 1:
        return f"{{ {grid.item()} }}"
    half = grid.shape[0] // 2
    parts = []
    for branch in range(1 << grid.ndim):
        bits = [branch >> dimension & 1 for dimension in range(grid.ndim)]
        parts.append(nested(grid[tuple(slice(b * half, (b + 1) * half) for b in bits)]))
    return "{\n" + "\n".join(parts) + "}"


@pytest.mark.parametrize("rank", [3, 4])
def test_grid_and_nested_branches_mean_the_same(rank):
    """A grid has its last dimension fastest (Radiance's bsdf_t.c)."""
    grid = np.random.default_rng(1).integers(0, 99, (4,) * rank).astype(float)
    flat = "{" + ", ".join(map(str, grid.ravel())) + "}"
    np.testing.assert_array_equal(grid_of(read(flat, rank)), grid)
    np.testing.assert_array_equal(grid_of(read(nested(grid), rank)), grid)


@pytest.mark.parametrize("rank", [3, 4])
def test_branches_of_different_size_stand_in_their_places(rank):
    rng = np.random.default_rng(2)
    small = "{" + " ".join(map(str, rng.random(1 << rank))) + "}"
    large = "{" + " ".join(map(str, rng.random(1 << 2 * rank))) + "}"
    branches = ["{7}"] * (1 << rank)
    branches[1], branches[-1] = small, large
    tree = read("{" + "".join(branches) + "}", rank)
    grid = grid_of(tree)
    assert tree.depth == 3
    assert grid.shape == (8,) * rank
    first = tuple(slice(4, 8) if axis == 0 else slice(0, 4) for axis in range(rank))
    last = (slice(4, 8),) * rank
    values = np.array(small.strip("{}").split(), dtype=np.float32)
    np.testing.assert_array_equal(
        grid[first],
        values.reshape((2,) * rank).repeat(2, 0).repeat(2, 1).repeat(2, 2)
        if rank == 3
        else np.kron(values.reshape((2,) * rank), np.ones((2,) * rank)),
    )
    values = np.array(large.strip("{}").split(), dtype=np.float32)
    np.testing.assert_array_equal(grid[last], values.reshape((4,) * rank))
    assert np.sum(grid == 7) == 8**rank - 2 * 4**rank


@pytest.mark.parametrize("digits", [None, 7])
def test_written_trees_read_the_same(digits):
    grid = np.random.default_rng(3).random((4,) * 4).astype(np.float32)
    grid[:2, :2, :2, :2] = 1e-9
    tree = read(nested(grid), 4)
    again = read("\n".join(tree_lines(tree, digits=digits)), 4)
    np.testing.assert_allclose(grid_of(again), grid, rtol=0 if digits is None else 1e-6)


@pytest.mark.parametrize("digits", [None, 4])
def test_short_numbers_are_the_same_numbers(digits):
    """2e-05 is written as 2e-5, 0.5 as .5, 10 as 10, without spaces at braces."""
    values = [2e-5, 3.5e-8, 0.5, 10, 1e5, 0, 0.25, 1, 7e-4, 20, 3e10, 0.1, 10.5, 2e-12]
    values = np.array([*values, 100.0, 0.02], dtype=np.float32)
    tree = ScatteringTree(np.concatenate([[-2], values.view("i4")]).astype("i4"), 4, 1)
    text = "\n".join(tree_lines(tree, digits=digits))
    assert not {"e-0", " 0.", "{ "} & {
        text[i : i + 3][:n] for i in range(99) for n in (2, 3)
    }
    assert parse_tree(text.encode(), rank=4).slots.tolist() == tree.slots.tolist()


def test_values_that_cross_the_borders_of_chunks_are_whole(monkeypatch):
    grid = np.random.default_rng(4).random((4,) * 4)
    text = nested(grid)
    whole = read(text, 4)
    for size in (150, 151, 1000):
        monkeypatch.setattr("clerestory.bsdf.tree_scanner._CHUNK", size)
        np.testing.assert_array_equal(read(text, 4).slots, whole.slots)


def test_negative_values_become_zero_and_are_counted():
    table = parse_tree(b"{ -1 1 1 1 1 1 1 1 }", rank=3)
    assert table.negative == pytest.approx(1 / 8)
    tree = ScatteringTree(table.slots, 3, table.depth)
    assert tree.extrema() == (0.0, 1.0)
    assert parse_tree(b"{ -0.0 }", rank=4).slots.tolist() == [0]


FAULTS = {
    "no braces": ("1 2 3", "after the last brace of a tensor tree", 1),
    "nothing": ("", "no tensor tree", 1),
    "no end": ("{{1}\n{2}", "the last brace '}' of a tensor tree is missing", 1),
    "an early end": ("{1}\n}", "text after the end of a tensor tree", 1),
    "two trees": ("{1}\n{2}", "text after the end of a tensor tree", 1),
    "values after": ("{1}\n5", "values after", 2),
    "an empty leaf": ("{}", "0 values", 1),
    "five values": ("{\n1 2 3 4 5}", "5 values in a branch of a rank 3", 1),
    "seven branches": ("\n{" + "{1}" * 7 + "}", "7 branches in a rank 3", 2),
    "nine branches": ("{" + "{1}" * 9 + "}", "9 branches", 1),
    "a value among branches": (
        "{{1}{1}\n5{1}{1}{1}{1}{1}{1}}",
        "values and branches in the same braces",
        2,
    ),
    "not a number": ("{1 1 1 1\n1 1 nan 1}", "'nan'", 2),
    "infinity": ("{inf}", "'inf'", 1),
    "overflow": ("{1e39}", "'1e39'", 1),
    "a word": ("{\n\nzero}", "'zero'", 3),
    "an underscore": ("{1_0}", "'1_0'", 1),
    "other letters": ("{½}", "a finite number expected", 1),
    "a long word": ("{" + "1" * 500 + "}", "a finite number expected", 1),
    "deep nesting": ("{" * 10**6 + "1" + "}" * 10**6, "999999 nested levels", 1),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_text_is_refused_with_its_line(fault):
    text, message, line = FAULTS[fault]
    with pytest.raises(InputError) as caught:
        parse_tree(text.encode(), rank=3, file="t.xml", line=10)
    assert message in str(caught.value)
    assert caught.value.line == 9 + line


def test_more_halvings_than_the_limit_are_refused():
    branch = "{1}"
    for _ in range(MAX_DEPTH + 1):
        branch = "{" + branch + "{1}" * 7 + "}"
    with pytest.raises(InputError, match="nested levels"):
        parse_tree(branch.encode(), rank=3)


@pytest.mark.parametrize(
    "slots", [[], [-1], [-2], [-2, 0, 0, 0, 0, 0, 0, 0], [np.float32("nan").view("i4")]]
)
def test_slots_that_are_no_tree_are_refused(slots):
    with pytest.raises(InputError):
        ScatteringTree(np.array(slots, dtype=np.int32), 3, 1)
