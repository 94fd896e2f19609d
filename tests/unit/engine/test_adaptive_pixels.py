"""Adaptive pixel sampling: allocation of paths, unbiased pixels and honest errors."""

import numpy as np
import pytest

from clerestory.engine.adaptive_pixels import traced_rounds
from clerestory.engine.effort import Effort
from clerestory.engine.pixel_allocation import Allocation, mean_of_neighbours
from clerestory.engine.pixel_goals import PixelEstimates, RelativePixelError
from clerestory.engine.radiance_jobs import PictureJob
from clerestory.engine.work_units import Local
from clerestory.scene.model import Scene
from clerestory.scene.view import View

COLUMNS, ROWS = 60, 40
GREY = 3


class Paths(Local):
    """Sums of independent paths of mean 1, whose deviation is given for each pixel."""

    def __init__(self, deviation, seed=7):
        super().__init__()
        self.deviation, self.random = deviation.ravel(), np.random.default_rng(seed)

    def map(self, job, units):
        for unit in units:
            # Gamma distribution: few paths carry most of the light
            form = self.deviation[unit.rows][:, None] ** -2.0
            shape = len(unit.rows), job.batches
            total = self.random.gamma(form * unit.count, 1 / form, shape)
            yield np.repeat(total[:, :, None, None], GREY, axis=3)


def job():
    view = View(kind="perspective")
    return PictureJob(
        scene=Scene(), view=view, columns=COLUMNS, rows=ROWS, batches=8, seed=1,
        device="cpu",
    )  # fmt: skip


def traced(deviation, *, seed=7, **goal):
    """Return the last round, and the estimates of the pixels."""
    executor = Paths(deviation, seed)
    *_, last = rounds(executor, **goal)
    return last, PixelEstimates.of(last.sums, job())


def rounds(executor, *, samples=None, relative_error=None):
    goal = RelativePixelError(relative_error) if relative_error else None
    effort = Effort(executor=executor, device="cpu", samples=samples)
    return traced_rounds(job(), effort, goal)


def split(noisy=8.0, quiet=0.5):
    """A quarter of the picture is noisy."""
    deviation = np.full((ROWS, COLUMNS), quiet)
    deviation[:, : COLUMNS // 4] = noisy
    return deviation


@pytest.mark.parametrize("aim", [0.2, 0.05, 0.01])
def test_the_target_is_reached_where_paths_are_distributed(aim):
    last, pixels = traced(split(), relative_error=aim)
    assert last.reached
    assert RelativePixelError(aim).error(pixels) < 1.1
    truth = np.sqrt(np.mean((pixels.value - 1) ** 2))
    assert 0.9 < truth / np.sqrt(pixels.variance.mean()) < 1.1


def test_paths_are_proportional_to_the_deviations():
    """Sum of variances at a cost: independent paths need (Σ σ)²/Σ n, at best."""
    deviation = split()
    last, pixels = traced(deviation, relative_error=0.02)
    count = last.sums.count.reshape(ROWS, COLUMNS)
    assert count[:, 2:10].mean() > 6 * count[:, 20:].mean()
    paths = 8 * count.mean()
    best = deviation.mean() ** 2 / pixels.variance[..., 0].mean()
    equal = np.mean(deviation**2) / pixels.variance[..., 0].mean()
    assert best < paths < 1.35 * best < 0.6 * equal


def test_pixels_are_unbiased_though_few_paths_carry_their_light():
    """Numbers of paths do not depend on the samples of the pixel itself.

    A pixel of standard deviation 8 that has seen no bright path in its first 32 would
    otherwise keep them: the mean of the picture would be 10 % too small.
    """
    values, variances = [], []
    for seed in range(20):
        _, pixels = traced(np.full((ROWS, COLUMNS), 8.0), seed=seed, relative_error=0.5)
        values.append(pixels.value[..., 0])
        variances.append(pixels.variance[..., 0])
    error = np.sqrt(np.mean(variances) / np.size(values))
    assert error < 0.004
    assert abs(np.mean(values) - 1) < 4 * error
    scatter = np.mean((np.array(values) - 1) ** 2)
    assert 0.8 < np.sqrt(np.mean(variances) / scatter) < 1.25


def test_samples_are_the_same_for_all_pixels():
    last, _ = traced(split(), samples=100)
    assert last.reached
    assert (last.sums.count == 13).all()


def test_the_first_rounds_are_coarse():
    blocks, traced_pixels = [], []
    for each in rounds(Paths(split()), samples=64):
        blocks.append(each.block)
        traced_pixels.append(np.count_nonzero(each.sums.count))
    assert blocks == [8, 4, 2, 1, 1]
    assert traced_pixels == [5 * 8, 10 * 15, 20 * 30, 2400, 2400]


def test_a_black_picture_is_complete():
    deviation = np.full((ROWS, COLUMNS), 1.0)

    class Dark(Paths):
        def map(self, job, units):
            return (0 * part for part in super().map(job, units))

    *_, last = rounds(Dark(deviation), relative_error=0.01)
    assert last.reached
    assert last.sums.count.max() <= 8


def test_the_allocation_of_a_pixel_ignores_the_pixel():
    values = np.random.default_rng(3).lognormal(size=(9, 11))
    changed = values.copy()
    changed[4, 5] = 1e6
    before, after = mean_of_neighbours(values), mean_of_neighbours(changed)
    assert after[4, 5] == pytest.approx(before[4, 5])
    assert after[4, 6] > 1e3 * before[4, 6]


def test_a_noisy_pixel_among_quiet_ones_has_more_paths_in_the_end():
    deviation = np.full((ROWS, COLUMNS), 0.01)
    deviation[20, 30] = 8.0
    last, _ = traced(deviation, relative_error=0.01)
    assert last.reached
    assert last.sums.count[20 * COLUMNS + 30] >= 16


def test_one_pixel_is_sampled():
    allocation = Allocation.of(np.array([[3.0]]))
    assert allocation.doublings(2.0, 10).tolist() == [2]
