"""Time and files of the stages of a run after tracing, from measured rates.

The rates are processor time of one core, measured on 2026-11-23 on a shared x86-64
server (two cores of an AMD EPYC; NumPy with OpenBLAS). Tracing is measured by pilot
runs instead (`engine.cost_estimate`); reading, checks and sky matrices are executed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clerestory.matrix.error_components import COUNT
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.phases.matrix_equation import MatrixChain, Part, Skies, chains
from clerestory.phases.picture_series import STEPS_PER_BLOCK
from clerestory.phases.receivers import (
    chain_components,
    coefficients_cost_less,
    component_count,
)
from clerestory.phases.stored_views import FEW
from clerestory.study.annual_views import picture_steps, sees_glare
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_tracing import needs_direct
from clerestory.study.view_matrices import ViewMatrices

# Stages of a run, in order: the keys of `seconds` in run.json
STAGES = (
    *("read", "check", "trace", "sky", "control", "multiply", "pictures"),
    *("metrics", "write"),
)

# Seconds per multiply-add with sky matrices and with window matrices, per matrix value
# that is copied, per value of a result or of its error components, per hourly value in
# metrics, per byte of tables
_SKY, _WINDOW, _COPY, _VALUE, _METRIC, _BYTE = 5e-11, 7e-10, 3e-9, 2e-9, 4e-7, 4e-8

# Seconds per picture and per pixel: glare with and without errors, Radiance picture
_GLARE_ERRORS, _GLARE, _PICTURE = (2.5e-2, 1.2e-7), (1.2e-3, 6e-9), (2e-3, 1e-7)

# Seconds to load the libraries for matrix products at their first use
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
        """Return the cost of each stage; `known`: measured durations of stages [s]."""
        sensors, steps = len(self.inputs.sensors()), len(self.inputs.weather.times)
        work, hours = f"{sensors:,} sensors, {steps:,} steps", sensors * steps
        product = self._grids([term.part for term in self.matrices.terms])
        sun: Part = "direct" if self.matrices.suns is None else "sun"
        direct = self._grids([sun]) if self.matrices.has_direct else 0.0
        stages = dict.fromkeys(STAGES, StageCost()) | {
            "control": StageCost(seconds=self._control(product, direct)),
            "multiply": StageCost(work, _START + product),
            "pictures": self._pictures(),
            "metrics": StageCost(work, _START / 3 + _METRIC * hours + direct),
            "write": self._tables(sensors, steps),
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

    def _grids(self, parts: Sequence[Part]) -> float:
        # Seconds for the illuminance of all sensors
        rows, steps = len(self.inputs.sensors()), len(self._lit)
        windows = self.matrices.windows
        return sum(_product(chains(windows, part), rows, steps) for part in parts)

    def _view(self, view: ViewMatrices, steps: int, *, errors: bool) -> float:
        # Seconds for the pictures of a view, with glare if the view is wide enough
        pixels, bands = len(view.camera), len(self.inputs.scene.bands)
        seconds = sum(
            _product(chains(view.windows, term.part), pixels, steps, bands, errors)
            for term in self.matrices.terms
        )
        if sees_glare(view.camera.view):
            seconds += steps * np.dot(_GLARE_ERRORS if errors else _GLARE, (1, pixels))
        return float(seconds)

    def _pictures(self) -> StageCost:
        # Computed pictures, glare, and files of the selected time steps
        seconds, computed, files, size = 0.0, 0, 0, 0.0
        for view in self.views:
            kept, seen = picture_steps(view, self.skies.times, self._lit)
            eye, pixels = sees_glare(view.camera.view), len(view.camera)
            seconds += self._view(view, len(seen), errors=eye)
            seconds += len(kept) * np.dot(_PICTURE, (1, pixels))
            computed, files = computed + len(seen), files + len(kept)
            size += len(kept) * (_PIXEL * pixels + _HEADER)
        work = f"{computed:,} computed, {files:,} written" if self.views else ""
        return StageCost(work, seconds, files, round(size))

    def _control(self, product: float, direct: float) -> float:
        # Seconds for illuminance and glare of each shade state, if a rule needs them
        seconds = 0.0
        for group in self.inputs.groups:
            rule, states = group.control, len(group.states)
            if rule is None or states == 1:
                continue
            if rule.rule == "LM-83":
                seconds += states * direct
            elif rule.grid or rule.quantity == "illuminance" or rule.needs:
                seconds += states * product
            glare = rule.rule == "glare" and not rule.grid
            if glare or rule.dgp_below is not None or "glare" in rule.needs:
                steps = len(self._lit)
                views = (self._view(v, steps, errors=False) for v in self.views)
                seconds += states * sum(views)
        return seconds

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


def _product(
    found: Sequence[MatrixChain],
    rows: int,
    steps: int,
    bands: int = 1,
    errors: bool = True,
) -> float:
    # Seconds for a term of the matrix equation; pictures are in several bands
    short = found[0].factors and isinstance(found[0].receiving[0], TransferMatrix)
    short = short and all(chain.states == 1 for chain in found)
    short = bool(short and coefficients_cost_less(found, rows, steps))
    # Pictures are computed separately for each combination of shade states
    combinations = 1 + sum(chain.states - 1 for chain in found)
    blocks = max(combinations, steps / STEPS_PER_BLOCK) if bands > 1 else 1
    seconds = 0.0
    for chain in found:
        first = chain.receiving[0]
        held = first if isinstance(first, TransferMatrix) else None
        own = chain_components(chain) if errors else 0
        views = (component_count(held) if held else FEW) if errors else 0
        layers, channels = 1 + views + own, len(held.values) if held else bands
        if chain.factors:
            T, D = chain.factors[0][0], chain.factors[0][-1]
            channels, patches = max(channels, bands, len(T.values)), T.rows.size
            whole = D.columns.size * D.rows.size * len(D.values)
            if short:
                seconds += layers * rows * channels * whole * _WINDOW
                seconds += layers * rows * D.columns.size * steps * _SKY
            else:
                whole *= (1 + own) * channels
                seconds += whole * (steps * _SKY + blocks * _COPY)
                inner = (1 + own) * D.rows.size + layers * rows
                seconds += inner * patches * channels * steps * _WINDOW
                seconds += layers * rows * patches * channels * blocks * _COPY
        else:
            # Direct-sun coefficients of pictures are traced for the time steps with sun
            each = layers * rows * (held.columns.size if held else steps)
            seconds += each * channels * len(chain.receiving) * _COPY
            if held and held.columns.kind == "sky":
                seconds += each * bands * steps * _SKY
        seconds += layers * rows * steps * bands * _VALUE
    return seconds


def hour_bytes(study: Study) -> int:
    """Return the size of results.nc per sensor and time step [bytes]."""
    # Illuminance, terms, sun, luminaires, and errors with their components
    variables = 2 + COUNT // 4 + bool(study.lighting)
    if needs_direct(study):
        variables += 2 + COUNT // 4 + 3 * study.corrected
    return 4 * variables
