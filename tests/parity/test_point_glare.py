"""Glare from sampled directions against evalglare on 800² pictures of the same room."""

import numpy as np
import pytest
from evalglare import evalglare

from analytic_room import analytic_room
from clerestory.glare.point_glare import point_glare, views_around
from clerestory.glare.sphere_refinement import Refinement, sample_sphere
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture

# Largest difference of each index from evalglare's, in a step
TOLERANCE = {"dgp": 0.02, "ugr": 1.0, "dgi": 1.0, "ugp": 0.03, "cgi": 1.0}


@pytest.mark.parametrize("kind", ["window", "slats", "sky"])
def test_indices_of_sampled_directions_are_those_of_evalglare(tmp_path, kind):
    """Three steps in three views: each index, and the mean difference of DGP."""
    room, views = (
        analytic_room(kind, steps=3, seed=8),
        views_around(8)[-1:] + views_around(2),
    )
    fine = Refinement(tolerance=0.0005, most=12_000)
    samples = sample_sphere(room.of_samples, views, refinement=fine).centred()
    light = room.luminance(samples.direction)
    found = point_glare(samples, light, views, sun=room.disc())
    errors = {name: [] for name in TOLERANCE}
    for number, view in enumerate(views):
        rays = view.rays(800, 800)
        level = room.picture(rays.direction[rays.valid])
        for step in range(3):
            pixels = np.zeros((800, 800, 3), dtype=np.float32)
            pixels[rays.valid] = level[:, step, None] / 179
            path = tmp_path / "view.hdr"
            write_picture(Picture(pixels, view=view), path)
            summary = evalglare(path).summary
            ours = found.isel(view=number, step=step)
            # The disc has 62 pixels, give or take three
            assert float(ours.illuminance) == pytest.approx(summary["E_v"], rel=0.05)
            for name, each in errors.items():
                each.append(float(ours[name]) - summary[name])
    for name, most in TOLERANCE.items():
        assert np.abs(errors[name]).max() < most, name
    assert np.abs(errors["dgp"]).mean() < 0.005
