"""Partitions of the hemisphere: they fill it and count as their peers do."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from clerestory.errors import InputError
from clerestory.hemisphere.klems import from_rings, klems
from clerestory.hemisphere.reinhart import reinhart

BASES = ["full", "half", "quarter"]


@pytest.mark.parametrize(
    ("basis", "count"), [("full", 145), ("half", 77), ("quarter", 41)]
)
def test_klems_bases_have_the_patches_of_window(basis, count):
    """WINDOW's counts; 77 is today's half basis."""
    assert len(klems(basis)) == count


@pytest.mark.parametrize(
    ("subdivision", "count"),
    [(1, 145), (2, 577), (3, 1297), (4, 2305), (5, 3601), (6, 5185)],
)
def test_skies_have_reinharts_patches_and_the_ground(subdivision, count):
    """Counts of design and of Radiance's reinhart.cal."""
    assert len(reinhart(subdivision)) == count + 1


@pytest.mark.parametrize("basis", BASES)
def test_partitions_with_the_same_patches_are_equal(basis):
    one, other = klems(basis), replace(klems(basis), name="of a file")
    assert one == other
    assert len({one, other, *map(klems, BASES)}) == len(BASES)
    assert one != replace(one, azimuth="compass")
    assert one != replace(one, theta=one.theta * (1 - 1e-9))
    assert one != basis


@pytest.mark.parametrize("basis", BASES)
def test_patches_fill_the_hemisphere(basis):
    """Solid angles sum to 2π, projected ones to π."""
    partition = klems(basis)
    assert partition.solid_angles().sum() == pytest.approx(2 * np.pi)
    assert partition.projected_solid_angles().sum() == pytest.approx(np.pi)


@pytest.mark.parametrize("partition", [klems(b) for b in BASES] + [reinhart(3).dome])
def test_solid_angles_are_the_share_of_random_directions(partition):
    """Directions drawn evenly fall into patches in proportion."""
    directions = stats.uniform_direction(3, seed=5).rvs(400_000)
    directions[:, 2] = np.abs(directions[:, 2])
    counts = np.bincount(partition.find(directions), minlength=len(partition))
    expected = partition.solid_angles() / (2 * np.pi) * len(directions)
    assert stats.chisquare(counts, expected).pvalue > 1e-4


@pytest.mark.parametrize("partition", [klems(b) for b in BASES] + [reinhart(2).dome])
def test_what_is_drawn_in_a_patch_is_found_in_it(partition):
    """Centres and samples."""
    every = np.arange(len(partition))
    assert np.array_equal(partition.find(partition.centres()), every)
    u = np.random.default_rng(6).random((len(every), 50, 2))
    patch = np.repeat(every[:, None], 50, axis=1)
    assert np.array_equal(partition.find(partition.sample(patch, u)), patch)


def test_klems_patches_count_from_the_right_upwards():
    """Patch 1 of the full basis lies right of the pole, patch 3 above it."""
    centres = klems("full").centres()
    assert centres[1][0] > 0.1
    assert centres[1][1] == pytest.approx(0)
    assert centres[3][1] > 0.1
    assert centres[3][0] == pytest.approx(0)


def test_sky_patches_count_from_north_clockwise():
    """Row 1 starts at north; the second patch lies to the east of it."""
    centres = reinhart(1).centres()
    assert centres[0].tolist() == [0, 0, -1]
    assert centres[1][1] > 0.9
    assert centres[2][0] > 0.1
    assert centres[145].tolist() == pytest.approx([0, 0, 1])


def test_directions_below_the_rim_are_in_no_patch():
    """But in the sky's they are ground."""
    down = np.array([[0.0, 0.6, -0.8]])
    assert klems("full").find(down).tolist() == [-1]
    assert reinhart(1).find(down).tolist() == [0]


@pytest.mark.parametrize(
    ("limits", "count"),
    [([0, 10, 5, 90], [1, 4, 8]), ([0, 45], [4]), ([0, 45, 90], [1]), ([5, 90], [3])],
)
def test_rings_that_do_not_make_a_hemisphere_are_refused(limits, count):
    """Ring limits come from files."""
    with pytest.raises(InputError):
        from_rings("odd", limits_deg=np.array(limits, float), count=np.array(count))


def test_unknown_names_list_what_there_is():
    """One line with the choices."""
    with pytest.raises(InputError, match="full, half, quarter"):
        klems("double")
    with pytest.raises(InputError, match="1 to 6"):
        reinhart(7)
