"""Images of the sun that an eye sees in a film, by rays of the disc through it."""

import numpy as np

from clerestory.image.camera import Camera
from clerestory.scene.view import solid_angles
from truth.beams import Beams
from truth.setting import ORIGIN


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
