"""Inputs of shade control rules: sun, façade irradiance, illuminance and glare.

Inputs are computed on demand.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.control.profile_angle import profile_angle
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.phases.matrix_equation import Skies, States
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.study.config import Study
from clerestory.study.energy_model import EnergyModel
from clerestory.study.inputs import Inputs
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import Lamps
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.window_tables import ControlTable
from clerestory.study.zone_response import BuildingResponse

# Function of shade states, time steps and view names: largest DGP among these views
GlareFunction = Callable[
    [States, Int[np.ndarray, " step"], Sequence[str]], Float[np.ndarray, " step"]
]


class GridGlareFunction(Protocol):
    """Function that returns the largest DGP among all views of view grids."""

    def __call__(
        self,
        states: States,
        steps: Int[np.ndarray, " step"],
        names: Sequence[str],
        *,
        enough: float,
    ) -> Float[np.ndarray, " step"]:
        """Return DGP at time steps; where above `enough`, a lower limit of it."""


@dataclass(frozen=True, eq=False)
class ControlInputs:
    """Inputs of shade control rules.

    `largest_dgp` is that of given views, `largest_grid_dgp` that of view grids. `lamps`
    and `model` are those of a study with a model of EnergyPlus.
    """

    study: Study
    inputs: Inputs
    matrices: StudyMatrices
    skies: Skies
    largest_dgp: GlareFunction
    largest_grid_dgp: GridGlareFunction
    job: Job | None = None
    lamps: Lamps | None = None
    model: EnergyModel | None = None
    _kept: dict[tuple[str, int], np.ndarray] = field(default_factory=dict)

    @property
    def times(self) -> np.ndarray:
        """Centres of the time steps, in local standard time."""
        return self.inputs.weather.times

    @cached_property
    def building(self) -> BuildingResponse | None:
        """Response of the model of EnergyPlus, if the study has one."""
        if self.model is None or self.job is None or self.lamps is None:
            return None
        return BuildingResponse(
            self.job, self.model, self.lamps, self.occupied, self.illuminance
        )

    @property
    def step_minutes(self) -> float:
        """Length of a time step [min]."""
        return self.inputs.weather.step_minutes

    @cached_property
    def occupied(self) -> Bool[np.ndarray, " time"]:
        """Whether each time step lies within the occupied hours of the study."""
        schedule = self.study.schedule
        return occupied_hours(
            self.times, from_hour=schedule.from_hour, to_hour=schedule.to_hour
        )

    @cached_property
    def sun(self) -> Float[np.ndarray, "time 3"]:
        """Unit vectors to the sun, in the coordinate system of the scene."""
        table = self.study.sky
        return sun_over(
            self.inputs.weather,
            rotation_deg=table.rotation_deg,
            sun_formula=table.sun_formula,
        ).directions()

    def profile(
        self, group: int, *, vertical: bool = False
    ) -> Float[np.ndarray, " time"]:
        """Profile angle [rad] of the sun; NaN at night or if behind the façade."""
        frame = self.inputs.groups[group].inner.frame
        angle = profile_angle(self.sun, frame, vertical=vertical)
        return np.where(self.sun[:, 2] > 0, angle, np.nan)

    def direct_irradiance(self, group: int) -> Float[np.ndarray, " time"]:
        """Return the unobstructed direct irradiance on a façade [W/m²]."""
        outward = -self.inputs.groups[group].inner.frame.normal
        slant = np.maximum(self.sun @ outward, 0) * (self.sun[:, 2] > 0)
        return np.asarray(self.inputs.weather.direct_normal * slant)

    def irradiance(self, group: int) -> Float[np.ndarray, " time"]:
        """Return the global irradiance on a façade [W/m²]."""
        return self._on_facade("irradiance", group, self._solar) / LUMINOUS_EFFICACY

    def facade_illuminance(self, group: int) -> Float[np.ndarray, " time"]:
        """Return the global illuminance on a façade [lux]."""
        return self._on_facade("illuminance", group, self.skies.whole)

    @cached_property
    def _solar(self) -> SkyMatrix:
        table = self.study.sky
        return sky_matrix(
            self.inputs.weather,
            subdivision=table.subdivision,
            ground_reflectance=table.ground_reflectance,
            rotation_deg=table.rotation_deg,
            sun_formula=table.sun_formula,
            spectrum="solar",
            bands=self.skies.whole.bands,
        )

    def _on_facade(self, name: str, group: int, sky: SkyMatrix) -> np.ndarray:
        if (name, group) not in self._kept:
            product = self._facade_row(group) @ sky
            self._kept[name, group] = product.illuminance()["illuminance"].values[0]
        return self._kept[name, group]

    def _facade_row(self, group: int) -> TransferMatrix:
        # Façade irradiance per sky patch radiance [sr]: D weighted by projected solid
        # angle, or coefficients of an unobstructed plane if the method has no D
        whole = self.matrices.windows[group].whole
        if whole and whole.factors:
            daylight = whole.factors[0][-1]  # D of shade state 0
            outer = self.inputs.groups[group].outer.partition
            values = outer.projected_solid_angles()[None, :] @ daylight.values
            return TransferMatrix(
                values, sensor_axis(1), daylight.columns, bands=daylight.bands
            )
        partition = self.skies.whole.partition
        outward = -self.inputs.groups[group].inner.frame.normal
        slant = np.maximum(partition.dome.centres() @ outward, 0)
        ground = np.pi / 2 * (1 - outward[2])
        weights = np.append(ground, slant * partition.dome.solid_angles())
        return TransferMatrix(
            weights[None, None, :], sensor_axis(1), self.skies.whole.rows
        )

    def illuminance(
        self, states: States, grid: str
    ) -> Float[np.ndarray, "sensor time"]:
        """Return the sensor illuminance of a grid [lux] for given shade states."""
        everything = range(len(self.inputs.groups))
        part = self.matrices.reduced(everything, self.inputs.rows(grid))
        found = part.illuminance(self.skies, states)
        return np.asarray(found["illuminance"].values)

    def melanopic_edi(
        self, states: States, grid: str
    ) -> Float[np.ndarray, "sensor time"]:
        """Return the melanopic EDI of a grid [lux] for given shade states."""
        everything = range(len(self.inputs.groups))
        part = self.matrices.reduced(everything, self.inputs.rows(grid))
        found = part.melanopic_edi(self.skies, states)
        return np.asarray(found["illuminance"].values)

    def dgp(
        self,
        states: States,
        steps: Int[np.ndarray, " step"],
        control: ControlTable,
        *,
        enough: float = np.inf,
    ) -> Float[np.ndarray, " step"]:
        """Return the largest DGP among the views and view grids of a control rule.

        Without names these are all views, or all view grids if there are no views.
        Where DGP is above `enough`, a lower limit of it may be returned.
        """
        worst = np.zeros(len(steps))
        if control.views or (self.study.view and not control.view_grids):
            worst = self.largest_dgp(states, steps, control.views)
        if self.looks_at_grids(control):
            grids = control.view_grids
            found = self.largest_grid_dgp(states, steps, grids, enough=enough)
            worst = np.maximum(worst, found)
        return worst

    def looks_at_grids(self, control: ControlTable) -> bool:
        """Whether a control rule evaluates the glare of view grids."""
        return bool(control.view_grids) or not (control.views or self.study.view)

    def direct(
        self, group: int, state: States, grid: str
    ) -> Float[np.ndarray, "sensor time"]:
        """Return the direct sun illuminance of a grid through one window [lux]."""
        part = self.matrices.reduced([group], self.inputs.rows(grid))
        found = part.direct_illuminance(self.skies, state)
        return np.asarray(found["illuminance"].values)
