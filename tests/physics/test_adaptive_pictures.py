"""Pictures rendered to a target error: known radiance, order of units, scatter."""

import numpy as np
import pytest

import clerestory as cl
from clerestory.engine.work_units import Local
from clerestory.scene.model import Light, Plastic, Polygon, Scene

# A floor below a lamp of 1 × 1 m, 1 m above it
REFLECTANCE, RADIANCE = 0.5, 10.0
VIEW = "-vtv -vp 0 -3 .8 -vd 0 1 -.3 -vu 0 0 1 -vh 60 -vv 32"
SIZE = {"columns": 24, "rows": 12}


def lamp_above_a_floor():
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    floor = np.column_stack([square * 40, np.zeros(4)])
    lamp = np.column_stack([square / 2, np.ones(4)])[::-1]
    surfaces = Polygon(floor, "grey", "floor"), Polygon(lamp, "bright", "lamp")
    materials = {
        "grey": Plastic("grey", np.full(3, REFLECTANCE)),
        "bright": Light("bright", np.full(3, RADIANCE)),
    }
    return Scene(materials, surfaces)


def floor_radiance(view, points=8):
    """Mean radiance of each pixel, by quadrature over the lamp and the pixel."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    x, y = np.meshgrid(nodes / 2, nodes / 2)
    area = np.outer(weights, weights) / 4
    inside = (np.arange(points) + 0.5) / points
    total = np.zeros((SIZE["rows"], SIZE["columns"]))
    for place in np.stack(np.meshgrid(inside, inside), axis=-1).reshape(-1, 2):
        rays = view.rays(**SIZE, jitter=np.broadcast_to(place, (*total.shape, 2)))
        length = -rays.origin[..., 2] / rays.direction[..., 2]
        at = rays.origin + rays.direction * length[..., None]
        square = (at[..., 0, None, None] - x) ** 2 + (at[..., 1, None, None] - y) ** 2
        irradiance = RADIANCE * np.sum(area / (1 + square) ** 2, axis=(-2, -1))
        total += irradiance * REFLECTANCE / np.pi
    return total / points**2


def test_pixels_reach_the_target_around_the_known_radiance(device):
    view, aim = cl.parse_view(VIEW), 0.004
    truth = floor_radiance(view)
    made = cl.render(
        lamp_above_a_floor(), view, **SIZE, relative_error=aim, device=device
    )
    value, error = made.picture.radiance[..., 1], made.error[..., 1]
    assert np.sqrt(np.mean(error**2)) < 1.1 * aim * truth.mean()
    deviation = np.sqrt(np.mean((value - truth) ** 2))
    assert 0.8 < np.sqrt(np.mean(error**2)) / deviation < 1.25
    mean_error = np.sqrt(np.sum(error**2)) / error.size
    assert abs(value.mean() - truth.mean()) < 4 * mean_error


class Reversed(Local):
    """An executor whose units are traced from the last to the first."""

    def map(self, job, units):
        traced = [self.run(job, unit) for unit in reversed(list(units))]
        yield from reversed(traced)


def test_the_order_of_units_does_not_change_a_bit():
    effort = {"relative_error": 0.01, "device": "cpu"}
    scene, view = lamp_above_a_floor(), cl.parse_view(VIEW)
    one = cl.render(scene, view, **SIZE, **effort)
    two = cl.render(scene, view, **SIZE, **effort, executor=Reversed())
    assert one.paths == two.paths
    assert (one.picture.radiance == two.picture.radiance).all()
    assert (one.error == two.error).all()


def test_a_picture_is_refined_from_blocks_to_the_same_bits():
    effort = {"relative_error": 0.02, "device": "cpu"}
    scene, view = lamp_above_a_floor(), cl.parse_view(VIEW)
    pictures = list(cl.render_progressively(scene, view, **SIZE, **effort))
    first = pictures[0].picture.radiance
    assert (first[:8, :8] == first[0, 0]).all()
    assert (first[8:, 16:] == first[8, 16]).all()
    assert (pictures[1].picture.radiance[:8, :8] == first[0, 0]).all(axis=-1).sum() < 64
    paths = [each.paths for each in pictures]
    assert paths == sorted(paths)
    last = cl.render(scene, view, **SIZE, **effort)
    assert (pictures[-1].picture.radiance == last.picture.radiance).all()
    assert pictures[-1].paths == last.paths


@pytest.mark.slow
def test_adaptive_pictures_scatter_as_stated():
    """The lamp is in the view: paths differ from pixel to pixel."""
    found = []
    for seed in range(24):
        made = cl.render(
            lamp_above_a_floor(), cl.parse_view("-vta -vp .3 -.6 .3 -vd 0 1 0 -vh 180"
            " -vv 180"), columns=20, rows=20, relative_error=0.02, seed=seed,
            device="cpu",
        )  # fmt: skip
        found.append((made.picture.radiance[..., 1], made.error[..., 1]))
    values, errors = (np.array(part) for part in zip(*found, strict=True))
    scatter = np.sqrt(values.var(axis=0, ddof=1).mean())
    assert 0.8 < np.sqrt(np.mean(errors**2)) / scatter < 1.25
