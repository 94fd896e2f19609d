"""Table of glare sources, from which glare indices are computed.

A table contains the sources of one picture, or of many pictures or time steps, whose
indices are then computed together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.checks import require


@dataclass(frozen=True, eq=False)
class GlareSources:
    """Glare sources of a field of view, at one or more time steps.

    Attributes
    ----------
    luminance : mean luminance of the source [cd/m²]
    solid_angle : solid angle of the source [sr]
    position_index, sigma, direction, row, column : position index, angle from the line
        of sight [rad], unit vector, row and column of the centre of the source, which
        is weighted by luminance and solid angle
    illuminance : vertical illuminance at the eye from the source [lux]
    zone : zone number: 0 outside of all zones, 1 inner zone, 2 outer zone
    luminance_error : standard error of the mean luminance, 0 if unknown [cd/m²]
    step : index of the time step of each source
    steps : number of time steps

    >>> lamp = GlareSources.of(luminance=[5000], solid_angle=[0.01], position_index=[2])
    >>> lamp.count
    1
    """

    luminance: Float[np.ndarray, " source"]
    solid_angle: Float[np.ndarray, " source"]
    position_index: Float[np.ndarray, " source"]
    sigma: Float[np.ndarray, " source"]
    direction: Float[np.ndarray, "source 3"]
    illuminance: Float[np.ndarray, " source"]
    pixels: Int[np.ndarray, " source"]
    row: Float[np.ndarray, " source"]
    column: Float[np.ndarray, " source"]
    zone: Int[np.ndarray, " source"]
    luminance_error: Float[np.ndarray, " source"]
    step: Int[np.ndarray, " source"]
    steps: int = field(default=1, kw_only=True)

    __repr__ = brief

    def __post_init__(self) -> None:
        lengths = {len(getattr(self, name)) for name in _NAMES}
        require(
            len(lengths) == 1,
            f"arrays of glare sources have lengths {sorted(lengths)}; one length"
            " expected",
        )

    @classmethod
    def of(
        cls,
        *,
        luminance: ArrayLike,
        solid_angle: ArrayLike,
        position_index: ArrayLike,
        sigma: ArrayLike | None = None,
    ) -> "GlareSources":
        """Return sources of given luminance and solid angle, such as luminaires.

        The vertical illuminance is computed for small sources at the angle `sigma` from
        the line of sight [rad]; default: 0.
        """
        bright, omega, index = (
            np.asarray(values, dtype=float)
            for values in (luminance, solid_angle, position_index)
        )
        angle = np.zeros(bright.shape) if sigma is None else np.asarray(sigma, float)
        nothing, none = np.zeros(bright.size), np.zeros(bright.size, dtype=np.int64)
        return cls(
            luminance=bright,
            solid_angle=omega,
            position_index=index,
            sigma=angle,
            direction=np.zeros((bright.size, 3)),
            illuminance=bright * omega * np.maximum(np.cos(angle), 0),
            pixels=none,
            row=nothing,
            column=nothing,
            zone=none,
            luminance_error=nothing,
            step=none,
        )

    @classmethod
    def joined(cls, tables: Sequence["GlareSources"]) -> "GlareSources":
        """Return the sources of several tables, whose time steps follow each other."""
        first = np.cumsum([0, *(table.steps for table in tables)])
        parts = {
            name: np.concatenate([getattr(table, name) for table in tables])
            for name in _NAMES
        }
        parts["step"] += np.repeat(first[:-1], [table.count for table in tables])
        return cls(**parts, steps=int(first[-1]))

    @property
    def count(self) -> int:
        """Number of sources."""
        return int(self.luminance.size)

    @cached_property
    def counts(self) -> Int[np.ndarray, " step"]:
        """Number of sources at each time step."""
        return np.bincount(self.step, minlength=self.steps)

    def totals(
        self, values: Float[np.ndarray, " source"]
    ) -> Float[np.ndarray, " step"]:
        """Return the sum of values of the sources at each time step."""
        return np.bincount(self.step, values, self.steps).astype(float)

    def at_source(self, values: Values | float) -> Float[np.ndarray, " source"]:
        """Return the value of the time step of each source."""
        every = np.broadcast_to(np.asarray(values, dtype=float), self.steps)
        return np.asarray(every[self.step])

    def weight(self) -> Float[np.ndarray, " source"]:
        """L²ω/P² of each source, as summed in UGR, CGI and UGP [cd²/m⁴·sr]."""
        apparent = self.luminance / self.position_index
        return np.asarray(apparent**2 * self.solid_angle)

    def guth_solid_angle(self) -> Float[np.ndarray, " source"]:
        """Solid angle of each source divided by squared position index, ω/P² [sr]."""
        return np.asarray(self.solid_angle / self.position_index**2)

    def average_luminance(self) -> Float[np.ndarray, " step"]:
        """Mean luminance of all sources, weighted by solid angle [cd/m²]; 0 if none."""
        flux = self.totals(self.luminance * self.solid_angle)
        size = self.totals(self.solid_angle)
        none = np.zeros(self.steps)
        return np.asarray(np.divide(flux, size, out=none, where=size > 0))

    def samples(self) -> Float[np.ndarray, " source"]:
        """Effective number of path samples of each source: (luminance / error)².

        n equal samples among many of value 0 give a relative error of 1/√n. The number
        is infinite if the error is 0.
        """
        with np.errstate(divide="ignore"):
            return np.asarray((self.luminance / self.luminance_error) ** 2)

    def larger_than(self, solid_angle: float) -> "GlareSources":
        """Return the sources with at least the given solid angle [sr].

        Wienold and Christoffersen (2006) ignored sources smaller than 0.002 sr.
        """
        return self.select(self.solid_angle >= solid_angle) if solid_angle else self

    def select(
        self, keep: Bool[np.ndarray, " source"] | Int[np.ndarray, " some"]
    ) -> "GlareSources":
        """Return some of the sources, by a mask or by their indices."""
        parts = [getattr(self, name)[keep] for name in _NAMES]
        return GlareSources(*parts, steps=self.steps)

    def at_step(self, step: int) -> "GlareSources":
        """Return the sources of one time step."""
        found = self.select(self.step == step)
        return replace(found, step=np.zeros_like(found.step), steps=1)


_NAMES = tuple(one.name for one in fields(GlareSources) if one.name != "steps")
