"""Small scenes whose light has a closed form."""

import numpy as np

from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window


def quad(*corners, material="wall"):
    """A polygon through the given corners."""
    return Polygon(np.array(corners, dtype=float), material, "quad")


def sensor(position, direction):
    """One sensor."""
    return Sensors(
        np.array([position], dtype=float), np.array([direction], dtype=float)
    )


def grey(reflectance, **kwargs):
    """A matt material."""
    return Plastic("wall", np.broadcast_to(reflectance, 3).astype(float), **kwargs)


def window(*polygons, name="south", up=(0, 0, 1), basis="full"):
    """A window group whose normal is that of its first polygon."""
    v = polygons[0].vertices
    normal = np.cross(v[1] - v[0], v[2] - v[1])
    frame = Frame.from_normal_up(normal, np.array(up, dtype=float))
    return Window(name, polygons, frame, klems(basis))


def box(width, depth, height, reflectance, **kwargs):
    """A room without its south wall, and the window that fills the gap."""
    w, d, h = width, depth, height
    walls = (
        quad((0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0)),
        quad((0, 0, h), (0, d, h), (w, d, h), (w, 0, h)),
        quad((0, 0, 0), (0, d, 0), (0, d, h), (0, 0, h)),
        quad((w, 0, 0), (w, 0, h), (w, d, h), (w, d, 0)),
        quad((0, d, 0), (w, d, 0), (w, d, h), (0, d, h)),
    )
    south = window(quad((0, 0, 0), (0, 0, h), (w, 0, h), (w, 0, 0)))
    return Scene({"wall": grey(reflectance, **kwargs)}, walls), south


def endless_ground(reflectance):
    """A ground of a given reflectance at z = 0, as far as sensors can tell."""
    far = 1e5
    corners = (-far, -far, 0), (far, -far, 0), (far, far, 0), (-far, far, 0)
    return Scene({"wall": grey(reflectance)}, (quad(*corners),))
