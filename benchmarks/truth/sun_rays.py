"""Sun through a façade by rays of its disc: flux, sensors, and images in a film."""

import numpy as np

import clerestory as cl
from clerestory.bands import RGB
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import lower
from clerestory.image.camera import Camera
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import solid_angles
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


def sun_images(sun: Beams, camera: Camera, parts: int) -> np.ndarray:
    """Return the radiance of the sun behind the film (part, pixel), by its rays.

    The parts have different rays, and are independent.
    """
    towards = -np.array(sun.direction).T.astype(float)
    place = camera.position - ORIGIN
    distance = -place[1] / towards[:, 1]
    x, _, z = (place + distance[:, None] * towards).T
    low_x, high_x, low_z, high_z = (float(edge[0]) for edge in sun.lit)
    seen = (distance > 0) & (x > low_x) & (x < high_x) & (z > low_z) & (z < high_z)
    size = {"columns": camera.columns, "rows": camera.rows}
    row, column = np.floor(camera.view.pixel(towards[seen], **size)).astype(int).T
    ahead = camera.view.rays(**size).valid
    inside = (
        (row >= 0) & (row < camera.rows) & (column >= 0) & (column < camera.columns)
    )
    inside[inside] &= ahead[row[inside], column[inside]]
    pixel = (row * camera.columns + column)[inside]
    ray = np.flatnonzero(seen)[inside]
    power = np.array(sun.irradiance)[ray] * parts / int(sun.count[0])
    place_in = (ray % parts) * len(camera) + pixel
    found = np.bincount(place_in, power, parts * len(camera))
    area = solid_angles(camera.view, camera.columns, camera.rows).ravel()
    return found.reshape(parts, -1) / np.maximum(area, 1e-12)
