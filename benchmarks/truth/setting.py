"""The demo's room, its eyes, and the sunny hours of the comparisons."""

from importlib import resources

import numpy as np

import clerestory as cl
from clerestory.image.camera import Camera
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window, window_of

WIDTH, HEIGHT, SILL, PLANE = 6.1, 1.8, 0.85, -0.1
HEAD = SILL + HEIGHT

# Middle of the window, from which coordinates of rays are counted
ORIGIN = np.array([WIDTH / 2, PLANE, SILL + HEIGHT / 2])

# The wall's outer face, up to which the reveal shades the window
FACE = -0.25

# Pixels along the edge of the eyes' pictures
EDGE = 140

_DAYS = "03-21", "06-21", "12-21"


def demo() -> tuple[Scene, Window, Sensors, np.ndarray]:
    """Return room, window, sensors, and which of these are horizontal."""
    with resources.as_file(resources.files("clerestory") / "demo") as folder:
        scene = cl.read_rad(folder / "materials.rad", folder / "room.rad")
        window = cl.read_window(folder / "window.rad")
        desks = cl.read_sensors(folder / "desks.pts")
        eyes = cl.read_sensors(folder / "eyes.pts")
    every = slice(2, None, 5)
    sensors = Sensors(
        np.concatenate([desks.position[every], eyes.position]),
        np.concatenate([desks.direction[every], eyes.direction]),
    )
    return scene, window, sensors, sensors.direction[:, 2] > 0.5


def pane(name: str, low: float, high: float) -> Window:
    """Return the part of the window between two heights [m]."""
    corners = [(WIDTH, low), (0.0, low), (0.0, high), (WIDTH, high)]
    vertices = np.array([(x, PLANE, z) for x, z in corners])
    return window_of((Polygon(vertices, name, name),), name=name)


def cameras() -> list[Camera]:
    """Return what the eyes see, half a sphere each."""
    _, _, sensors, level = demo()
    places = zip(sensors.position[~level], sensors.direction[~level], strict=True)
    return [
        Camera(View("angular", place, facing, horizontal=180.0, vertical=180.0), *size)
        for place, facing in places
        for size in [(EDGE, EDGE)]
    ]


def weather(
    moments: list[str] | None = None, *, utc_offset_hours: float = -8.0
) -> cl.Weather:
    """Return sunny hours in Berkeley, by default near equinox and solstices."""
    usual = [f"{day}T{hour:02d}:30" for day in _DAYS for hour in range(9, 17, 2)]
    times = np.array(
        [f"2023-{moment}" for moment in moments or usual], dtype="datetime64[m]"
    )
    return cl.Weather(
        place="Berkeley", latitude_deg=37.87, longitude_deg=-122.26, elevation=0.0,
        utc_offset_hours=utc_offset_hours, times=times, step_minutes=60.0,
        direct_normal=np.full(len(times), 700.0),
        diffuse_horizontal=np.full(len(times), 120.0), source="clear hours",
    )  # fmt: skip


def moment(hour: int) -> cl.Weather:
    """Return one of the sunny hours."""
    return weather([f"{weather().times[hour]}"[5:]])


def pictured() -> cl.Weather:
    """Return the hours that pictures are made of, two of each day."""
    return weather([f"{day}T{hour:02d}:30" for day in _DAYS for hour in (9, 13)])
