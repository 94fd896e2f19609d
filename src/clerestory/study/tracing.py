"""Trace what a study needs, or find it again from an earlier run."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import xarray as xr

from clerestory import __version__
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
    if study.method == "2-phase":
        return _trace_coefficients(study, inputs, store, display)
    return _trace_windows(study, inputs, store, display)


def _trace_coefficients(
    study: Study, inputs: Inputs, store: MatrixStore, display: Display
) -> Tracing:
    sensors, options = inputs.sensors(), _options(study)
    subdivision = study.sky.subdivision
    key = fingerprint(
        "coefficients", __version__, inputs.scene, sensors, subdivision, options
    )
    found = {store.path("coefficients", key).name: store.holds("coefficients", key)}

    def make() -> TransferMatrix:
        return daylight_coefficients(
            inputs.scene,
            sensors=sensors,
            subdivision=subdivision,
            progress=display("daylight coefficients"),
            **options,
        )

    return Tracing((), store.matrix("coefficients", key, make), found)


def _trace_windows(
    study: Study, inputs: Inputs, store: MatrixStore, display: Display
) -> Tracing:
    sensors, options = inputs.sensors(), _options(study)
    inner = [group.inner for group in inputs.groups]
    key = fingerprint("view", __version__, inputs.scene, inner, sensors, options)
    names = [f"view-{group.name}" for group in inputs.groups]
    found = {store.path(name, key).name: store.holds(name, key) for name in names}

    def make() -> dict[str, TransferMatrix]:
        traced = view_matrices(
            inputs.scene,
            inner,
            sensors=sensors,
            progress=display("view matrices"),
            **options,
        )
        return {f"view-{name}": matrix for name, matrix in traced.items()}

    views = store.matrices(names, key, make)
    windows = []
    for number, group in enumerate(inputs.groups):
        daylight = _daylight(study, inputs, group, number, store, display, found)
        view = views[f"view-{group.name}"]
        windows.append(WindowPhases(view, group.transmission, daylight))
    return Tracing(tuple(windows), None, found)


def _daylight(
    study: Study,
    inputs: Inputs,
    group: WindowGroup,
    number: int,
    store: MatrixStore,
    display: Display,
    found: dict[str, bool],
) -> TransferMatrix:
    # Each window has a seed of its own, apart from that of the view matrices
    options = _options(study, stream=1 + number)
    subdivision = study.sky.subdivision
    key = fingerprint(
        "daylight", __version__, inputs.scene, group.outer, subdivision, options
    )
    name = f"daylight-{group.name}"
    found[store.path(name, key).name] = store.holds(name, key)

    def make() -> TransferMatrix:
        return daylight_matrix(
            inputs.scene,
            group.outer,
            subdivision=subdivision,
            progress=display(f"daylight matrix of {group.name}"),
            **options,
        )

    return store.matrix(name, key, make)


def _options(study: Study, stream: int = 0) -> dict[str, Any]:
    # How long and with which random numbers to trace
    trace = study.trace
    return {
        **trace.goal(),
        "bounces": trace.bounces,
        "seed": (trace.seed + stream) % 2**32,
        "device": trace.device,
    }
