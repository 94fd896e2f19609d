"""The demo's room, its eyes, its sunny hours, and the systems in its window."""

from dataclasses import dataclass, replace
from importlib import resources

import numpy as np

import clerestory as cl
from clerestory.bsdfgen.extrusion import extruded
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.image.camera import Camera
from clerestory.scene.model import Dielectric, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.scene.window import Window

WIDTH, HEIGHT, SILL, PLANE = 6.1, 1.8, 0.85, -0.1

# The wall's outer face, up to which the reveal shades the window
FACE = -0.25

# Pixels along the edge of the eyes' pictures
EDGE = 140

_BLIND = {"slat_width": 0.08, "spacing": 0.072, "reflectance": 0.48}
_PRISMS = {"upper_angle_deg": 60.0, "lower_angle_deg": 75.0}

# Prisms as large as these bend light as small ones do, and cost fewer polygons
_PITCH, _BASE = 5e-3, 1e-3


@dataclass(frozen=True, eq=False)
class Kind:
    """A system to compare by.

    Attributes
    ----------
    name : for the tables
    cell : from which its BSDF is made
    peak : whether sun passes it straight
    clear : whether it is made of prisms, through which no shadow ray finds the sun
    """

    name: str
    cell: System
    peak: bool = True
    clear: bool = False

    def geometry(self) -> Scene:
        """Return the system across the whole window, in the room's frame."""
        if self.clear:
            return _across(_film(), HEIGHT / 2)
        tilt = 45.0 if "45" in self.name else 0.0
        slat, pitch, thick, tone = 0.08, 0.072, 0.0, 0.48
        if self.name.startswith("microlouvre"):
            slat, thick, tone = 1.25e-3, 0.22e-3, 0.1
            pitch = thick + slat * np.tan(np.radians(40.0))
        slats = venetian(
            slat_width=slat, spacing=pitch, tilt_deg=tilt, thickness=thick,
            reflectance=tone, slats=round(HEIGHT / pitch), length=WIDTH,
        )  # fmt: skip
        return _across(slats.scene, slats.scene.bounds().mean(axis=0)[1])


def kinds() -> dict[str, Kind]:
    """Return the systems by a short name."""
    return {
        "flat": Kind("venetian blind, 0°", venetian(tilt_deg=0, **_BLIND)),
        "tilted": Kind("venetian blind, 45°", venetian(tilt_deg=45, **_BLIND)),
        "louvre": Kind("microlouvre, 40° cut-off", microlouvre()),
        "film": Kind(
            "prismatic film, 60° and 75°", prismatic(**_PRISMS), peak=False, clear=True
        ),
    }


def _film() -> Scene:
    """Return prisms enough for the window's height, as wide as the window."""
    up, down = (1 / np.tan(np.radians(angle)) for angle in _PRISMS.values())
    height = _PITCH / (up + down)
    teeth = [
        (number * _PITCH + y, z)
        for number in range(round(HEIGHT / _PITCH) - 1, -1, -1)
        for y, z in ((height * down, -_BASE - height), (0.0, -_BASE))
    ]
    saw = np.array([(HEIGHT, -_BASE), *teeth])
    flat = np.array([(0.0, 0.0), (HEIGHT, 0.0)])
    surfaces = [
        polygon
        for name, section in (("prism", saw), ("sheet", flat))
        for polygon in extruded(section, ends=(0, WIDTH), material="film", name=name)
    ]
    return Scene({"film": Dielectric("film", np.ones(3), 1.49)}, tuple(surfaces))


def _across(scene: Scene, middle: float) -> Scene:
    """Return a system with its inner side in the window's plane."""
    low, high = scene.bounds()
    moved = []
    for surface in scene.surfaces:
        x, y, z = surface.vertices.T
        vertices = np.stack(
            [
                WIDTH / 2 - (x - (low[0] + high[0]) / 2),
                PLANE + (z - high[2]),
                SILL + HEIGHT / 2 + (y - middle),
            ],
            axis=-1,
        )
        moved.append(replace(surface, vertices=vertices))
    return Scene(scene.materials, tuple(moved))


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


def cameras() -> list[Camera]:
    """Return what the eyes see, half a sphere each."""
    _, _, sensors, level = demo()
    places = zip(sensors.position[~level], sensors.direction[~level], strict=True)
    return [
        Camera(View("angular", place, facing, horizontal=180.0, vertical=180.0), *size)
        for place, facing in places
        for size in [(EDGE, EDGE)]
    ]


def weather(hours: tuple[tuple[str, range], ...] | None = None) -> cl.Weather:
    """Return sunny hours in Berkeley, near the equinox and the solstices."""
    days = hours or (
        ("03-21", range(9, 17, 2)),
        ("06-21", range(9, 17, 2)),
        ("12-21", range(9, 17, 2)),
    )
    moments = [f"2023-{day}T{hour:02d}:30" for day, span in days for hour in span]
    times = np.array(moments, dtype="datetime64[m]")
    return cl.Weather(
        place="Berkeley", latitude_deg=37.87, longitude_deg=-122.26, elevation=0.0,
        utc_offset_hours=-8.0, times=times, step_minutes=60.0,
        direct_normal=np.full(len(times), 700.0),
        diffuse_horizontal=np.full(len(times), 120.0), source="clear hours",
    )  # fmt: skip


def pictured() -> cl.Weather:
    """Return the hours that pictures are made of, two of each day."""
    return weather(tuple((day, range(9, 14, 4)) for day in ("03-21", "06-21", "12-21")))
