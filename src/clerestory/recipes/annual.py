"""Annual illuminance and irradiance of the grids of a recipe, by the route of studies.

Models of plain glass are simulated by the two-phase method, others by the five-phase
method, both with the sun at its exact position. Window groups with states are separate
light paths: their light is stored for each state.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

import numpy as np
from jaxtyping import Bool, Float

from clerestory.checks import require
from clerestory.cluster.cluster import executor_at
from clerestory.errors import located
from clerestory.escaping import file_stem
from clerestory.file_lock import locked
from clerestory.files import make_folder
from clerestory.metrics.honeybee import STATIC, Light
from clerestory.metrics.honeybee_writer import Arrays, GridRecord, hours_of_year
from clerestory.phases.matrix_equation import Skies
from clerestory.phases.matrix_store import MatrixStore
from clerestory.phases.unscattered_light import sun_visible
from clerestory.recipes.inputs import traced_effort
from clerestory.recipes.model import RecipeModel
from clerestory.sky.sky_conditions import Spectrum, sun_over
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.weather_formats import read_weather
from clerestory.study.config import read_study
from clerestory.study.input_checks import warn_of_inputs
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Display, Job
from clerestory.study.model_import import write_building_model
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study

# Formula of the sun position: that of gendaymtx, which Ladybug Tools' recipes call
SUN_FORMULA: SunFormula = "radiance"

# Sensors of each block whose sun hours are traced at once
_BLOCK = 512

_Lux = Float[np.ndarray, "sensor time"]


@final
@dataclass(frozen=True, eq=False)
class AnnualLight:
    """Illuminance of grids over the time steps of a weather file [lux].

    Attributes
    ----------
    times : centres of the time steps, `timestep` an hour
    paths : for each light path and state, arrays by grid; only of the grids that have
        the light path in their record
    sun_up : whether the sun is above the horizon at each time step
    """

    grids: tuple[GridRecord, ...]
    times: np.ndarray
    timestep: int
    paths: Mapping[str, Mapping[str, Arrays]]
    sun_up: Bool[np.ndarray, " time"]

    @property
    def hours(self) -> Float[np.ndarray, " time"]:
        """Centres of the time steps, in hours of the year."""
        return hours_of_year(self.times)

    def total(self, grid: GridRecord, *, light: Light = "total") -> _Lux:
        """Return the light of all light paths, each in its first state."""
        switched, total = self.by_state(grid, light=light)
        return np.asarray(total + sum(states[0] for states in switched.values()))

    def by_state(
        self, grid: GridRecord, *, light: Light = "total"
    ) -> tuple[dict[str, Float[np.ndarray, "state sensor time"]], _Lux]:
        """Return the light of each path with several states, and that of the others."""
        fixed = np.zeros((grid.count, len(self.times)), np.float32)
        switched = {}
        for path in grid.light_paths:
            states = self.paths[path].values()
            found = [arrays[light][grid.full_id] for arrays in states]
            if len(found) == 1:
                fixed += found[0]
            else:
                switched[path] = np.stack(found)
        return switched, fixed


def check_timestep(weather: Path, timestep: int) -> None:
    """Require that a weather file has a number of time steps an hour."""
    minutes = read_weather(weather).step_minutes
    message = f'input "timestep" is {timestep}, but a step of the weather file is'
    require(
        abs(minutes * timestep - 60) < 1e-6,
        f"{message} {minutes:g} min; {60 / minutes:g} expected",
    )


def annual_light(
    chosen: RecipeModel,
    values: Mapping[str, Any],
    *,
    folder: Path,
    display: Display,
    spectrum: Spectrum = "visible",
) -> AnnualLight:
    """Trace a model and return the light of its grids at every time step.

    `values` are the inputs of a recipe. Matrices are stored in `folder`, so that an
    interrupted recipe can be resumed.
    """
    with recipe_job(chosen, values, folder=folder, display=display) as job:
        matrices = trace_study(job, spectrum=spectrum)
        skies = study_skies(job.study, job.inputs, matrices.suns, spectrum=spectrum)
        paths = _paths(job, matrices, skies, chosen)
    grids = tuple(_with_paths(record, paths) for record in chosen.grids)
    weather = job.inputs.weather
    sun = sun_over(weather, sun_formula=SUN_FORMULA)
    up = sun.altitude > 0
    return AnnualLight(grids, weather.times, values["timestep"], paths, up)


@contextmanager
def recipe_job(
    chosen: RecipeModel, values: Mapping[str, Any], *, folder: Path, display: Display
) -> Iterator[Job]:
    """Write a model as a study, and yield the job of its tracing.

    `values` are the inputs of a recipe, see `annual_light`. While it is open the folder
    is locked.
    """
    weather: Path = values["wea"]
    check_timestep(weather, values["timestep"])
    windows = bool(chosen.model.windows)
    sky = {"rotation_deg": float(values["north"]), "sun_formula": SUN_FORMULA}
    if "sky-density" in values:
        sky["subdivision"] = values["sky-density"]
    settings: dict[str, Any] = {
        "method": "5-phase" if windows else "2-phase",
        "view": [],
        "sky": sky,
        "trace": traced_effort(values["radiance-parameters"]),
    }
    make_folder(folder)
    with locked(folder, lock=folder / "run.lock"), executor_at(None) as executor:
        written = write_building_model(
            chosen.model, folder / "study", weather=weather, settings=settings
        )
        study = read_study(folder / "study" / "study.toml")
        inputs = read_inputs(study)
        require(written.study, "no sensor grid; grids or rooms with floors expected")
        warn_of_inputs(study, inputs)
        store = MatrixStore(folder / "matrices")
        scratch = make_folder(folder / "unfinished")
        yield Job(study, inputs, store, display, executor=executor, scratch=scratch)


def _paths(
    job: Job, matrices: StudyMatrices, skies: Skies, chosen: RecipeModel
) -> dict[str, dict[str, Arrays]]:
    # Light by path and state; groups of one state are added to the static path
    steps = len(skies.whole.times)
    found: dict[str, dict[str, Arrays]] = {}
    if not job.inputs.groups:
        return {STATIC: {"default": _arrays(job, matrices, skies, [], chosen)}}
    rows = job.inputs.rows("")
    for number, group in enumerate(job.inputs.groups):
        own = matrices.reduced([number], rows)
        for at, state in enumerate(group.states):
            states = [np.full(steps, at)]
            arrays = _arrays(job, own, skies, states, chosen)
            path = file_stem(group.name)
            if len(group.states) == 1:
                known = found.setdefault(STATIC, {})
                known["default"] = _added(known.get("default"), arrays)
            else:
                name = file_stem(f"{at}_{state.name or group.name}")
                found.setdefault(path, {})[name] = arrays
        if len(group.states) > 1 and len(found) > 1:
            found[path] = _lit(found[path])
    return found


def _lit(states: Mapping[str, Arrays]) -> dict[str, Arrays]:
    # Arrays of the grids that the light path lights in one of its states
    lit = {
        name
        for arrays in states.values()
        for name, lux in arrays["total"].items()
        if lux.any()
    }
    return {
        state: {
            light: {name: lux for name, lux in found.items() if name in lit}
            for light, found in arrays.items()
        }
        for state, arrays in states.items()
    }


def _with_paths(
    record: GridRecord, paths: Mapping[str, Mapping[str, Arrays]]
) -> GridRecord:
    own = [
        path
        for path, states in paths.items()
        if record.full_id in next(iter(states.values()))["total"]
    ]
    return replace(record, light_paths=tuple(own))


def _arrays(
    job: Job, matrices: StudyMatrices, skies: Skies, states: Any, chosen: RecipeModel
) -> Arrays:
    states = states or [np.zeros(len(skies.whole.times), dtype=int)]
    total = matrices.illuminance(skies, states)["illuminance"].values
    direct = matrices.direct_illuminance(skies, states)["illuminance"].values
    rows = {record.full_id: job.inputs.rows(n) for n, record in chosen.records.items()}
    return {
        "total": {name: total[which] for name, which in rows.items()},
        "direct": {name: direct[which] for name, which in rows.items()},
    }


def _added(one: Arrays | None, other: Arrays) -> Arrays:
    if one is None:
        return other
    return {
        light: {name: lux + one[light][name] for name, lux in found.items()}
        for light, found in other.items()
    }


def sunlit_hours(
    chosen: RecipeModel, values: Mapping[str, Any], *, display: Display
) -> AnnualLight:
    """Return 1 for each sensor and time step at which the sun is visible, otherwise 0.

    All steps of the weather file with the sun above the horizon count, whatever its
    irradiance. The sun is visible through plain glass and window groups. A sensor that
    sees the centre of its disc is in the sun, one that faces away from it is not.
    """
    check_timestep(values["wea"], values["timestep"])
    scene = chosen.model.scene
    with located(file=values["wea"]):
        weather = read_weather(values["wea"])
        north = float(values["north"])
        sun = sun_over(weather, rotation_deg=north, sun_formula=SUN_FORMULA)
    up = sun.altitude > 0
    towards = sun.directions()[up]
    found: dict[str, _Lux] = {}
    for name, record in chosen.records.items():
        progress = display(f"direct sun of {record.name}")
        sensors = chosen.model.grids[name]
        lit = np.zeros((record.count, len(weather)), dtype=np.float32)
        for first in range(0, record.count, _BLOCK):
            own = slice(first, first + _BLOCK)
            seen = sun_visible(scene, sensors.position[own], towards)
            lit[own, up] = seen & (sensors.direction[own] @ towards.T > 0)
            progress(min(1.0, (first + _BLOCK) / record.count), "")
        found[record.full_id] = lit
    arrays: Arrays = {"total": found, "direct": found}
    paths = {STATIC: {"default": arrays}}
    return AnnualLight(chosen.grids, weather.times, values["timestep"], paths, up)
