"""Sampling of whole BSDFs: every function, matrices and trees, by chi squared."""

import numpy as np
import pytest
from scipy.stats import chisquare

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.shirley_chiu import disc_from_square, square_from_disc

COUNT = 30_000  # directions a test
CELLS, FINE = 10, 50  # cells of the histogram along an axis, points in each


def random_matrix(seed):
    basis = klems("quarter")
    table = np.random.default_rng(seed).uniform(0.02, 1, (41, 41)) ** 2
    return ScatteringMatrix(table, basis, basis)


def random_tree(rank, seed):
    """Cells of two sizes, a fifth of them black."""
    rng = np.random.default_rng(seed)
    branches = []
    for _ in range(1 << rank):
        size = 1 << rank * int(rng.integers(0, 2))
        values = rng.random(size) ** 3 * (rng.random(size) < 0.8)
        branches.append(f"{{ {' '.join(map(str, values))} }}")
    table = parse_tree(f"{{ {' '.join(branches)} }}".encode(), rank=rank)
    return ScatteringTree(table.slots, rank, table.depth)


KINDS = {
    "matrix": random_matrix,
    "tree of rank 3": lambda seed: random_tree(3, seed),
    "tree of rank 4": lambda seed: random_tree(4, seed),
}


def layer(kind):
    """A BSDF whose four functions have nothing in common."""
    return Bsdf({("visible", name): KINDS[kind](k) for k, name in enumerate(FUNCTIONS)})


def sides(function):
    """Signs of z of the incident and of the leaving direction."""
    incident = -1 if function.endswith("front") else 1
    return incident, -incident if function.startswith("trans") else incident


def lifted(a, b, side):
    x, y = disc_from_square(a, b)
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    return np.stack([x, y, side * z], axis=-1)


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_directions_follow_the_values(kind, function):
    """Counts in cells of equal projected solid angle against the integral of values."""
    bsdf = layer(kind)
    enter, leave = sides(function)
    edge = (np.arange(CELLS * FINE) + 0.5) / (CELLS * FINE)
    grid = lifted(*(c.ravel() for c in np.meshgrid(edge, edge, indexing="ij")), leave)
    rng = np.random.default_rng(FUNCTIONS.index(function))
    for incident in lifted(*rng.random((2, 2)), enter):
        many = np.broadcast_to(incident, (COUNT, 3))
        u = rng.random((COUNT, 2))
        leaving, density = bsdf.sample(many, u, function=function)
        assert np.all(leaving[:, 2] * leave > 0)

        # Compare with the shares of light, by values that were evaluated
        light = bsdf.evaluate(incident, grid).reshape(CELLS, FINE, CELLS, FINE)
        share = light.sum(axis=(1, 3)).ravel() / light.sum()
        place = (np.stack(square_from_disc(*leaving[:, :2].T)) * CELLS).astype(int)
        place = np.clip(place, 0, CELLS - 1)
        seen = np.bincount(place[0] * CELLS + place[1], minlength=CELLS**2)
        often = share * COUNT > 15
        observed, expected = seen[often], share[often]
        expected = expected * observed.sum() / expected.sum()
        assert chisquare(observed, expected).pvalue > 1e-4
        assert abs(seen[often].sum() / COUNT - share[often].sum()) < 0.01

        # The density is what was promised
        total = bsdf.hemispherical(incident, function=function)
        truth = bsdf.evaluate(many, leaving) * np.abs(leaving[:, 2]) / total
        assert np.mean(np.isclose(density, truth, rtol=1e-5)) > 0.99


@pytest.mark.parametrize("kind", KINDS)
def test_the_density_of_all_directions_is_one(kind):
    """The mean of 1/density over the samples is the solid angle that light reaches."""
    bsdf = layer(kind)
    incident = lifted(np.array([0.3]), np.array([0.6]), -1)[0]
    rng = np.random.default_rng(9)
    many = np.broadcast_to(incident, (COUNT, 3))
    leaving, density = bsdf.sample(
        many, rng.random((COUNT, 2)), function="reflection_front"
    )
    assert np.all(density > 0)
    cosine_over_density = np.abs(leaving[:, 2]) / density
    edge = (np.arange(400) + 0.5) / 400
    grid = lifted(*(c.ravel() for c in np.meshgrid(edge, edge)), -1)
    lit = np.pi * np.mean(bsdf.evaluate(incident, grid) > 0)
    error = cosine_over_density.std() / COUNT**0.5
    assert abs(cosine_over_density.mean() - lit) < 4.5 * error + 0.01 * lit
