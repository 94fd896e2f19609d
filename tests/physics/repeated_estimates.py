"""Repeated estimates of one irradiance, against a closed form.

Sensors in one place have independent random numbers, as independent seeds.
"""

import numpy as np
from caustic_scenes import SUN_DEG

from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

SEEDS, SAMPLES = 40, 8192
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))

# Error of float32 arithmetic, relative to the value
_ROUNDING = 2e-5


def repeated(scene, place, normal, device, *, samples=SAMPLES):
    """Irradiance of independent sensors in one place, and their errors."""
    many = Sensors(np.tile(place, (SEEDS, 1)), np.tile(normal, (SEEDS, 1)))
    found = irradiance(scene, many, samples=samples, device=device)
    return found.irradiance[:, 0], found.error[:, 0]


def by_chance(truth):
    """Variance of one path that finds the sun by cosine-distributed directions.

    They find the sun with at most the probability p that is the irradiance over π
    times the radiance of the sun, and then have the value truth/p.
    """
    return truth * np.pi / SUN_SR - truth**2


def agrees(scene, place, normal, truth, device, *, samples=SAMPLES, variance=None):
    """Check mean and error bars, and a variance 50 times below that by chance."""
    value, error = repeated(scene, place, normal, device, samples=samples)
    scatter = np.hypot(value.std(ddof=1), _ROUNDING * truth)
    shown = np.hypot(np.sqrt(np.mean(error**2)), _ROUNDING * truth)
    assert abs(value.mean() - truth) < 4 * scatter / np.sqrt(SEEDS) + 1e-3 * truth
    assert abs(value.mean() - truth) < 0.01 * truth
    assert 0.7 < shown / scatter < 1.4
    assert (
        np.mean(np.abs(value - truth) > 3 * np.hypot(error, _ROUNDING * truth)) <= 0.1
    )
    without = by_chance(truth) if variance is None else variance
    assert scatter**2 < without / samples / 50
