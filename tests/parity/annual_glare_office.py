"""An office with three façades, with annual glare by full Radiance renderings.

raytraverse's data set (stephanwaz/raytraverse): clear glass; translucent glass above;
clear glass opposite a façade of glossy metal. Three views, 2,022 sunny hours.
"""

import resource
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.phases.matrix_equation import Skies
from clerestory.scene.view import View
from clerestory.sky.sun_matrix import sun_matrix

VIEWS = 3


@dataclass(frozen=True)
class Facade:
    """One of the façades: files of the scene, and the name of its results."""

    name: str
    title: str
    option: str
    room: str = "office"
    points: str = "sensors"


FACADES = (
    Facade("01_glz", "clear glass", "clear"),
    Facade("04_trn", "translucent top", "20per_toptranslucent"),
    Facade("06_nmt", "metal opposite", "north_metal", "office_n", "sensors_n"),
)


def scene_of(folder: Path, facade: Facade) -> cl.Scene:
    """Return room, glazing and façade opposite."""
    option, room = f"options/{facade.option}.rad", f"rad/{facade.room}.rad"
    return cl.read_rad(folder / option, folder / room)


def views_of(folder: Path, facade: Facade) -> list[View]:
    """Return the views; each is from a point of its own, or shares it."""
    points = np.loadtxt(folder / f"points/{facade.points}.txt")
    return [
        View("angular", row[:3], row[3:], horizontal=180.0, vertical=180.0)
        for row in points
    ]


def reference(folder: Path, facade: Facade, view: int) -> np.ndarray:
    """Return the table of a view: `ann_hour`, `illum`, `dgp`, `ugp` and others."""
    file = folder / f"reference/{facade.name}_v{view + 1}_refrt.tsv"
    return np.genfromtxt(file, names=True)


def weather_of(folder: Path, hours: np.ndarray) -> cl.Weather:
    """Return the hours of the reference; gendaylit's dew point is 11 °C."""
    year = cl.read_weather(folder / "weather/geneva.epw")
    return replace(year.select(hours), dew_point_c=None)


def skies_of(weather: cl.Weather) -> Skies:
    """Return S, S_ds and S_sun with Radiance's solar positions and a grey sky."""
    grey = {"sun_formula": "radiance", "sky_colour": (1.0, 1.0, 1.0)}
    S, S_ds = (cl.sky_matrix(weather, include=part, **grey) for part in ("all", "sun"))
    return Skies(S, S_ds, sun_matrix(weather, sun_formula="radiance"))


def processor_seconds() -> float:
    """Return the processor time of this process and its children."""
    both = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in both)


def unified_glare_probability(ugr: np.ndarray) -> np.ndarray:
    """Return UGP as raytraverse computes it from UGR."""
    return (1 + 2 / 7 * 10 ** (-(ugr + 5) / 40)) ** -10


@dataclass(frozen=True, eq=False)
class Found:
    """Results of a program for one façade and view, hour by hour."""

    lux: np.ndarray
    dgp: np.ndarray
    ugp: np.ndarray
    seconds: float
    error: np.ndarray | None = None


def ours(scene: cl.Scene, view: View, skies: Skies) -> Found:
    """Return our results; processor time includes building the kernels."""
    start = processor_seconds()
    names = "dgp", "illuminance", "ugr"
    found = cl.glazed_view_glare(scene, [view], skies=skies, quantities=names, seed=1)
    lux, dgp, ugr, error = (
        found[name].values[0] for name in ("illuminance", "dgp", "ugr", "dgp_error")
    )
    seconds = processor_seconds() - start
    return Found(lux, dgp, unified_glare_probability(ugr), seconds, error)
