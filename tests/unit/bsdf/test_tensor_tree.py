"""Tensor trees scatter, sample and average as the definition of their cells says."""

import numpy as np
import pytest
from scipy.stats import chisquare

from clerestory.bsdf.resample import tree_from
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.shirley_chiu import disc_from_square, square_from_disc

CELLS = 4  # along each axis of the grids below


def grid_tree(rank, seed=1):
    """Tree of random values, some of them zero, and its grid."""
    rng = np.random.default_rng(seed)
    grid = rng.random((CELLS,) * rank) ** 3 * (rng.random((CELLS,) * rank) < 0.8)
    table = parse_tree(f"{{ {' '.join(map(str, grid.ravel()))} }}".encode(), rank=rank)
    return ScatteringTree(table.slots, rank, table.depth), grid.astype(np.float32)


def direction(a, b, z=1.0):
    x, y = disc_from_square(np.asarray(a), np.asarray(b))
    return np.stack([x, y, z * np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)


def random_directions(count, seed):
    a, b = np.random.default_rng(seed).random((2, count))
    return direction(a, b)


def functions():
    """One function of each kind."""
    tree3, tree4 = grid_tree(3)[0], grid_tree(4)[0]
    basis = klems("quarter")
    table = np.random.default_rng(2).random((41, 41)) ** 3
    return {
        "rank 3": tree3,
        "rank 3 reversed": tree3.reciprocal(),
        "rank 4": tree4,
        "rank 4 reversed": tree4.reciprocal(),
        "matrix": ScatteringMatrix(table, basis, basis),
        "matrix reversed": ScatteringMatrix(table, basis, basis).reciprocal(),
    }


FUNCTIONS = functions()


def test_rank_4_cell_holds_opposite_incident_and_leaving_direction():
    tree, grid = grid_tree(4)
    place = np.random.default_rng(3).integers(0, CELLS, (4, 500))
    a = (place + np.random.default_rng(4).random((4, 500))) / CELLS
    incident, leaving = -direction(a[0], a[1]), direction(a[2], a[3])
    np.testing.assert_array_equal(tree.evaluate(incident, leaving), grid[tuple(place)])


def test_rank_3_cell_turns_with_the_azimuth_of_the_incident_direction():
    tree, grid = grid_tree(3)
    place = np.random.default_rng(5).integers(0, CELLS, (3, 500))
    place[0] %= CELLS // 2
    a = (place + np.random.default_rng(6).random((3, 500))) / CELLS
    radius, turn = 1 - 2 * a[0], np.random.default_rng(7).random(500) * 6
    out = direction(a[1], a[2])
    cos, sin = np.cos(turn), np.sin(turn)
    leaving = np.stack(
        [
            cos * out[:, 0] - sin * out[:, 1],
            sin * out[:, 0] + cos * out[:, 1],
            out[:, 2],
        ],
        axis=-1,
    )
    incident = -np.stack([radius * cos, radius * sin, np.sqrt(1 - radius**2)], axis=-1)
    np.testing.assert_array_equal(tree.evaluate(incident, leaving), grid[tuple(place)])


@pytest.mark.parametrize("name", ["rank 3", "rank 4"])
def test_reciprocal_exchanges_the_directions(name):
    incident, leaving = random_directions(500, 8), random_directions(500, 9)
    tree = FUNCTIONS[name]
    other = tree.reciprocal()
    np.testing.assert_array_equal(
        other.evaluate(incident, leaving), tree.evaluate(leaving, incident)
    )
    again = other.reciprocal()
    np.testing.assert_array_equal(
        again.evaluate(incident, leaving), tree.evaluate(incident, leaving)
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_hemispherical_share_is_the_integral_of_values(name):
    """Over a fine grid of equal projected solid angles."""
    part = FUNCTIONS[name]
    a, b = np.meshgrid(*[(np.arange(512) + 0.5) / 512] * 2)
    leaving = direction(a.ravel(), b.ravel())
    incident = random_directions(5, 10)
    share = part.hemispherical(incident)
    for i, one in zip(incident, share, strict=True):
        value = part.evaluate(np.broadcast_to(i, leaving.shape), leaving)
        assert one == pytest.approx(np.pi * value.mean(), rel=0.02)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_samples_pass_a_chi_squared_test(name):
    """Counts in 256 cells of equal projected solid angle against the integral."""
    part, count, fine = FUNCTIONS[name], 50_000, 32
    edge = (np.arange(16 * fine) + 0.5) / (16 * fine)
    a, b = np.meshgrid(edge, edge, indexing="ij")
    grid = direction(a.ravel(), b.ravel())
    for seed, incident in enumerate(random_directions(3, 11)):
        u = np.random.default_rng(seed).random((count, 2))
        leaving, _ = part.sample(np.broadcast_to(incident, (count, 3)), u)
        value = part.evaluate(np.broadcast_to(incident, grid.shape), grid)
        share = value.reshape(16, fine, 16, fine).sum(axis=(1, 3)).ravel() / value.sum()
        place = (np.stack(square_from_disc(*leaving[:, :2].T)) * 16).astype(int)
        place = np.clip(place, 0, 15)
        seen = np.bincount(place[0] * 16 + place[1], minlength=256)
        often = share * count > 10
        observed = [*seen[often], seen[~often].sum()]
        expected = np.array([*share[often], share[~often].sum()]) * count
        if expected[-1] < 10:
            observed, expected = observed[:-1], expected[:-1]
        expected *= np.sum(observed) / expected.sum()
        assert chisquare(observed, expected).pvalue > 1e-4


@pytest.mark.parametrize("name", FUNCTIONS)
def test_density_is_value_times_cosine_over_the_share(name):
    part = FUNCTIONS[name]
    incident = random_directions(60, 12)
    leaving, density = part.sample(incident, np.random.default_rng(13).random((60, 2)))
    share = part.hemispherical(incident)
    assert np.all(share > 0)
    truth = part.evaluate(incident, leaving) * leaving[:, 2] / share
    close = np.isclose(density, truth, rtol=1e-5)
    # A reversed rank 3 tree is sampled on a grid: cells that a border crosses differ
    assert np.mean(close) > (0.9 if name == "rank 3 reversed" else 0.98)
    np.testing.assert_allclose(np.linalg.norm(leaving, axis=1), 1, rtol=1e-12)


def test_where_nothing_is_scattered_the_density_is_zero():
    black = ScatteringTree(np.zeros(1, dtype=np.int32), 4, 0)
    leaving, density = black.sample(random_directions(4, 1), np.full((4, 2), 0.5))
    assert density.tolist() == [0, 0, 0, 0]
    np.testing.assert_array_equal(leaving, np.broadcast_to([0, 0, 1], (4, 3)))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_average_over_patches_is_the_mean_over_pairs_within_them(name):
    """Monte Carlo over directions within a few patches of another partition."""
    part, basis = FUNCTIONS[name], klems("full")
    table = part.average(basis, basis)
    rng = np.random.default_rng(14)
    for enter, leave in ((0, 0), (10, 77), (144, 3), (60, 120)):
        i = basis.sample(np.full(4000, enter), rng.random((4000, 2))) * [-1, -1, 1]
        o = basis.sample(np.full(4000, leave), rng.random((4000, 2)))
        value = part.evaluate(i, o)
        error = value.std() / 4000**0.5 + 1e-3 * value.mean() + 1e-9
        assert abs(table[leave, enter] - value.mean()) < 4.5 * error


@pytest.mark.parametrize("name", FUNCTIONS)
def test_average_conserves_flux(name):
    """π² times the mean of all values, whatever the patches."""
    part = FUNCTIONS[name]
    full, half = klems("full"), klems("half")
    flux = [
        exits.projected_solid_angles()
        @ part.average(exits, incidents)
        @ incidents.projected_solid_angles()
        for exits, incidents in ((full, full), (half, full), (half, half))
    ]
    assert flux[1:] == pytest.approx([flux[0]] * 2, rel=1e-9)


def test_matrix_to_tree_and_back_keeps_flux():
    matrix, basis = FUNCTIONS["matrix"], klems("quarter")
    tree = tree_from(matrix, 4)
    back = tree.average(basis, basis)
    lam = basis.projected_solid_angles()
    assert lam @ back @ lam == pytest.approx(lam @ matrix.values @ lam, rel=1e-7)
    even = ScatteringMatrix(np.full((41, 41), 0.2), basis, basis)
    assert tree_from(even, 3).depth == 0
    np.testing.assert_allclose(tree_from(even, 3).average(basis, basis), 0.2, rtol=1e-7)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_single_directions_are_as_good_as_many(name):
    part = FUNCTIONS[name]
    incident, leaving = random_directions(2, 15)
    assert part.hemispherical(incident).shape == ()
    assert part.resolution(incident, leaving).shape == ()
    assert part.evaluate(incident, leaving).shape == ()
    direction, density = part.sample(incident, np.array([0.3, 0.7]))
    assert (direction.shape, density.shape) == ((3,), ())
