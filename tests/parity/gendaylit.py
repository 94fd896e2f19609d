"""Skies of gendaylit and gensky, and what rtrace sees of them.

gendaylit scales Perez's sky to the diffuse irradiance by a sum over the 145 points
of Tregenza, as if they were equal in solid angle, with the sun turned to azimuth 0.
"""

import os
import re
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyradiance

from clerestory.hemisphere.reinhart import reinhart
from clerestory.sky.point_sky import PointSky, perez_point
from clerestory.sky.weather import Weather

LIBRARY = Path(pyradiance.__file__).parent
ENVIRONMENT = {**os.environ, "RAYPATH": str(LIBRARY / "lib")}
GLOW = "\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source all 0 0 4 0 0 1 360\n"


def run(*command, **more) -> bytes:
    """Return what a program of Radiance prints."""
    return subprocess.run(
        [LIBRARY / "bin" / command[0], *map(str, command[1:])],
        capture_output=True,
        check=True,
        env=ENVIRONMENT,
        **more,
    ).stdout


def trace(description: str, directions: np.ndarray, folder: Path) -> np.ndarray:
    """Radiance of a Radiance sky in some directions."""
    (folder / "sky.rad").write_text(description + GLOW)
    (folder / "sky.oct").write_bytes(run("oconv", folder / "sky.rad"))
    rays = np.hstack([np.zeros_like(directions), directions])
    text = "\n".join(" ".join(map(repr, ray.tolist())) for ray in rays)
    output = run(
        "rtrace", "-h", "-ab", 0, "-w", folder / "sky.oct", input=text.encode()
    )
    return np.array([line.split()[1] for line in output.splitlines()], dtype=float)


def blended(sky: np.ndarray, ground: float, directions: np.ndarray) -> np.ndarray:
    """Radiance's sky functions blend sky and ground around the horizon."""
    above, below = (directions[:, 2] + 1.01) ** 10, (directions[:, 2] + 1.01) ** -10
    return (above * sky + below * ground) / (above + below)


def upward_directions(count: int = 100) -> np.ndarray:
    """Unit vectors above the horizon, drawn at random."""
    vectors = np.random.default_rng(4).normal(size=(count, 3))
    vectors[:, 2] = np.abs(vectors[:, 2]) + 0.05
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def random_moment(random) -> tuple[Weather, str, str]:
    """One step with the sun well up, and its day and hour as gendaylit wants them."""
    day = np.datetime64("2023-01-01") + random.integers(365)
    minutes = int(random.integers(9 * 60, 15 * 60))
    weather = Weather(
        place="anywhere",
        latitude_deg=45.0,
        longitude_deg=10.0,
        elevation=0.0,
        utc_offset_hours=1.0,
        times=np.array([day.astype("datetime64[s]") + 60 * minutes]),
        step_minutes=60.0,
        direct_normal=np.array([random.choice([0.0, 20, 100, 300, 600, 900])]),
        diffuse_horizontal=np.array([random.uniform(20, 400)]),
    )
    return weather, str(day), f"{minutes / 60:.6f}"


def gendaylit(weather: Weather, day: str, hour: str) -> str:
    """Return gendaylit's description of the sky of one moment."""
    _, month, date = day.split("-")
    place = "-a", 45, "-o", -10, "-m", -15
    levels = weather.direct_normal[0], weather.diffuse_horizontal[0]
    return run("gendaylit", month, date, hour, *place, "-W", *levels).decode()


def coarse_sum(sky: PointSky) -> float:
    """Return gendaylit's sum over a relative sky, where the integral is meant."""
    glow = sky.distribution.centre
    points = reinhart(1).dome.centres()
    turned = np.array([0.0, np.hypot(glow[0], glow[1]), glow[2]])
    relative = replace(sky.distribution, centre=turned)(points, turned)
    return float(2 * np.pi / 145 * relative @ points[:, 2])


@dataclass(frozen=True)
class Likeness:
    """One sky of ours against gendaylit's.

    Attributes
    ----------
    parameters : largest difference of the five
    excess : of gendaylit's coarse sum over the integral, relative
    as_is, rescaled : largest relative difference of the radiance in a hundred
        directions, ours as it is and scaled by the same coarse sum as gendaylit's
    """

    parameters: float
    excess: float
    as_is: float
    rescaled: float


def likeness(random, folder: Path) -> Likeness:
    """Compare a random sky."""
    weather, day, hour = random_moment(random)
    sky = perez_point(weather, sun_formula="radiance")
    text = gendaylit(weather, day, hour)
    found = re.search(r"perezlum.cal\n0\n10 (.*)", text)
    _, ground, *parameters = map(float, found.group(1).split())
    shape = sky.distribution
    ours = np.array([shape.a, shape.b, shape.c, shape.d, shape.e])

    # Radiance in some directions, by either scale
    directions = upward_directions()
    theirs = trace(text, directions, folder)
    integral = sky.diffuse_horizontal() / sky.scale
    excess = coarse_sum(sky) / integral - 1
    off = [
        np.max(np.abs(blended(values, ground, directions) / theirs - 1))
        for values in (
            sky.radiance(directions),
            sky.radiance(directions) / (1 + excess),
        )
    ]
    return Likeness(
        float(np.max(np.abs(ours - parameters[:5]))),
        excess,
        float(off[0]),
        float(off[1]),
    )
