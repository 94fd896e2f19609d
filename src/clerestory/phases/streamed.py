"""Illuminance of studies larger than memory: products streamed over sensors.

    I(t) = V · X(t),   X(t) = T(t) D S(t)

What leaves the windows, X, is small: patches of all windows × steps. V comes from its
file block by block of sensors, and the results of a block go to theirs. Time grows in
proportion to sensors × patches × steps; memory does not grow with sensors.

Errors of V and D are independent, and so are those of D of different windows.
Component k of all of them is taken at once, (V + V_k)(X + X_k) − V X: that leaves the
expected variance as it is, and takes one product for each component of all.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.bands import RGB
from clerestory.errors import MatrixError
from clerestory.files import replace_path
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.pooled import FEW, pooled
from clerestory.phases.shaded import States
from clerestory.phases.stored_views import StoredViews, ViewBlock
from clerestory.progress import Progress
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.product import fold, lit_steps, product_blocks

# Sensors multiplied at a time: 5800 patches with their components take 119 MB
_SENSORS = 1024

# Sensors and steps of a chunk of the results
_CHUNK = 256, 730

_WEIGHTS = RGB.weights


@dataclass(frozen=True, eq=False)
class Opening:
    """One window group without its view: what it lets in.

    Attributes
    ----------
    transmissions : T of every state, from the most open to the most closed
    daylight : D, from the sky to its outer patches
    """

    transmissions: tuple[TransferMatrix, ...]
    daylight: TransferMatrix


@dataclass(frozen=True, eq=False)
class Leaving:
    """What leaves all windows, window by window, in the steps with light.

    Attributes
    ----------
    steps : their numbers
    values : light of the patches, weighted by luminance; a channel for each of V's
    components : its errors
    """

    steps: Int[np.ndarray, " lit"]
    values: Float32[np.ndarray, "channel patch lit"]
    components: Float32[np.ndarray, "component channel patch lit"]


def leaving_light(
    openings: Sequence[Opening], sky: SkyMatrix, states: States, *, channels: int
) -> Leaving:
    """Return T(t) D S(t) of all windows.

    Parameters
    ----------
    states : number of the state at each step of the sky, per window
    channels : of the view matrices; of a grey room one is enough

    Raises
    ------
    MatrixError : a state that does not exist, or T and D that do not fit
    """
    steps = lit_steps(sky.diffuse, sky.sun)
    patches = sum(o.transmissions[0].rows.size for o in openings)
    values = np.zeros((channels, patches, len(steps)), np.float32)
    components = np.zeros((FEW, *values.shape), np.float32)
    first = 0
    for opening, state in zip(openings, states, strict=True):
        place = slice(first, first + opening.transmissions[0].rows.size)
        layers = _layers(opening.daylight)
        # One channel carries all weights; three carry one each
        for channel, weight in enumerate(_weights(channels)):
            arrived = _arrived(layers, weight, sky, steps)
            left = _left(opening, channel, arrived, np.asarray(state)[steps])
            values[channel, place], components[:, channel, place] = left[0], left[1:]
        first = place.stop
    return Leaving(steps, values, components)


def _layers(daylight: TransferMatrix) -> Float32[np.ndarray, "layer colour outer sky"]:
    # D and its error components
    values = daylight.values.astype(np.float32)
    if daylight.components is None:
        none = np.zeros((FEW, *values.shape), np.float32)
        return np.concatenate([values[None], none])
    return np.concatenate([values[None], pooled(daylight.components, FEW)])


def _weights(channels: int) -> Float[np.ndarray, "channel 3"]:
    return np.diag(_WEIGHTS) if channels == 3 else _WEIGHTS[None]


def _arrived(
    daylight: Float[np.ndarray, "layer colour outer sky"],
    weight: Float[np.ndarray, "3"],
    sky: SkyMatrix,
    steps: Int[np.ndarray, " lit"],
) -> Float32[np.ndarray, "layer outer lit"]:
    # D S, its channels summed up by weight
    layers, _, outer, patches = daylight.shape
    sun_colour = np.repeat(sky.sun_colour[:, None], patches, axis=1)
    rows = [
        fold(daylight, colour, weight).reshape(-1, patches)
        for colour in (sky.colour, sun_colour)
    ]
    found = np.empty((layers * outer, len(steps)), np.float32)
    done = 0
    for block, received in product_blocks(
        *rows, diffuse=sky.diffuse, direct=sky.sun, steps=steps
    ):
        found[:, done : done + len(block)] = received
        done += len(block)
    return found.reshape(layers, outer, -1)


def _left(
    opening: Opening,
    channel: int,
    arrived: Float32[np.ndarray, "layer outer lit"],
    state: Int[np.ndarray, " lit"],
) -> Float32[np.ndarray, "layer inner lit"]:
    # T of the state that acts at each step
    known = len(opening.transmissions)
    inner = opening.transmissions[0].rows.size
    found = np.empty((len(arrived), inner, len(state)), np.float32)
    for number in np.unique(state):
        if not 0 <= number < known:
            raise MatrixError(f"state {number} of a window with {known} states")
        T = opening.transmissions[number].values
        of = T[channel if len(T) == 3 else 0].astype(np.float32)
        found[:, :, state == number] = of @ arrived[:, :, state == number]
    return found


def stream_illuminance(
    path: str | Path,
    views: StoredViews,
    leaving: Leaving,
    sky: SkyMatrix,
    *,
    progress: Progress | None = None,
) -> None:
    """Write illuminance and standard error [lux] over (sensor, time) to a NetCDF file.

    Parameters
    ----------
    leaving : of the same windows as the views, in the same order
    sky : that it was made with
    progress : called with the share done, 0…1, and a note

    Raises
    ------
    MatrixError : views and windows do not fit
    OutputError : the file cannot be written
    """
    with replace_path(path) as made, h5netcdf.File(made, "w") as file:
        times = np.asarray(sky.times, "datetime64[ns]").astype(np.int64)
        file.dimensions = {"sensor": views.sensors, "time": len(times)}
        clock = file.create_variable("time", ("time",), data=times)
        clock.attrs["units"] = "nanoseconds since 1970-01-01 00:00:00"
        names = ("illuminance", "standard_error")
        lux, error = (
            hourly_variable(file, name, views.sensors, len(times)) for name in names
        )
        lux.attrs["units"] = error.attrs["units"] = "lux"
        error.attrs["long_name"] = "standard error of the illuminance"
        light = [leaving.values, *(leaving.values + n for n in leaving.components)]
        columns = [_rows(each) for each in light]
        for block in views.blocks(_SENSORS):
            _require_fit(block, leaving)
            night = np.zeros((2, block.rows.stop - block.rows.start, len(times)), "f4")
            night[:, :, leaving.steps] = received(block, columns)
            lux[block.rows], error[block.rows] = night
            if progress is not None:
                done = block.rows.stop
                progress(done / views.sensors, f"{done} of {views.sensors} sensors")


def _require_fit(block: ViewBlock, leaving: Leaving) -> None:
    channels, _, columns = block.values.shape
    if leaving.values.shape[:2] != (channels, columns):
        raise MatrixError(
            f"light of {leaving.values.shape[1]} patches in {len(leaving.values)}"
            f" channels; {columns} in {channels} expected"
        )


def received(
    block: ViewBlock, light: Sequence[Float32[np.ndarray, "patch lit"]]
) -> Float32[np.ndarray, "2 sensor lit"]:
    """Illuminance [lux] of some sensors in the steps with light, and its error.

    Parameters
    ----------
    light : of the patches, channels below each other; then with each component added
    """
    total = _columns(block.values) @ light[0]
    variance = np.zeros_like(total)
    for part, other in zip(block.components, light[1:], strict=True):
        variance += np.square(_columns(block.values + part) @ other - total)
    return np.stack([total, np.sqrt(variance)])


def _columns(values: Float32[np.ndarray, "channel row patch"]) -> np.ndarray:
    # Channels side by side
    return np.moveaxis(values, 0, 1).reshape(values.shape[1], -1)


def _rows(values: Float32[np.ndarray, "channel patch step"]) -> np.ndarray:
    # Channels below each other
    return values.reshape(-1, values.shape[-1])


def hourly_variable(
    file: h5netcdf.File, name: str, sensors: int, steps: int
) -> h5netcdf.Variable:
    """Return a new variable over (sensor, time) of a file that has these dimensions.

    Its chunks serve readers of some sensors and of some steps alike.
    """
    chunks = min(_CHUNK[0], sensors), min(_CHUNK[1], steps)
    return file.create_variable(name, ("sensor", "time"), "f4", chunks=chunks)
