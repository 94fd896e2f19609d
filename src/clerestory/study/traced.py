"""What was traced for the sensors of a study, and its products with the sky."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Int

from clerestory.errors import InputError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.five import FivePhases, five_phase
from clerestory.phases.shaded import (
    ShadedWindow,
    States,
    shaded_five_phase,
    shaded_sun,
    shaded_three_phase,
)
from clerestory.phases.three import three_phase_sum
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.study.coefficients import TwoPhases
from clerestory.study.job import Display


@dataclass(frozen=True, eq=False)
class Skies:
    """Skies of a study: the whole, and the sun alone where direct light is needed."""

    whole: SkyMatrix
    sun: SkyMatrix | None = None


@dataclass(frozen=True, eq=False)
class Tracing:
    """Traced matrices of a study, for its sensors.

    Attributes
    ----------
    coefficients : of the two-phase method; None for the others
    whole : V, T and D of each window group; empty for the two-phase method
    direct : V_d, T and D_d, where direct light is traced apart
    sun : C_ds of each window group in each state, for the five-phase method
    suns : that the columns of C_ds stand for
    """

    coefficients: TwoPhases | None = None
    whole: tuple[ShadedWindow, ...] = ()
    direct: tuple[ShadedWindow, ...] = ()
    sun: tuple[tuple[TransferMatrix, ...], ...] = ()
    suns: SunMatrix | None = None

    def illuminance(
        self, skies: Skies, states: States, *, display: Display
    ) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error."""
        progress = display("multiply")
        if self.coefficients is not None:
            return self.coefficients.illuminance(skies.whole, states, progress=progress)
        fixed = all(len(window.transmissions) == 1 for window in self.whole)
        whole = [window.at(0) for window in self.whole]
        if self.suns is None or skies.sun is None:
            if fixed:
                return three_phase_sum(whole, skies.whole, progress=progress)
            return shaded_three_phase(
                self.whole, skies.whole, states, progress=progress
            )
        if fixed:
            direct = [window.at(0) for window in self.direct]
            suns = [matrices[0] for matrices in self.sun]
            parts = list(map(FivePhases, whole, direct, suns))
            return five_phase(
                parts, skies.whole, skies.sun, self.suns, progress=progress
            )
        return shaded_five_phase(
            self.whole,
            self.direct,
            self.sun,
            skies.whole,
            skies.sun,
            self.suns,
            states,
            progress=progress,
        )

    def direct_illuminance(self, skies: Skies, states: States) -> xr.DataArray:
        """Illuminance [lux] straight from the sun, over (sensor, time).

        At its true place where C_ds is known, else spread over patches of the sky.

        Raises
        ------
        InputError : direct light was not traced
        """
        if self.suns is not None:
            found = shaded_sun(self.sun, self.suns, states)
        elif skies.sun is not None and self.direct:
            found = shaded_three_phase(self.direct, skies.sun, states)
        else:
            raise InputError("direct light was not traced; direct phases expected")
        return found["illuminance"]

    def reduced(
        self, groups: Sequence[int], rows: Int[np.ndarray, " sensor"]
    ) -> "Tracing":
        """Return the same for some window groups and sensors, without errors."""
        coefficients = None
        if self.coefficients is not None:
            parts = [self.coefficients.groups[number] for number in groups]
            coefficients = TwoPhases(
                tuple(tuple(_some_rows(m, rows) for m in part) for part in parts)
            )
        return Tracing(
            coefficients,
            tuple(self.whole[n].without_error(rows) for n in groups if self.whole),
            tuple(self.direct[n].without_error(rows) for n in groups if self.direct),
            tuple(
                tuple(_some_rows(matrix, rows) for matrix in self.sun[number])
                for number in groups
                if self.sun
            ),
            self.suns,
        )


def _some_rows(matrix: TransferMatrix, rows: np.ndarray) -> TransferMatrix:
    values = matrix.values[:, rows]
    return TransferMatrix(values, sensor_axis(len(rows)), matrix.columns)
