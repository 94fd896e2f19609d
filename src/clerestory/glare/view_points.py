"""Matrices of a view point, and its annual glare in several directions.

The sphere around the point is divided into cells, which are the rows of V and of the
recorded paths to the windows: the luminance of a cell is the mean over its directions.
"""

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Vector
from clerestory.brief_repr import brief
from clerestory.glare.cell_luminance import STEPS, CellLuminance, cell_luminance
from clerestory.glare.dgp_error import DgpModel, limited
from clerestory.glare.eye_directions import SUN_SOLID_ANGLE, SunDisc
from clerestory.glare.point_glare import point_glare
from clerestory.glare.sphere_refinement import (
    Refinement,
    sampling_error,
)
from clerestory.glare.sphere_samples import SphereSamples
from clerestory.phases.matrix_equation import (
    Skies,
    States,
    Term,
    WindowMatrices,
    checked_states,
    equation_bands,
)
from clerestory.phases.picture_series import PixelSeries
from clerestory.phases.sunlit import SunlitReceivers
from clerestory.scene.view import View
from clerestory.threads import linear_algebra_in_one_thread

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class ViewPoint:
    """Matrices of a view point, for any states of the shades.

    Attributes
    ----------
    position : the view point [m]
    views : views, of which line of sight and up vector define the eye
    samples : cells of the sphere, of which the rows of the matrices are
    windows : matrices by window group, with the cells as receivers
    """

    position: Vector
    views: tuple[View, ...]
    samples: SphereSamples
    windows: tuple[WindowMatrices, ...]
    terms: tuple[Term, ...]
    skies: Skies
    refinement: Refinement = field(default_factory=Refinement)

    __repr__ = brief

    def glare(
        self,
        states: States | None = None,
        *,
        steps: Int[np.ndarray, " some"] | None = None,
        quantities: Collection[str] = ("dgp", "illuminance"),
        errors: bool = True,
    ) -> "xr.Dataset":
        """Return glare indices of all views in given shade states.

        Parameters
        ----------
        states : index of the shade state at each time step, per window group; default 0
        steps : indices of the time steps that are evaluated; default: all
        quantities : names of indices and quantities, as of `point_glare`
        errors : whether the standard error of DGP is computed

        Returns
        -------
        dataset over (view, time), NaN in dark time steps; with "dgp", also its
        standard error "dgp_error", due to paths and to the finite number of cells,
        unless without errors
        """
        times = self.skies.times
        given = checked_states(self.windows, states, len(times))
        asked = np.arange(len(times)) if steps is None else steps
        lit = asked[self.skies.whole.diffuse[:, asked].max(axis=0) > 0]
        own = [np.asarray(state)[lit] for state in given]
        known = errors and "dgp" in quantities
        with linear_algebra_in_one_thread():
            self.keep_beams(own, lit)
            sun = self.sun_disc(own, lit)
            if known:
                luminance, variance, value = self._luminance(own, lit, sun)
            else:
                luminance = self.luminance(own, lit)
            found = point_glare(
                self.samples,
                luminance,
                self.views,
                sun=sun,
                times=times[lit],
                quantities=quantities,
            )
            if known:
                sampled = sampling_error(
                    self.samples,
                    luminance,
                    self.views,
                    refinement=self.refinement,
                    sun=sun,
                    means=True,
                )
                error = limited(np.sqrt(variance + np.square(sampled)), value)
                found["dgp_error"] = ("view", "time"), error, {"units": "1"}
        return found.reindex(time=times[asked])

    def sun_disc(self, states: States, steps: Int[np.ndarray, " step"]) -> SunDisc:
        """Return the sun's disc as seen from the point through unscattering windows.

        `states` are those at the given time steps.
        """
        direction = np.tile([0.0, 0.0, 1.0], (len(steps), 1))
        flux, share = np.zeros(len(steps)), np.zeros(len(steps))
        suns = self.skies.suns
        if suns is not None and any(window.sun for window in self.windows):
            normal = suns.direct_normal[:, steps].tocoo()
            sun, step = normal.coords
            direction[step] = suns.directions[sun]
            for discs, state in zip(self._discs, states, strict=True):
                passed, visible = (
                    np.stack(part)[state[step], sun]
                    for part in zip(*discs, strict=True)
                )
                flux[step] += normal.data * passed
                share[step] += visible
        angle = SUN_SOLID_ANGLE * np.minimum(share, 1)
        level = np.divide(flux, angle, out=np.zeros_like(flux), where=angle > 0)
        return SunDisc(direction, level, angle)

    @cached_property
    def _discs(self) -> list[list[tuple[np.ndarray, np.ndarray]]]:
        # Illuminance per direct normal irradiance, and visible share, of each sun, by
        # window group and shade state
        weights, found = self._weights, []
        for window in self.windows:
            assert window.sun is not None
            discs = []
            for state in window.sun.receiving:
                assert isinstance(state, SunlitReceivers)
                flux, share = state.disc(weights)
                discs.append((flux[0], share))
            found.append(discs)
        return found

    def _luminance(
        self, states: States, steps: Int[np.ndarray, " step"], sun: SunDisc
    ) -> CellLuminance:
        how = self.refinement
        model = DgpModel(self.samples, self.views, how.threshold, how.coefficients)
        return cell_luminance(self._series(states, steps, errors=True), model, sun)

    def luminance(
        self, states: States, steps: Int[np.ndarray, " step"]
    ) -> Float[np.ndarray, "cell step"]:
        """Return the luminance of the cells, in states at the given time steps."""
        light = np.zeros((self.samples.count, len(steps)), np.float32)
        for block in self._series(states, steps, errors=False).blocks(STEPS):
            light[block.rows, block.times.start + block.steps] = block.light[0]
        return light

    def keep_beams(self, states: States, steps: Int[np.ndarray, " step"]) -> None:
        """Trace the narrow beams of all time steps together, and keep their light.

        `states` are those at the given time steps.
        """
        suns, weights = self.skies.suns, self._weights
        for window, chosen in zip(self.windows, states, strict=True):
            if suns is None or window.sun is None:
                continue
            for state, matrix in enumerate(window.sun.receiving):
                assert isinstance(matrix, SunlitReceivers)
                own = steps[chosen == state]
                matrix.keep_beams(suns.direct_normal[:, own], weights)

    @property
    def _weights(self) -> Float[np.ndarray, "1 band"]:
        return equation_bands(self.windows, self.skies).weights[None]

    def _series(
        self, states: States, steps: Int[np.ndarray, " step"], *, errors: bool
    ) -> PixelSeries:
        return PixelSeries(
            self.windows,
            self.terms,
            self.skies.select(steps),
            states,
            self._weights,
            self.samples.count,
            errors=errors,
        )
