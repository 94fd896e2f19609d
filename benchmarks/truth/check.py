"""The film's truth by a second route: the package's path tracer with its own cones.

It finds the sun behind prisms by cones of directions that it learns from particles
(`engine.learned_caustics`), and no part of `truth/film.py`. All light is in it, also
sun that the film mirrors back outdoors.
"""

import numpy as np

import clerestory as cl
from clerestory.phases.rendering import irradiance
from truth.facades import Kind
from truth.kept import Arrays
from truth.setting import demo, weather
from truth.slats import portal

# Steps of the weather: one hour of each day
STEPS = 2, 6, 10


def traced(kind: Kind, samples: int) -> Arrays:
    """Return `lux` (sensor, step) of a few steps, and `lux_error`."""
    scene, window, sensors, _ = demo()
    room = scene + kind.geometry() + portal(window)
    lux, error = [], []
    for step in STEPS:
        light = cl.sky_at(weather(), weather().times[step].item())
        made = irradiance(room + light, sensors, samples=samples, seed=2)
        lux.append(made.illuminance())
        error.append(made.illuminance_error)
    return {"lux": np.array(lux).T, "lux_error": np.array(error).T}
