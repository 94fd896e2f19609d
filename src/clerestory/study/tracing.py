"""Trace what a study needs, or find it again from an earlier run."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import xarray as xr

from clerestory import __version__
from clerestory.engine.device import resolve
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.store import MatrixStore
from clerestory.phases.three import WindowPhases, three_phase_sum
from clerestory.phases.trace import (
    Progress,
    daylight_coefficients,
    daylight_matrix,
    view_matrices,
)
from clerestory.phases.two import two_phase
from clerestory.sky.matrix import SkyMatrix
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs, WindowGroup

# Starts the display of one phase, given its name
Display = Callable[[str], Progress]


@dataclass(frozen=True, eq=False)
class Tracing:
    """Traced matrices of a study.

    Attributes
    ----------
    windows : V, T and D of each window group; empty for the two-phase method
    coefficients : for the two-phase method
    found : whether each matrix was found in the store, by its file's name
    """

    windows: tuple[WindowPhases, ...] = ()
    coefficients: TransferMatrix | None = None
    found: dict[str, bool] = field(default_factory=dict)

    def illuminance(self, sky: SkyMatrix, *, display: Display) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error."""
        progress = display("multiply")
        if self.coefficients is not None:
            return two_phase(self.coefficients, sky, progress=progress)
        return three_phase_sum(self.windows, sky, progress=progress)


def trace_study(
    study: Study, inputs: Inputs, *, store: MatrixStore, display: Display
) -> Tracing:
    """Return the matrices of a study; those of an earlier run are not traced again."""
    job = _Job(study, inputs, store, display, fingerprint(__version__, inputs.scene))
    return _coefficients(job) if study.method == "2-phase" else _windows(job)


@dataclass(frozen=True, eq=False)
class _Job:
    # What every matrix of a study needs; `scene` is the scene's fingerprint
    study: Study
    inputs: Inputs
    store: MatrixStore
    display: Display
    scene: str

    def options(self, stream: int = 0) -> dict[str, Any]:
        """How long to trace, and with which random numbers."""
        trace = self.study.trace
        return {
            **trace.goal(),
            "bounces": trace.bounces,
            "seed": (trace.seed + stream) % 2**32,
            "device": resolve(trace.device),
        }


def _coefficients(job: _Job) -> Tracing:
    sensors, options = job.inputs.sensors(), job.options()
    options["subdivision"] = job.study.sky.subdivision
    key, name = fingerprint("coefficients", job.scene, sensors, options), "coefficients"
    found = {job.store.path(name, key).name: job.store.holds(name, key)}

    def make() -> TransferMatrix:
        progress = job.display("daylight coefficients")
        return daylight_coefficients(
            job.inputs.scene, sensors=sensors, progress=progress, **options
        )

    return Tracing((), job.store.matrix(name, key, make), found)


def _windows(job: _Job) -> Tracing:
    # All views are traced at once, each daylight matrix on its own
    groups = job.inputs.groups
    views, found = _views(job)
    windows = []
    for number, group in enumerate(groups):
        daylight, known = _daylight(job, group, number)
        found |= known
        windows.append(WindowPhases(views[group.name], group.transmission, daylight))
    return Tracing(tuple(windows), None, found)


def _views(job: _Job) -> tuple[dict[str, TransferMatrix], dict[str, bool]]:
    sensors, options = job.inputs.sensors(), job.options()
    inner = {f"view-{group.name}": group.inner for group in job.inputs.groups}
    key = fingerprint("view", job.scene, list(inner.values()), sensors, options)
    found = {job.store.path(n, key).name: job.store.holds(n, key) for n in inner}

    def make() -> dict[str, TransferMatrix]:
        traced = view_matrices(
            job.inputs.scene,
            list(inner.values()),
            sensors=sensors,
            progress=job.display("view matrices"),
            **options,
        )
        return {name: traced[window.name] for name, window in inner.items()}

    kept = job.store.matrices(list(inner), key, make)
    return {window.name: kept[name] for name, window in inner.items()}, found


def _daylight(
    job: _Job, group: WindowGroup, number: int
) -> tuple[TransferMatrix, dict[str, bool]]:
    # Each window has a seed of its own, apart from that of the view matrices
    options = job.options(stream=1 + number)
    options["subdivision"] = job.study.sky.subdivision
    key = fingerprint("daylight", job.scene, group.outer, options)
    name = f"daylight-{group.name}"
    found = {job.store.path(name, key).name: job.store.holds(name, key)}

    def make() -> TransferMatrix:
        progress = job.display(f"daylight matrix of {group.name}")
        return daylight_matrix(
            job.inputs.scene, group.outer, progress=progress, **options
        )

    return job.store.matrix(name, key, make), found
