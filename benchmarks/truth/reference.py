"""The truth of a façade: illuminance and glare, with standard errors."""

import importlib
from collections.abc import Sequence
from datetime import datetime
from functools import cache
from typing import Any, Protocol

import numpy as np

import clerestory as cl
from clerestory.engine.device import load
from clerestory.image.camera import Camera
from clerestory.scene.sensors import Sensors
from truth.facades import Kind
from truth.jackknife import glare
from truth.kept import Arrays
from truth.slats import PixelPaths, Slats


class Truth(Protocol):
    """Path tracing of one façade."""

    def illuminance(
        self,
        hours: cl.Weather,
        moment: datetime,
        sensors: Sensors,
        *,
        samples: int,
        seed: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Illuminance of sensors, and its standard error [lux]."""

    def picture(
        self,
        hours: cl.Weather,
        moment: datetime,
        camera: Camera,
        *,
        paths: PixelPaths,
        seed: int,
    ) -> np.ndarray:
        """Radiance of a camera's pixels by independent parts (part, pixel, channel)."""


@cache
def truth(kind: Kind) -> Truth:
    """Return the reference of a façade."""
    return Slats(kind) if kind.clear is None else film(kind)


@cache
def film(kind: Kind, *, mirrors: bool = True) -> Any:
    """Return the reference of a film; see `truth.film.Film`."""
    # Kernels are built for a device that is loaded before them
    load()
    return importlib.import_module("truth.film").Film(kind, mirrors=mirrors)


def illuminances(
    kind: Kind, hours: cl.Weather, sensors: Sensors, *, samples: int, seed: int = 0
) -> Arrays:
    """Return `lux` (sensor, step) and `lux_error`."""
    found = [
        truth(kind).illuminance(hours, time, sensors, samples=samples, seed=seed + step)
        for step, time in enumerate(hours.times.tolist())
    ]
    lux, error = np.moveaxis(np.array(found), 0, -1)
    return {"lux": lux, "lux_error": error}


def glares(
    kind: Kind, hours: cl.Weather, cameras: Sequence[Camera], *, paths: PixelPaths
) -> Arrays:
    """Return `glare` (index, eye, step) and `glare_error`."""
    found = []
    for number, camera in enumerate(cameras):
        for step, time in enumerate(hours.times.tolist()):
            seed = 1000 * (number + 1) + step
            parts = truth(kind).picture(hours, time, camera, paths=paths, seed=seed)
            made = glare(camera, parts)
            found.append((made.value, made.error))
    # From eye, step, value or error, and index
    shape = len(cameras), len(hours.times), 2, -1
    whole = np.array(found).reshape(shape)
    value, error = np.moveaxis(whole, (2, 3), (0, 1))
    return {"glare": value, "glare_error": error}
