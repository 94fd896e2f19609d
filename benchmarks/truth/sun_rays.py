"""Sun straight from a film, by rays of its disc: sensors, and images that eyes see."""

import mitsuba as mi
import numpy as np

from clerestory.bands import RGB
from clerestory.engine.lower import LoweredScene
from clerestory.engine.upload import vectors
from clerestory.image.camera import Camera
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import solid_angles
from truth.beams import Beams
from truth.setting import ORIGIN


def direct_sun(
    sun: Beams, room: LoweredScene, sensors: Sensors
) -> tuple[np.ndarray, np.ndarray]:
    """Illuminance of sensors by sun straight from the film, and its error [lux]."""
    towards, count = -np.array(sun.direction).T.astype(float), int(sun.count[0])
    power = np.array(sun.irradiance) * RGB.weights.sum()
    found = []
    for place, normal in zip(sensors.position - ORIGIN, sensors.direction, strict=True):
        distance, met = _to_film(sun, towards, place)
        cosine = towards @ normal
        ray = np.flatnonzero(met & (cosine > 0))
        line = mi.Ray3f(
            vectors(mi.Point3f, np.broadcast_to(place, (len(ray), 3))),
            vectors(mi.Vector3f, towards[ray]),
            mi.Float(distance[ray] - 1e-4),
            0,
            [],
        )
        clear = ~np.array(room.scene.ray_test(line)) if len(ray) else np.zeros(0)
        values = np.zeros(count)
        values[ray] = power[ray] * cosine[ray] * clear
        found.append((values.mean(), values.std() / np.sqrt(count)))
    return tuple(np.array(found).T)


def _to_film(
    sun: Beams, towards: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    # Distance to the film against the rays, and whether its sunlit part is met
    distance = -place[1] / towards[:, 1]
    x, _, z = (place + distance[:, None] * towards).T
    low_x, high_x, low_z, high_z = (float(edge[0]) for edge in sun.lit)
    met = (distance > 0) & (x > low_x) & (x < high_x) & (z > low_z) & (z < high_z)
    return distance, met


def sun_images(sun: Beams, camera: Camera, parts: int) -> np.ndarray:
    """Return the radiance of the sun behind the film (part, pixel), by its rays.

    The parts have different rays, and are independent.
    """
    towards = -np.array(sun.direction).T.astype(float)
    place = camera.position - ORIGIN
    _, seen = _to_film(sun, towards, place)
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
