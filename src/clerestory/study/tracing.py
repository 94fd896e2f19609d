"""Trace what a study needs, or find it again from an earlier run."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import xarray as xr

from clerestory import __version__
from clerestory.engine.device import resolve
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.five import FivePhases, five_phase
from clerestory.phases.pictures import Camera, picture_view_matrices
from clerestory.phases.store import MatrixStore
from clerestory.phases.sun import blackened, sun_coefficients
from clerestory.phases.three import WindowPhases, three_phase_sum
from clerestory.phases.trace import (
    Progress,
    daylight_coefficients,
    daylight_matrix,
    view_matrices,
)
from clerestory.phases.two import two_phase
from clerestory.scene.model import Scene
from clerestory.sky.matrix import SkyMatrix
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.suns import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.window_groups import WindowGroup

# Random numbers of the direct phases and of the suns, apart from those of V and D
_DIRECT, _SUN = 0x10000, 0x20000

# Starts the display of one phase, given its name
Display = Callable[[str], Progress]


@dataclass(frozen=True, eq=False)
class Skies:
    """Skies of a study: the whole, and the sun alone for the five-phase method."""

    whole: SkyMatrix
    sun: SkyMatrix | None = None


def study_skies(study: Study, weather: Weather) -> Skies:
    """Return the skies that the method of a study asks for."""
    make = partial(
        sky_matrix,
        weather,
        subdivision=study.sky.subdivision,
        ground_reflectance=study.sky.ground_reflectance,
        rotation_deg=study.sky.rotation_deg,
    )
    if study.method != "5-phase":
        return Skies(make())
    return Skies(make(), make(include="sun"))


@dataclass(frozen=True, eq=False)
class Tracing:
    """Traced matrices of a study.

    Attributes
    ----------
    windows : V, T and D of each window group; empty for the two-phase method
    coefficients : for the two-phase method
    direct : the direct phases of each window group, for the five-phase method
    suns : that the columns of C_ds stand for
    found : whether each matrix was found in the store, by its file's name
    """

    windows: tuple[WindowPhases, ...] = ()
    coefficients: TransferMatrix | None = None
    direct: tuple[FivePhases, ...] = ()
    suns: SunMatrix | None = None
    found: dict[str, bool] = field(default_factory=dict)

    def illuminance(self, skies: Skies, *, display: Display) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error."""
        progress = display("multiply")
        if self.coefficients is not None:
            return two_phase(self.coefficients, skies.whole, progress=progress)
        if self.suns is None or skies.sun is None:
            return three_phase_sum(self.windows, skies.whole, progress=progress)
        return five_phase(
            self.direct, skies.whole, skies.sun, self.suns, progress=progress
        )


def trace_study(
    study: Study, inputs: Inputs, *, store: MatrixStore, display: Display
) -> Tracing:
    """Return the matrices of a study; those of an earlier run are not traced again."""
    job = study_job(study, inputs, store=store, display=display)
    if study.method == "2-phase":
        return _coefficients(job)
    whole = _windows(job)
    return _with_direct(job, whole) if study.method == "5-phase" else whole


@dataclass(frozen=True, eq=False)
class Job:
    """What every matrix of a study needs.

    Attributes
    ----------
    scene : that is traced
    direct : whether it is black and nothing is reflected, for what the five-phase
        method takes away
    """

    study: Study
    inputs: Inputs
    store: MatrixStore
    display: Display
    scene: Scene
    direct: bool = False

    @cached_property
    def scene_key(self) -> str:
        """Fingerprint of the scene."""
        return fingerprint(__version__, self.scene)

    @property
    def prefix(self) -> str:
        """What the names of matrices begin with."""
        return "direct-" if self.direct else ""

    def options(self, stream: int = 0) -> dict[str, Any]:
        """How long to trace, and with which random numbers."""
        trace = self.study.trace
        return {
            **trace.goal(),
            "bounces": trace.bounces,
            "seed": (trace.seed + stream) % 2**32,
            "device": resolve(trace.device),
        }


def study_job(
    study: Study, inputs: Inputs, *, store: MatrixStore, display: Display
) -> Job:
    """Return what the matrices of a study need."""
    return Job(study, inputs, store, display, inputs.scene)


def picture_views(
    job: Job, camera: Camera, label: str
) -> tuple[dict[str, TransferMatrix], dict[str, TransferMatrix] | None]:
    """Return V of a picture by window name, and V_d if the method asks for it."""
    whole = _picture_views(job, camera, label, direct=False)
    if job.study.method != "5-phase":
        return whole, None
    return whole, _picture_views(job, camera, label, direct=True)


def _picture_views(
    job: Job, camera: Camera, label: str, *, direct: bool
) -> dict[str, TransferMatrix]:
    table = next(view for view in job.study.view if view.label == label)
    options = job.options(_DIRECT * direct)
    del options["relative_error" if "relative_error" in options else "samples"]
    options |= {"samples": table.samples, "direct": direct}
    prefix = "direct-picture" if direct else "picture"
    inner = {f"{prefix}-{label}-{g.name}": g.inner for g in job.inputs.groups}
    key = fingerprint("picture", job.scene_key, list(inner.values()), camera, options)

    def make() -> dict[str, TransferMatrix]:
        progress = job.display(f"{prefix} matrices of {label}")
        traced = picture_view_matrices(
            job.scene, list(inner.values()), camera, progress=progress, **options
        )
        return {name: traced[window.name] for name, window in inner.items()}

    kept = job.store.matrices(list(inner), key, make)
    return {window.name: kept[name] for name, window in inner.items()}


def _coefficients(job: Job) -> Tracing:
    sensors, options = job.inputs.sensors(), job.options()
    options["subdivision"] = job.study.sky.subdivision
    name = "coefficients"
    key = fingerprint(name, job.scene_key, sensors, options)
    found = {job.store.path(name, key).name: job.store.holds(name, key)}

    def make() -> TransferMatrix:
        progress = job.display("daylight coefficients")
        return daylight_coefficients(
            job.inputs.scene, sensors=sensors, progress=progress, **options
        )

    matrix = job.store.matrix(name, key, make)
    return Tracing(coefficients=matrix, found=found)


def _windows(job: Job) -> Tracing:
    # All views are traced at once, each daylight matrix on its own
    groups = job.inputs.groups
    views, found = _views(job)
    windows = []
    for number, group in enumerate(groups):
        daylight, known = _daylight(job, group, number)
        found |= known
        windows.append(
            WindowPhases(views[group.name], group.states[0].transmission, daylight)
        )
    return Tracing(windows=tuple(windows), found=found)


def _with_direct(job: Job, whole: Tracing) -> Tracing:
    # The direct phases of each window group, and its coefficients for the suns
    black = replace(job, scene=blackened(job.scene), direct=True)
    direct = _windows(black)
    suns = _suns(job)
    found = whole.found | direct.found
    parts = []
    for number, group in enumerate(job.inputs.groups):
        matrix, known = _sun(black, group, number, suns)
        found |= known
        parts.append(FivePhases(whole.windows[number], direct.windows[number], matrix))
    return Tracing(windows=whole.windows, direct=tuple(parts), suns=suns, found=found)


def _suns(job: Job) -> SunMatrix:
    table, rotation = job.study.sun, job.study.sky.rotation_deg
    if table.places == "patches":
        return patch_suns(job.inputs.weather, rotation_deg=rotation)
    return sun_matrix(
        job.inputs.weather, tolerance_deg=table.tolerance_deg, rotation_deg=rotation
    )


def _sun(
    job: Job, group: WindowGroup, number: int, suns: SunMatrix
) -> tuple[TransferMatrix, dict[str, bool]]:
    sensors = job.inputs.sensors()
    windows = [each.inner for each in job.inputs.groups]
    options: dict[str, Any] = {
        "samples": job.study.sun.samples,
        "peak": group.states[0].peak,
        "seed": (job.study.trace.seed + _SUN + number) % 2**32,
        "device": resolve(job.study.trace.device),
    }
    key = fingerprint(
        "sun", job.scene_key, windows, number, group.states[0].fine, sensors,
        suns.directions, options,
    )  # fmt: skip
    name = f"sun-{group.name}"
    found = {job.store.path(name, key).name: job.store.holds(name, key)}

    def make() -> TransferMatrix:
        return sun_coefficients(
            job.scene,
            windows,
            group.name,
            group.states[0].fine,
            sensors=sensors,
            suns=suns.directions,
            progress=job.display(f"direct sun through {group.name}"),
            **options,
        )

    return job.store.matrix(name, key, make), found


def _views(job: Job) -> tuple[dict[str, TransferMatrix], dict[str, bool]]:
    sensors, options = job.inputs.sensors(), job.options(_DIRECT * job.direct)
    if job.direct:
        options["bounces"] = 1  # the gather at the sensor itself
    groups = job.inputs.groups
    inner = {f"{job.prefix}view-{group.name}": group.inner for group in groups}
    key = fingerprint("view", job.scene_key, list(inner.values()), sensors, options)
    found = {job.store.path(n, key).name: job.store.holds(n, key) for n in inner}

    def make() -> dict[str, TransferMatrix]:
        traced = view_matrices(
            job.scene,
            list(inner.values()),
            sensors=sensors,
            progress=job.display(f"{job.prefix}view matrices"),
            **options,
        )
        return {name: traced[window.name] for name, window in inner.items()}

    kept = job.store.matrices(list(inner), key, make)
    return {window.name: kept[name] for name, window in inner.items()}, found


def _daylight(
    job: Job, group: WindowGroup, number: int
) -> tuple[TransferMatrix, dict[str, bool]]:
    # Each window has a seed of its own, apart from that of the view matrices
    options = job.options(stream=1 + number + _DIRECT * job.direct)
    if job.direct:
        options["bounces"] = 0
    options["subdivision"] = job.study.sky.subdivision
    key = fingerprint("daylight", job.scene_key, group.outer, options)
    name = f"{job.prefix}daylight-{group.name}"
    found = {job.store.path(name, key).name: job.store.holds(name, key)}

    def make() -> TransferMatrix:
        progress = job.display(f"{job.prefix}daylight matrix of {group.name}")
        return daylight_matrix(job.scene, group.outer, progress=progress, **options)

    return job.store.matrix(name, key, make), found
