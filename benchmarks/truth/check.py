"""The film's truth by a second route: blind path tracing under a large sun.

A sun of some degrees, as strong as the real one, is met by chance by paths that ask
for nothing. That is slow and needs no argument: all light is in it, sun that the film
mirrors back outdoors included.
"""

from dataclasses import replace

import numpy as np

import clerestory as cl
from clerestory.bands import RGB
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import Scene
from truth.setting import Kind, demo, weather
from truth.slats import portal

SUN_DEG = 10.0

# The truth needs so many times fewer paths
_FEWER = 8

_LUX = RGB.weights

# One hour of each day
HOURS = ("2023-03-21T11:30", "2023-06-21T11:30", "2023-12-21T13:30")


def compared(film, kind: Kind, samples: int) -> dict[str, np.ndarray]:
    """Illuminance [lux] of the sensors by both routes (sensor, hour), and its error."""
    scene, window, sensors, _ = demo()
    room = scene + kind.geometry() + portal(window)
    ours, blind, error = [], [], []
    for hour in HOURS:
        light = large_sun(cl.sky_at(weather(), np.datetime64(hour).item()))
        ours.append(film.under(light, samples=max(1, samples // _FEWER), seed=1))
        made = irradiance(room + light, sensors, samples=samples, seed=2)
        blind.append(made.illuminance())
        error.append(made.error @ _LUX)
    return {"ours": np.array(ours), "blind": np.array(blind), "error": np.array(error)}


def large_sun(light: Scene) -> Scene:
    """Return a sky whose sun is large and sends as much light."""
    distant, materials = [], dict(light.materials)
    for source in light.distant:
        if source.angle_deg > 1:
            distant.append(source)
            continue
        half, large = np.radians([source.angle_deg / 2, SUN_DEG / 2])
        share = (np.sin(half / 2) / np.sin(large / 2)) ** 2
        sun = materials[source.material]
        materials["large"] = replace(sun, name="large", radiance=sun.radiance * share)
        distant.append(replace(source, material="large", angle_deg=SUN_DEG))
    return replace(light, materials=materials, distant=tuple(distant))
