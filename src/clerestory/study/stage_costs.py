"""Time and files of the stages of a run after tracing, from measured rates.

The rates are those of the server of `study.product_costs`, scaled by the speed of this
machine. Tracing is measured by pilot runs instead (`engine.cost_estimate`); reading,
checks and sky matrices are executed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clerestory.matrix.error_components import COUNT
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.phases.matrix_equation import (
    Part,
    Skies,
    chains,
)
from clerestory.study.annual_views import picture_steps, sees_glare
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.product_costs import machine_factor, product_seconds
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_skies import needs_direct
from clerestory.study.view_grid_points import USUAL_LEVEL
from clerestory.study.view_matrices import ViewMatrices
from clerestory.study.window_tables import INTERIOR, ControlTable

# Stages of a run, in order: the keys of `seconds` in run.json
STAGES = (
    *("read", "check", "trace", "sky", "control", "multiply", "pictures"),
    *("view grids", "metrics", "compliance", "uncertainty", "write"),
)

# Seconds per hourly value in metrics, per byte of tables
_METRIC, _BYTE = 4e-7, 4e-8

# Seconds per hourly value: assessment by one standard, figures of merit of one draw
_STANDARD, _DRAW = 2e-7, 3e-9

# Time steps of pictures that are computed together
_TOGETHER = 32

# Usual number of cells of a view point
USUAL_CELLS = 4**USUAL_LEVEL

# Seconds per picture and per pixel: glare with and without errors, Radiance picture
_GLARE_ERRORS, _GLARE, _PICTURE = (2.5e-2, 1.2e-7), (1.2e-3, 6e-9), (2e-3, 1e-7)

# Seconds per cell of a view point and time step: DGP in eight directions without and
# with errors
_CELL = 8e-7, 2e-6

# Seconds for the first use of the libraries of products
_START = 0.5

# Bytes of a Radiance picture (per pixel, header), of tables (per hourly value, time
# step, sensor), and of the rest of results.nc (drawing of the room, of a shade state)
_PIXEL, _HEADER, _TEXT, _STAMP, _SENSOR_LINE = 3.5, 300, 5.0, 15, 165
_ROOM, _STATE = 110_000, 50_000


@dataclass(frozen=True)
class StageCost:
    """Estimated time of a stage of a run [s], and number and size of its files [bytes].

    Files of matrices are not included.
    """

    work: str = ""
    seconds: float = 0.0
    files: int = 0
    bytes: int = 0

    def __add__(self, other: "StageCost") -> "StageCost":
        return StageCost(
            other.work,
            self.seconds + other.seconds,
            self.files + other.files,
            self.bytes + other.bytes,
        )


@dataclass(frozen=True, eq=False)
class StageWork:
    """Matrices and skies of a run with one method."""

    study: Study
    inputs: Inputs
    matrices: StudyMatrices
    views: Sequence[ViewMatrices]
    skies: Skies

    def costs(self, known: Mapping[str, float]) -> dict[str, StageCost]:
        """Return the cost of each stage; `known` has measured seconds of stages."""
        sensors, steps = len(self.inputs.sensors()), len(self.inputs.weather.times)
        work, hours = f"{sensors:,} sensors, {steps:,} steps", sensors * steps
        product = self._grids([term.part for term in self.matrices.terms])
        sun: Part = "direct" if self.matrices.suns is None else "sun"
        direct = self._grids([sun]) if self.matrices.has_direct else 0.0
        stages = dict.fromkeys(STAGES, StageCost()) | {
            "control": StageCost(seconds=self._control(product, direct)),
            "multiply": StageCost(work, _START + product),
            "pictures": self._pictures(),
            "view grids": self._view_grids(),
            "metrics": StageCost(work, _START / 3 + _METRIC * hours + direct),
            "compliance": self._compliance(hours),
            "uncertainty": self._uncertainty(sensors),
            "write": self._tables(sensors, steps),
        }
        factor = machine_factor()
        stages = {
            name: replace(cost, seconds=factor * cost.seconds)
            for name, cost in stages.items()
        }
        for name in stages.keys() & known.keys():
            stages[name] = replace(stages[name], seconds=known[name])
        return stages

    @cached_property
    def _lit(self) -> np.ndarray:
        # Time steps with daylight, and occupied steps, in which luminaires may be on
        lit, hours = self.skies.whole.diffuse.max(axis=0) > 0, self.study.schedule
        if self.study.lighting:
            lit = lit | occupied_hours(
                self.skies.times, from_hour=hours.from_hour, to_hour=hours.to_hour
            )
        return np.flatnonzero(lit)

    def _grids(self, parts: Sequence[Part], *, errors: bool = True) -> float:
        # Seconds for the illuminance of all sensors
        rows, steps = len(self.inputs.sensors()), len(self._lit)
        windows = self.matrices.windows
        return sum(
            product_seconds(chains(windows, part), rows, steps, errors=errors)
            for part in parts
        )

    def _view(self, view: ViewMatrices, steps: int, *, errors: bool) -> float:
        # Seconds for the luminance of a view, and for glare
        seconds = self._pixels(view, steps, bands=1, errors=errors)
        each = np.dot(_GLARE_ERRORS if errors else _GLARE, (1, len(view.camera)))
        return float(seconds + steps * each)

    def _pixels(
        self, view: ViewMatrices, steps: int, *, bands: int, errors: bool
    ) -> float:
        # Seconds for the pixels of a view
        samples = self.study.sun.picture_samples
        windows = view.blocks if errors else view.windows
        return sum(
            product_seconds(
                chains(windows, term.part), len(view.camera), steps, bands,
                errors=errors, together=_TOGETHER, samples=samples,
            )
            for term in self.matrices.terms
        )  # fmt: skip

    def _pictures(self) -> StageCost:
        # Computed pictures, glare, and files of the selected time steps
        seconds, rated, files, size = 0.0, 0, 0, 0.0
        groups = self.inputs.groups if self.study.output.by_state else ()
        states = max((len(group.states) for group in groups), default=0)
        for view in self.views:
            kept, seen = picture_steps(view, self.skies.times, self._lit)
            bands, pixels = len(self.inputs.scene.bands), len(view.camera)
            if sees_glare(view.camera.view):
                rated += len(seen)
                seconds += self._view(view, len(seen), errors=True)
                seconds += states * self._view(view, len(seen), errors=False)
            seconds += self._pixels(view, len(kept), bands=bands, errors=False)
            seconds += len(kept) * np.dot(_PICTURE, (1, pixels))
            files += len(kept)
            size += len(kept) * (_PIXEL * pixels + _HEADER)
        words = [f"glare at {rated:,} steps"] if rated else []
        words += [f"{files:,} pictures"] if files else []
        return StageCost(", ".join(words), seconds, files, round(size))

    def _control(self, product: float, direct: float) -> float:
        # Seconds for illuminance and glare of each shade state, if a rule needs them
        seconds = 0.0
        for group in self.inputs.groups:
            rule, states = group.control, len(group.states)
            if rule is None or states == 1:
                continue
            if rule.rule == "LM-83":
                seconds += states * direct
            elif rule.grid or rule.quantity in INTERIOR or rule.needs:
                seconds += states * product
            glare = rule.rule == "glare" and not rule.grid
            if glare or rule.dgp_below is not None or "glare" in rule.needs:
                seconds += states * self._rated(rule)
        return seconds

    def _rated(self, rule: ControlTable) -> float:
        # Seconds for the glare of one shade state in all views and view grids of a rule
        seconds, steps = 0.0, len(self._lit)
        if rule.views or (self.views and not rule.view_grids):
            seconds += sum(self._view(v, steps, errors=False) for v in self.views)
        if rule.view_grids or not (rule.views or self.views):
            grids = self.inputs.view_grids
            named = [g for g in grids if g.name in (rule.view_grids or [g.name])]
            seconds += sum(map(len, named)) * steps * USUAL_CELLS * _CELL[0]
        return seconds

    def _compliance(self, hours: int) -> StageCost:
        # Assessment of the hourly values of all sensors by each standard
        if self.study.compliance is None:
            return StageCost()
        count = len(self.study.compliance.standards)
        work = f"{count} standard{'s' * (count > 1)}"
        return StageCost(work, _STANDARD * count * hours)

    def _uncertainty(self, sensors: int) -> StageCost:
        # Illuminance with its first and second derivatives; figures of merit of draws
        table = self.study.uncertainty
        if table is None:
            return StageCost()
        kinds = [unknown.kind for unknown in table.unknown]
        count = kinds.count("reflectance") + kinds.count("transmittance")
        derivatives = count + count * (count + 1) // 2
        hours = (
            sensors
            * occupied_hours(
                self.skies.times,
                from_hour=self.study.schedule.from_hour,
                to_hour=self.study.schedule.to_hour,
            ).sum()
        )
        product = self._grids([term.part for term in self.matrices.terms], errors=False)
        # As many draws again for Sobol' indices
        seconds = product * (1 + derivatives) + 2 * _DRAW * table.draws * hours
        return StageCost(f"{table.draws:,} draws", float(seconds))

    def _view_grids(self) -> StageCost:
        # Glare of all view grids, as operated and by state; V of their cells in files
        grids, steps = self.inputs.view_grids, len(self._lit)
        most = max((len(group.states) for group in self.inputs.groups), default=1)
        patches = sum(len(group.inner.partition) for group in self.inputs.groups)
        evaluations = sum(len(g) * (1 + most * g.table.by_state) for g in grids)
        count = sum(map(len, grids))
        views = sum(len(grid) * grid.table.directions for grid in grids)
        work = f"{count:,} positions, {views:,} views" if grids else ""
        size = count * USUAL_CELLS * patches * 4 + 12 * views * len(self.skies.times)
        seconds = evaluations * steps * USUAL_CELLS * _CELL[1]
        return StageCost(work, seconds, 2 * len(grids), size)

    def _tables(self, sensors: int, steps: int) -> StageCost:
        # Tables of hours, metrics, shade states and luminaires; results.nc, run.json
        output, grids = self.study.output, len(self.inputs.grids)
        states = [len(group.states) for group in self.inputs.groups]
        others = output.csv * ((max(states, default=1) > 1) + bool(self.study.lighting))
        hourly = output.csv + output.ill
        text = hourly * steps * (_TEXT * sensors + _STAMP * grids)
        text += output.csv * _SENSOR_LINE * sensors + 2 * others * _STAMP * steps
        size = hour_bytes(self.study) * sensors * steps + text
        size += _ROOM + _STATE * sum(states)
        files = hourly * grids + output.csv + others + 2
        return StageCost("", _BYTE * text, files, round(size))


def hour_bytes(study: Study) -> int:
    """Return the size in results.nc of a sensor and time step [bytes]."""
    # Illuminance, terms, sun, luminaires, and errors with their components
    variables = 2 + COUNT // 4 + bool(study.lighting)
    if needs_direct(study):
        variables += 2 + COUNT // 4 + 3 * study.corrected
    if study.output.by_state:
        windows = [len(window.states()) for window in study.window]
        variables += len(windows) * max(windows)
    return 4 * variables
