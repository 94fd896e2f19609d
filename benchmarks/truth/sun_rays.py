"""Sun through a façade by rays of its disc: flux, and illuminance of sensors."""

import numpy as np

import clerestory as cl
from clerestory.bands import RGB
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import lower
from clerestory.scene.sensors import Sensors
from truth.beams import Beams, beams
from truth.facades import Kind
from truth.setting import HEIGHT, ORIGIN, PLANE, WIDTH


def through(
    kind: Kind, hours: cl.Weather, sensors: Sensors
) -> tuple[np.ndarray, np.ndarray]:
    """Return the flux per area of the window (step) [W/m²], and direct illuminance.

    The illuminance (sensor, step) [lux] is that by sun straight from the window.
    """
    [part] = kind.parts
    middle = np.array([WIDTH / 2, PLANE, (part.low + part.high) / 2])
    system = lower(part.geometry(), origin=middle)
    flux, direct = [], []
    for time in hours.times.tolist():
        sun = beams(system, part, DistantEmitters.of(cl.sky_at(hours, time)))
        across = np.array(sun.irradiance) * np.array(sun.direction)[1]
        low_x, high_x, low_z, high_z = (float(edge[0]) for edge in sun.lit)
        lit = (high_x - low_x) * (high_z - low_z) / (WIDTH * HEIGHT)
        flux.append(across.mean() * lit)
        direct.append(direct_sun(sun, sensors))
    return np.array(flux), np.array(direct).T


def direct_sun(sun: Beams, sensors: Sensors) -> np.ndarray:
    """Illuminance of sensors by sun that arrives straight from the window [lux]."""
    towards = -np.array(sun.direction).T.astype(float)
    low_x, high_x, low_z, high_z = (float(edge[0]) for edge in sun.lit)
    found = []
    pairs = zip(sensors.position - ORIGIN, sensors.direction, strict=True)
    for place, normal in pairs:
        distance = -place[1] / towards[:, 1]
        x, _, z = (place + distance[:, None] * towards).T
        met = (x > low_x) & (x < high_x) & (z > low_z) & (z < high_z)
        received = np.array(sun.irradiance) * np.maximum(towards @ normal, 0)
        found.append(np.sum(received * met) / int(sun.count[0]) * RGB.weights.sum())
    return np.array(found)
