"""Radiance of bundles of given rays: the mean over the rays."""

import numpy as np
import pytest
from physics_scenes import quad, window

from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.sky_views import sky_view_matrices
from clerestory.scene.model import Scene
from clerestory.scene.ray_bundles import RayBundles

RAYS = 9


def fan():
    """Bundles of 9 upward rays, of which 0 to 9 go to positive x."""
    side = np.where(np.arange(RAYS) < np.arange(RAYS + 1)[:, None], 1.0, -1.0)
    up = np.ones_like(side)
    return RayBundles(np.zeros((RAYS + 1, RAYS, 3)), np.stack([side, 0 * up, up], -1))


@pytest.mark.parametrize("samples", [2 * RAYS, 8 * RAYS])
def test_each_ray_of_a_bundle_has_the_same_share(device, samples):
    """The window is above x > 0, and the paths of a bundle are a multiple of 9."""
    corners = (0, -9, 1), (0, 9, 1), (9, 9, 1), (9, -9, 1)
    found = picture_view_matrices(
        Scene({}, ()), [window(quad(*corners), up=(0, 1, 0))], fan(),
        samples=samples, device=device,
    )  # fmt: skip
    share = np.arange(RAYS + 1) / RAYS
    assert found["south"].values[0].sum(axis=1) == pytest.approx(share, abs=1e-6)


@pytest.mark.parametrize("samples", [2, 10, 16, 24])
def test_rays_of_bundles_are_chosen_without_bias(device, samples):
    """Also where the number of paths is no multiple of that of rays."""
    one, many = fan().select(slice(1, 2)), 2000
    both = (np.tile(a, (many, 1, 1)) for a in (one.origin, one.direction))
    bundles = RayBundles(*both)
    values = sky_view_matrices(
        Scene({}, ()), bundles, subdivision=1, samples=samples, device=device
    )[0].values[0]
    patch = values.sum(axis=0).argsort()[-2:]
    less = values[:, patch].mean(axis=0).min()
    bound = 4 * np.sqrt((1 / RAYS) * (1 - 1 / RAYS) / (many * samples))
    assert less == pytest.approx(1 / RAYS, abs=bound)


def test_rays_without_a_direction_have_no_radiance(device):
    """As a pixel of which a third is outside the circle of a fisheye view."""
    up = np.array([[[0, 0, 1.0], [0, 0, 0], [0, 0, 2]]])
    far = np.array([[[5.0, 5, 0], [0, 0, 0], [5, 5, 0]]])
    bundles = RayBundles(far, up)
    assert bundles.position.tolist() == [5, 5, 0]
    values = sky_view_matrices(
        Scene({}, ()), bundles, subdivision=1, samples=12, device=device
    )[0].values[0]
    assert values.sum() == pytest.approx(2 / 3, abs=1e-6)
