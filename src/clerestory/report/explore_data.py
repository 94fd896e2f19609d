"""Hourly values of a run for the interactive page, as named parts of bytes.

Parts are embedded in the page, or served beside it. Sensors are in the order of their
grids; hourly values are those of the time steps with daylight.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.escaping import table_cell
from clerestory.metrics.climate_based_metrics import TARGET_LUX, USEFUL_LIMITS_LUX
from clerestory.report.content import ReportContent
from clerestory.report.floor_plan import PlanFrame, frame_around
from clerestory.report.hourly_codes import (
    DGP_LIMITS,
    DGP_STEP,
    STEP,
    hourly_dgp,
    hourly_illuminance,
)
from clerestory.report.view_glare import view_glare
from clerestory.report.window_states import WindowStates, window_states
from clerestory.study.illuminance_by_state import BY_STATE

# Limits that are exact in the page, besides the target of the study [lux]
_LIMITS = (*USEFUL_LIMITS_LUX, 500.0, 750.0, 1000.0, 2000.0)

# Names of parts
OPERATED, VIEWS, VIEW_GRID = "operated", "views", "view-grid"

GLARE_BY_STATE = "glare_dgp_by_state"


class Plan(NamedTuple):
    """Plan of a grid of sensors or views; `members` are rows of the results."""

    name: str
    frame: PlanFrame
    members: Int[np.ndarray, " member"]


@dataclass(frozen=True, eq=False)
class ExploreData:
    """Hourly values of a run for the interactive page."""

    content: ReportContent

    __repr__ = brief

    @property
    def target_lux(self) -> float:
        """Target illuminance of the study [lux]."""
        return float(self.content.data.attrs.get("target_lux", TARGET_LUX))

    @cached_property
    def plans(self) -> tuple[Plan, ...]:
        """Plans of the sensor grids."""
        sensors, grids = self.content.sensors, self.content.sensors.by_grid()
        return tuple(
            self._plan(name, f"plan-{k}", sensors.position, sensors.direction, members)
            for k, (name, members) in enumerate(grids.items())
        )

    @cached_property
    def view_plans(self) -> tuple[Plan, ...]:
        """Plans of the view grids; a cell for each position."""
        data = self.content.data
        if "grid_view_dgp" not in data:
            return ()
        grids = data["view_grid"].values.astype(str)
        position = data["grid_view_position"].values.astype(float)
        level = np.tile([0.0, 0.0, 1.0], (len(position), 1))
        return tuple(
            self._plan(
                name, f"views-{k}", position, level, np.flatnonzero(grids == name)
            )
            for k, name in enumerate(dict.fromkeys(grids.tolist()))
        )

    def _plan(
        self,
        name: str,
        identifier: str,
        position: Float[np.ndarray, "point 3"],
        direction: Float[np.ndarray, "point 3"],
        members: Int[np.ndarray, " member"],
    ) -> Plan:
        frame = frame_around(
            self.content, position[members], direction[members], identifier=identifier
        )
        return Plan(name, frame, members)

    @cached_property
    def order(self) -> Int[np.ndarray, " sensor"]:
        """Rows of the results in the order of the page."""
        return np.concatenate([plan.members for plan in self.plans])

    @cached_property
    def lit(self) -> Int[np.ndarray, " step"]:
        """Time steps with daylight."""
        found = (self.content.illuminance > 0).any(axis=0)
        if "glare_dgp" in self.content.data:
            found |= np.isfinite(self.content.data["glare_dgp"].values).any(axis=0)
        return np.flatnonzero(found)

    @cached_property
    def windows(self) -> tuple[WindowStates, ...]:
        """Windows with several states, and their states in the run."""
        return window_states(self.content.data)

    @property
    def has_states(self) -> bool:
        """Whether the results have the illuminance of each shade state."""
        return BY_STATE in self.content.data and bool(self.windows)

    def illuminance_part(self) -> bytes:
        """Return the illuminance of the run."""
        return self._lux(self.content.illuminance)

    def state_parts(self) -> Iterator[tuple[str, Callable[[], bytes]]]:
        """Yield the parts of windows in their states: name, and function of the part.

        Nothing is yielded if the results have no illuminance by state.
        """
        if not self.has_states:
            return
        names = [str(name) for name in self.content.data["window"].values]
        several = {window.window: len(window.names) for window in self.windows}
        for number, name in enumerate(names):
            for state in range(several.get(name, 1)):
                yield f"state-{number}-{state}", partial(self._state, number, state)

    def glare_parts(self) -> Iterator[tuple[str, Callable[[], bytes]]]:
        """Yield the parts of DGP, of views and of each view grid, as `state_parts`."""
        if "glare_dgp" in self.content.data:
            yield VIEWS, partial(self._views, self._dgp)
        if GLARE_BY_STATE in self.content.data and self.has_states:
            every = self.content.data[GLARE_BY_STATE]
            every = every.transpose("shade_state", "view", "time")
            for number, dgp in enumerate(every.values):
                yield f"{VIEWS}-{number}", partial(self._views, dgp)
        for number, plan in enumerate(self.view_plans):
            yield f"{VIEW_GRID}-{number}", partial(self._view_grid, plan)

    def _state(self, window: int, state: int) -> bytes:
        return self._lux(self.content.data[BY_STATE][:, window, state].values)

    @property
    def _dgp(self) -> Float[np.ndarray, "view time"]:
        return np.stack([view.dgp for view in view_glare(self.content.data)])

    def _views(self, dgp: Float[np.ndarray, "view time"]) -> bytes:
        return hourly_dgp(dgp[:, self.lit]).compressed()

    def _view_grid(self, plan: Plan) -> bytes:
        dgp = self.content.data["grid_view_dgp"].values[plan.members][:, self.lit]
        return hourly_dgp(dgp).compressed()

    def _lux(self, values: Float[np.ndarray, "sensor time"]) -> bytes:
        chosen = values[self.order][:, self.lit]
        return hourly_illuminance(chosen, (*_LIMITS, self.target_lux)).compressed()

    def facts(self) -> dict[str, Any]:
        """Return names, places, times and settings as JSON values."""
        sensors, grid = self.content.sensors, self.content.grid
        windows = self.content.data["window"].values if self.windows else ()
        names = [str(name) for name in windows]
        several = {window.window: window for window in self.windows}
        return {
            "title": self.content.title,
            "target": self.target_lux,
            "step": STEP,
            "dgp_step": DGP_STEP,
            "dgp_limits": list(DGP_LIMITS),
            "exact": sorted({*_LIMITS, self.target_lux}),
            "dates": grid.dates.astype(int).tolist(),
            "bins": grid.bins,
            "cell": grid.cell.tolist(),
            "lit": self.lit.tolist(),
            "occupied": np.flatnonzero(self.content.occupied).tolist(),
            "sensors": [table_cell(sensors.names[k]) for k in self.order],
            "position": sensors.position[self.order].round(3).tolist(),
            "plans": [_plan_facts(plan) for plan in self.plans],
            "view_plans": [self._view_facts(plan) for plan in self.view_plans],
            "windows": [self._window_facts(name, several.get(name)) for name in names],
            "views": [view.view for view in view_glare(self.content.data)],
        }

    def _window_facts(self, name: str, window: WindowStates | None) -> dict[str, Any]:
        if window is None:
            return {"name": name, "states": [""]}
        facts: dict[str, Any] = {
            "name": name,
            "states": list(window.names),
            "rule": window.rule,
            "operated": window.state.tolist(),
        }
        if "facade_irradiance" in self.content.data:
            outside = self.content.data["facade_irradiance"].sel(window=name).values
            facts["irradiance"] = np.nan_to_num(outside).round(1).tolist()
        return facts

    def _view_facts(self, plan: Plan) -> dict[str, Any]:
        data = self.content.data
        azimuth = data["grid_view_azimuth"].values[plan.members].astype(float)
        count = max(1, len(np.unique(azimuth.round(3))))
        facts = _plan_facts(plan)
        places = data["grid_view_position"].values[plan.members[::count]].astype(float)
        facts["cells"] = facts["cells"][::count]
        facts["points"] = facts["points"][::count]
        return facts | {
            "azimuths": azimuth[:count].round(1).tolist(),
            "position": places.round(3).tolist(),
        }


def _plan_facts(plan: Plan) -> dict[str, Any]:
    frame = plan.frame
    cells, points = frame.place(frame.cells), frame.place(frame.points)
    return {
        "name": plan.name,
        "count": len(plan.members),
        "size": [round(length, 1) for length in frame.size],
        "level": frame.level,
        "cells": cells.round(1).reshape(len(cells), -1).tolist(),
        "points": points.round(1).tolist(),
    }
