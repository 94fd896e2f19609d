"""Trace what the sensors of a study need, or find it again from an earlier run.

Nothing here depends on which state of a shade acts when: every matrix is traced once,
and rules choose among what is known.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from jaxtyping import Int

from clerestory.errors import InputError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.five import FivePhases, five_phase
from clerestory.phases.shaded import (
    ShadedWindow,
    States,
    shaded_five_phase,
    shaded_sun,
    shaded_three_phase,
)
from clerestory.phases.sun import blackened, sun_coefficients
from clerestory.phases.three import three_phase_sum
from clerestory.phases.trace import daylight_matrix, view_matrices
from clerestory.sky.matrix import SkyMatrix
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.suns import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.study.coefficients import TwoPhases, trace_coefficients
from clerestory.study.config import Study
from clerestory.study.job import DIRECT, STATE, SUN, Display, Job
from clerestory.study.window_groups import WindowGroup


@dataclass(frozen=True, eq=False)
class Skies:
    """Skies of a study: the whole, and the sun alone where direct light is needed."""

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
    return Skies(make(), make(include="sun") if needs_direct(study) else None)


def needs_direct(study: Study) -> bool:
    """Whether direct light is traced apart: five-phase method, or LM-83's rule."""
    rules = [window.control.rule for window in study.window if window.control]
    return study.method == "5-phase" or (study.method == "3-phase" and "LM-83" in rules)


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

    def direct_illuminance(self, skies: Skies, states: States) -> np.ndarray:
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
        return np.asarray(found["illuminance"].values)

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


def trace_study(job: Job) -> Tracing:
    """Return the matrices of a study; those of an earlier run are not traced again.

    Raises
    ------
    InputError : a rule asks for what the method does not know
    """
    study = job.study
    if study.method == "2-phase":
        if any(w.control and w.control.rule == "LM-83" for w in study.window):
            raise InputError(
                'rule "LM-83" by the two-phase method, which does not know direct'
                " light; the three- or five-phase method expected"
            )
        return Tracing(coefficients=trace_coefficients(job))
    whole = _windows(job, direct=False)
    if not needs_direct(study):
        return Tracing(whole=whole)
    black = _blackened(job)
    direct = _windows(black, direct=True)
    if study.method != "5-phase":
        return Tracing(whole=whole, direct=direct)
    suns = study_suns(study, job.inputs.weather)
    sun = tuple(
        tuple(_sun(black, group, number, state, suns) for state in range(count))
        for number, group in enumerate(job.inputs.groups)
        for count in (len(group.states),)
    )
    return Tracing(whole=whole, direct=direct, sun=sun, suns=suns)


def study_suns(study: Study, weather: Weather) -> SunMatrix:
    """Return the suns of the five-phase method."""
    table, rotation = study.sun, study.sky.rotation_deg
    if table.places == "patches":
        return patch_suns(weather, rotation_deg=rotation)
    return sun_matrix(weather, tolerance_deg=table.tolerance_deg, rotation_deg=rotation)


def _blackened(job: Job) -> Job:
    # What the five-phase method takes away and puts back is traced in the dark
    inputs = replace(job.inputs, scene=blackened(job.scene))
    return replace(job, inputs=inputs)


def _windows(job: Job, *, direct: bool) -> tuple[ShadedWindow, ...]:
    # All views are traced at once, each daylight matrix on its own
    views = _views(job, direct=direct)
    return tuple(
        ShadedWindow(
            views[group.name],
            tuple(state.transmission for state in group.states),
            _daylight(job, group, number, direct=direct),
        )
        for number, group in enumerate(job.inputs.groups)
    )


def _prefix(direct: bool) -> str:
    return "direct-" if direct else ""


def _sun(
    job: Job, group: WindowGroup, number: int, state: int, suns: SunMatrix
) -> TransferMatrix:
    chosen, sensors = group.states[state], job.inputs.sensors()
    windows = [each.inner for each in job.inputs.groups]
    options: dict[str, Any] = {
        "samples": job.study.sun.samples,
        "peak": chosen.peak,
        "seed": job.seed(SUN + number + STATE * state),
        "device": job.device,
    }
    key = fingerprint(
        "sun", job.scene_key, windows, number, chosen.fine, sensors, suns.directions,
        options,
    )  # fmt: skip
    label = f"{group.name}-{chosen.name}" if chosen.name else group.name

    def make() -> TransferMatrix:
        return sun_coefficients(
            job.scene,
            windows,
            group.name,
            chosen.fine,
            sensors=sensors,
            suns=suns.directions,
            executor=job.executor,
            progress=job.display(f"direct sun through {label}"),
            **options,
        )

    return job.matrix(f"sun-{label}", key, make)


def _views(job: Job, *, direct: bool) -> dict[str, TransferMatrix]:
    sensors, options = job.inputs.sensors(), job.options(DIRECT * direct)
    if direct:
        options["bounces"] = 1  # the gather at the sensor itself
    groups: Sequence[WindowGroup] = job.inputs.groups
    inner = {f"{_prefix(direct)}view-{group.name}": group.inner for group in groups}
    key = fingerprint("view", job.scene_key, list(inner.values()), sensors, options)

    def make() -> dict[str, TransferMatrix]:
        traced = view_matrices(
            job.scene,
            list(inner.values()),
            sensors=sensors,
            executor=job.executor,
            progress=job.display(f"{_prefix(direct)}view matrices"),
            **options,
        )
        return {name: traced[window.name] for name, window in inner.items()}

    kept = job.matrices(list(inner), key, make)
    return {window.name: kept[name] for name, window in inner.items()}


def _daylight(
    job: Job, group: WindowGroup, number: int, *, direct: bool
) -> TransferMatrix:
    # Each window has a seed of its own, apart from that of the view matrices
    options = job.options(stream=1 + number + DIRECT * direct)
    if direct:
        options["bounces"] = 0
    options["subdivision"] = job.study.sky.subdivision
    key = fingerprint("daylight", job.scene_key, group.outer, options)
    name = f"{_prefix(direct)}daylight-{group.name}"

    def make() -> TransferMatrix:
        progress = job.display(f"{_prefix(direct)}daylight matrix of {group.name}")
        return daylight_matrix(
            job.scene,
            group.outer,
            executor=job.executor,
            progress=progress,
            **options,
        )

    return job.matrix(name, key, make)
