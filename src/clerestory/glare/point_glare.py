"""Annual glare at a view point from sampled directions, for several view directions.

The luminances of the directions at all time steps are evaluated for each view direction
as a picture would be: with the rules of glare sources, the position indices and the
formulas of `evaluate_glare`. The sun's disc is one more direction, which moves.
"""

from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.checks import has_shape, one_of, require, same_length
from clerestory.glare.annual_glare import glare_dataset
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.direction_sources import direction_sources
from clerestory.glare.eye_directions import SunDisc, seen_by
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import REPORTED, Glare
from clerestory.glare.position_index import PositionModel
from clerestory.glare.sphere_samples import SphereSamples
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

_UP = np.array([0.0, 0.0, 1.0])


def point_glare(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    views: Sequence[View],
    *,
    sun: SunDisc | None = None,
    times: np.ndarray | None = None,
    rules: SourceRules | None = None,
    background: Background = "cie",
    low_light: bool = False,
    coefficients: DgpCoefficients = EVALGLARE,
    position_model: PositionModel = "guth",
    quantities: Collection[str] | None = None,
) -> "xr.Dataset":
    """Return the glare indices of each view direction at each time step.

    Parameters
    ----------
    samples : directions, as of `sample_sphere`
    luminance : luminance of each direction at each time step, without the sun's disc
        [cd/m²]
    views : views whose line of sight and up vector define the eye; the field of view is
        the hemisphere in front of it
    sun : the sun's disc, where it is seen directly
    times : time of each step, the coordinate "time" of the result; default: a
        coordinate "step"
    rules, background, low_light, coefficients, position_model : see `evaluate_glare`;
        a task zone and smoothing need a picture
    quantities : names of the indices and quantities that are computed, such as "dgp"
        and "illuminance"; default: all that pictures have

    Examples
    --------
    >>> from clerestory.glare.sphere_samples import regular_samples
    >>> samples = regular_samples(6)
    >>> window = np.linalg.norm(samples.direction - [0, 1, 0], axis=1) < 0.3
    >>> light = np.where(window[:, None], [5e3, 2e4], [100.0, 300.0])
    >>> point_glare(samples, light, views_around(4)).dgp.values.round(1)[0].tolist()
    [0.3, 0.6]
    """
    rules = rules or SourceRules()
    require(
        rules.task is None and not rules.smooth,
        "a task zone or smoothing with sampled directions; a picture expected",
    )
    steps = luminance.shape[1]
    has_shape(luminance, (samples.count, steps), "luminance of the directions")
    require(
        luminance.min(initial=0) >= 0 and np.isfinite(luminance.max(initial=0)),
        "luminance of the directions is negative or not finite; finite numbers of 0 or"
        " more expected",
    )
    require(views, "no views; at least one expected")
    if sun is None:
        sun = SunDisc(np.tile(_UP, (steps, 1)), np.zeros(steps), np.zeros(steps))
    same_length(sun.luminance, luminance.T, "suns", "time steps")
    if times is not None:
        same_length(times, luminance.T, "times", "time steps")
    for name in quantities or ():
        one_of(name, "glare quantity", choices=[one.name for one in REPORTED])
    settings = IndexSettings(background, None, low_light, None, coefficients)
    found = [
        [
            glare.values(quantities)
            for glare in _view_glare(
                samples, luminance, view, sun, rules, settings, position_model
            )
        ]
        for view in views
    ]
    dataset = glare_dataset(found, times)
    looks = np.array([view.direction for view in views])
    azimuth = np.degrees(np.arctan2(looks[:, 0], looks[:, 1])) % 360
    return dataset.assign_coords(azimuth=("view", azimuth, {"units": "degree"}))


def views_around(
    count: int = 8, *, position: Vector | None = None, first: float = 0.0
) -> list[View]:
    """Return horizontal fisheye views, clockwise from the azimuth `first` [rad]."""
    turns = first + np.arange(count) * (2 * np.pi / count)
    origin = np.zeros(3) if position is None else position
    return [
        View(
            "angular", origin, np.array([np.sin(turn), np.cos(turn), 0]), _UP, 180, 180
        )
        for turn in turns
    ]


def _view_glare(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    view: View,
    sun: SunDisc,
    rules: SourceRules,
    settings: IndexSettings,
    model: PositionModel,
) -> Iterator[Glare]:
    # Glare of one view at each time step
    eye, disc = seen_by(view, samples.direction), seen_by(view, sun.direction)
    omega = np.where(eye.ahead, samples.solid_angle, 0).astype(luminance.dtype)
    total = float(omega.sum())
    beam = np.where(disc.ahead & (sun.solid_angle > 0), sun.luminance, 0)
    flux = beam * sun.solid_angle
    average = (omega @ luminance + flux) / total
    weight = (samples.solid_angle * eye.cosine).astype(luminance.dtype)
    illuminance = weight @ luminance + flux * disc.cosine
    brightest = np.maximum(luminance[eye.ahead].max(axis=0, initial=0), beam)
    factor = average if rules.threshold_kind == "times_mean" else np.ones(average.size)
    tables = direction_sources(
        samples,
        luminance,
        view,
        sun=sun,
        threshold=rules.threshold * factor,
        rules=rules,
        model=model,
    )
    for step, sources in enumerate(tables):
        yield Glare(
            sources=sources.larger_than(rules.smallest),
            illuminance=float(illuminance[step]),
            average=float(average[step]),
            reference=float(average[step]),
            brightest=float(brightest[step]),
            solid_angle=total,
            settings=settings,
        )
