"""Windows whose shades move: the phases with another T at every step.

    I(t) = Σ V T(t) D S(t)  − Σ V_d T(t) D_d S_ds(t)  + Σ C_ds(t) S_sun(t)

What arrives at a window, D S, is the same in all its states, and so is the way from
the window to the sensors, V. The state only decides by which T the patches of one side
send to those of the other: a year with many states costs what one with a single state
does.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.bands import RGB
from clerestory.errors import MatrixError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix, illuminance_dataset
from clerestory.phases.five import sum_of_terms, sun_illuminance
from clerestory.phases.three import WindowPhases
from clerestory.progress import Progress
from clerestory.sky.patch_radiance import SkyMatrix, SkyResponse
from clerestory.sky.product import lit_steps
from clerestory.sky.sun_matrix import SunMatrix

# Steps and sensors multiplied at a time: 32 components of 64 sensors take 4 MB
_STEPS = 512
_SENSORS = 64

States = Sequence[Int[np.ndarray, " time"]]


@dataclass(frozen=True, eq=False)
class ShadedWindow:
    """One window group and the states of its shades.

    Attributes
    ----------
    view : V, from its patches on the room side to the sensors
    transmissions : T of every state, from the most open to the most closed
    daylight : D, from the sky to its outer patches

    Raises
    ------
    MatrixError : no states, or states over different patches
    """

    view: TransferMatrix
    transmissions: tuple[TransferMatrix, ...]
    daylight: TransferMatrix

    def __post_init__(self) -> None:
        if not self.transmissions:
            raise MatrixError("a window without states; at least one expected")
        for matrix in self.transmissions:
            if not (
                self.view.columns.fits(matrix.rows)
                and matrix.columns.fits(self.daylight.rows)
            ):
                raise MatrixError(
                    f"a state of {matrix.rows.describe()} by"
                    f" {matrix.columns.describe()}; {self.view.columns.describe()} by"
                    f" {self.daylight.rows.describe()} expected"
                )

    def at(self, state: int) -> WindowPhases:
        """Return the window in one of its states."""
        return WindowPhases(self.view, self.transmissions[state], self.daylight)

    def without_error(self, rows: slice | np.ndarray | None = None) -> "ShadedWindow":
        """Return the same without error components, for some of the sensors."""
        view = self.view.values[:, slice(None) if rows is None else rows]
        return ShadedWindow(
            TransferMatrix(view, sensor_axis(view.shape[1]), self.view.columns),
            self.transmissions,
            replace(self.daylight, components=None),
        )


def shaded_three_phase(
    windows: Sequence[ShadedWindow],
    sky: SkyMatrix,
    states: States,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] behind windows whose states change, with its standard error.

    Parameters
    ----------
    windows : their view matrices have the same sensors and were traced together
    sky : S
    states : number of the state at each step, per window
    progress : called with the share done, 0…1, and a note

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time), float32

    Raises
    ------
    MatrixError : states that do not exist, or as many steps as the sky has not

    Notes
    -----
    With one state at all steps it is `three_phase_sum`, up to rounding.
    """
    _check_states([len(w.transmissions) for w in windows], states, len(sky.times))
    sensors = windows[0].view.rows
    shape = (sensors.size, len(sky.times))
    lux, error = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    steps = lit_steps(sky.diffuse, sky.sun)
    for first in range(0, len(steps), _STEPS):
        block = steps[first : first + _STEPS]
        part = sky.select(block)
        sent = [
            _sent(window, part, state[block])
            for window, state in zip(windows, states, strict=True)
        ]
        for rows, values, spread in _received(windows, sent):
            lux[rows, block], error[rows, block] = values, spread
        if progress is not None:
            done = min(first + _STEPS, len(steps))
            progress(done / len(steps), f"{done} of {len(steps)} steps")
    return illuminance_dataset(lux, error, sensors=sensors, times=sky.columns)


def shaded_five_phase(
    whole: Sequence[ShadedWindow],
    direct: Sequence[ShadedWindow],
    sun: Sequence[Sequence[TransferMatrix]],
    sky: SkyMatrix,
    sun_in_patches: SkyMatrix,
    suns: SunMatrix,
    states: States,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] by the five-phase method behind windows whose states change.

    Parameters
    ----------
    whole, direct : V, T, D and V_d, T, D_d of every window
    sun : C_ds of every window in each of its states
    sky, sun_in_patches, suns : S, S_ds and S_sun, see `five_phase`
    states : number of the state at each step, per window

    Returns
    -------
    as `five_phase`
    """
    # I = V T D S − V_d T D_d S_ds + C_ds S_sun
    VTDS = shaded_three_phase(whole, sky, states, progress=progress)
    VdTDdSds = shaded_three_phase(direct, sun_in_patches, states)
    CdsSsun = shaded_sun(sun, suns, states)
    return sum_of_terms(VTDS, VdTDdSds, CdsSsun)


def shaded_sun(
    coefficients: Sequence[Sequence[TransferMatrix]], suns: SunMatrix, states: States
) -> xr.Dataset:
    """Illuminance [lux] from direct sun, each window in the state that acts.

    Parameters
    ----------
    coefficients : C_ds of every window in each of its states, traced independently
    """
    _check_states([len(each) for each in coefficients], states, len(suns.times))
    sensors = coefficients[0][0].rows
    shape = (sensors.size, len(suns.times))
    lux, variance = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    for matrices, state in zip(coefficients, states, strict=True):
        for number, matrix in enumerate(matrices):
            steps = np.flatnonzero(state == number)
            if len(steps):
                part = sun_illuminance([matrix], suns.select(steps))
                lux[:, steps] += part["illuminance"].values
                variance[:, steps] += part["standard_error"].values ** 2
    return illuminance_dataset(
        lux, np.sqrt(variance), sensors=sensors, times=suns.columns
    )


def _check_states(counts: Sequence[int], states: States, steps: int) -> None:
    for count, state in zip(counts, states, strict=True):
        if len(state) != steps:
            raise MatrixError(
                f"{len(state)} states for {steps} steps; as many expected"
            )
        if steps and not 0 <= int(state.min()) <= int(state.max()) < count:
            raise MatrixError(
                f"states from {state.min()} to {state.max()}; 0 to {count - 1} expected"
            )


def _sent(
    window: ShadedWindow, sky: SkyMatrix, state: Int[np.ndarray, " time"]
) -> TransferMatrix:
    # T (D S): what leaves the patches of the room side at each step
    arrived = SkyResponse(window.daylight, sky).rgb()
    columns = arrived.columns
    patches = window.view.columns
    values = np.empty((3, patches.size, columns.size), np.float32)
    parts = arrived.components
    components = None
    if parts is not None:
        parts = parts.astype(np.float32)
        components = np.empty((len(parts), *values.shape), np.float32)
    for number in np.unique(state):
        steps = state == number
        T = window.transmissions[number].values
        values[:, :, steps] = T @ arrived.values[:, :, steps]
        if parts is not None and components is not None:
            components[..., steps] = T.astype(np.float32) @ parts[..., steps]
    return TransferMatrix(values, patches, columns, components)


def _received(
    windows: Sequence[ShadedWindow], sent: Sequence[TransferMatrix]
) -> Iterator[
    tuple[slice, Float[np.ndarray, "sensor time"], Float[np.ndarray, "sensor time"]]
]:
    # Blocks of sensors, their illuminance and its standard error. Views of windows
    # share their paths: component k of one goes with component k of the others.
    count = windows[0].view.rows.size
    light = [_below_each_other(each.values) for each in sent]
    noise = [
        None if each.components is None else _below_each_other(each.components)
        for each in sent
    ]
    for first in range(0, count, _SENSORS):
        rows = slice(first, min(first + _SENSORS, count))
        total: Float[np.ndarray, "sensor time"] = np.zeros(())
        variance: Float[np.ndarray, "sensor time"] = np.zeros(())
        shared: dict[int, np.ndarray] = {}
        for number, window in enumerate(windows):
            view = window.view.select_rows(rows)
            lux = _beside_each_other(view.values)
            total = total + lux @ light[number]
            if view.components is not None:
                own = _beside_each_other(view.components) @ light[number]
                shared[len(own)] = shared.get(len(own), 0) + own
            spread = noise[number]
            if spread is not None:
                variance = variance + np.square(lux @ spread).sum(axis=0)
        variance = variance + sum(np.square(own).sum(axis=0) for own in shared.values())
        yield rows, total, np.sqrt(np.broadcast_to(variance, total.shape))


def _beside_each_other(values: np.ndarray) -> np.ndarray:
    # (…, channel, sensor, patch) as lux per radiance, (…, sensor, channel × patch)
    weights = RGB.weights.astype(np.float32)
    shape = (*values.shape[:-3], len(weights), *values.shape[-2:])
    each = np.broadcast_to(values.astype(np.float32), shape) * weights[:, None, None]
    side = np.moveaxis(each, -3, -2)
    return np.ascontiguousarray(side).reshape(*side.shape[:-2], -1)


def _below_each_other(values: np.ndarray) -> np.ndarray:
    # (…, channel, patch, time) as (…, channel × patch, time)
    return values.reshape(*values.shape[:-3], -1, values.shape[-1])
