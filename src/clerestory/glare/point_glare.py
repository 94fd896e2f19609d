"""Annual glare at a view point from sampled directions, for several view directions.

The luminances of the directions at all time steps are evaluated for each view direction
as a picture would be: with the rules of glare sources, the position indices and the
formulas of `evaluate_glare`. The sun's disc is one more direction, which moves.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.checks import has_shape, one_of, require, same_length
from clerestory.glare.annual_glare import glare_dataset
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.direction_sources import SourceOptions, direction_sources
from clerestory.glare.eye_directions import EyeDirections, SunDisc, seen_by
from clerestory.glare.index import EyePhotometry
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import REPORTED, quantities_over_time
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
    eyes = [
        _Eye(samples, luminance, view, sun, rules, position_model) for view in views
    ]
    found = [quantities_over_time(eye.photometry(settings), quantities) for eye in eyes]
    dataset = glare_dataset(found, np.arange(steps) if times is None else times)
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


def view_along(direction: Vector, *, position: Vector) -> View:
    """Return a fisheye view along a direction, of which +y is up if it is vertical."""
    level = np.hypot(direction[0], direction[1])
    up = _UP if level > 1e-3 * abs(direction[2]) else np.array([0.0, 1.0, 0.0])
    return View("angular", position, direction, up, 180, 180)


@dataclass(frozen=True, eq=False)
class _Eye:
    # One view at all time steps

    samples: SphereSamples
    luminance: Float[np.ndarray, "direction step"]
    view: View
    sun: SunDisc
    rules: SourceRules
    model: PositionModel

    def photometry(self, settings: IndexSettings) -> EyePhotometry:
        # Photometric quantities at all time steps
        sources = direction_sources(
            self.samples, self.luminance, self.view, **self._how
        )
        brightest = self.luminance[self._eye.ahead].max(axis=0, initial=0)
        illuminance = self._illuminance()
        return EyePhotometry(
            sources=sources.larger_than(self.rules.smallest),
            illuminance=illuminance,
            average=self._average,
            reference=self._average,
            brightest=np.maximum(brightest, self._beam),
            eye_illuminance=illuminance,
            solid_angle=float(self._omega.sum()),
            settings=settings,
        )

    def _illuminance(self) -> Float[np.ndarray, " step"]:
        # Vertical illuminance at the eye [lux]
        weight = (self.samples.solid_angle * self._eye.cosine).astype(
            self.luminance.dtype
        )
        found = (weight @ self.luminance).astype(float)
        return np.asarray(found + self._flux * self._disc.cosine)

    @cached_property
    def _how(self) -> SourceOptions:
        factor = np.ones(self.luminance.shape[1])
        if self.rules.threshold_kind == "times_mean":
            factor = self._average
        return SourceOptions(
            sun=self.sun,
            threshold=self.rules.threshold * factor,
            rules=self.rules,
            model=self.model,
        )

    @cached_property
    def _eye(self) -> EyeDirections:
        return seen_by(self.view, self.samples.direction)

    @cached_property
    def _disc(self) -> EyeDirections:
        return seen_by(self.view, self.sun.direction)

    @cached_property
    def _omega(self) -> Float[np.ndarray, " direction"]:
        omega = np.where(self._eye.ahead, self.samples.solid_angle, 0)
        return np.asarray(omega.astype(self.luminance.dtype))

    @cached_property
    def _beam(self) -> Float[np.ndarray, " step"]:
        seen = self._disc.ahead & (self.sun.solid_angle > 0)
        return np.where(seen, self.sun.luminance, 0)

    @property
    def _flux(self) -> Float[np.ndarray, " step"]:
        return np.asarray(self._beam * self.sun.solid_angle)

    @cached_property
    def _average(self) -> Float[np.ndarray, " step"]:
        total = self._omega @ self.luminance + self._flux
        return np.asarray(total / float(self._omega.sum()))
