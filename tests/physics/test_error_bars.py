"""Every printed ± is the scatter of the result over runs with other seeds.

A share of the area depends on few sensors close to its threshold; several thresholds
are counted together.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.metrics.replicates import error_of_group_mean, errors_of
from clerestory.metrics.space import direct_sun
from clerestory.metrics.spatial_metrics import spatial_autonomy, sunlight_exposure
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View
from clerestory.study.config import Study, read_study
from clerestory.study.study_run import run_study

pytestmark = pytest.mark.slow

ROOM = Path(__file__).parents[1] / "cli" / "room"
SEEDS = [7919 * (number + 1) for number in range(40)]

# Twelve days, one a month, with 10 occupied hours each: ASE counts hours of a year
_MOST_HOURS = 10

# No samples and no relative error: the default mode
STUDY = """
title = "Repeated"
method = "5-phase"
[scene]
files = ["room.rad"]
[[window]]
name = "south"
file = "window.rad"
bsdf = "diffuser.xml"
[[sensors]]
file = "grid.pts"
[weather]
file = "days.wea"
[sky]
subdivision = 1
"""


def weather() -> Iterator[str]:
    """Lines of a weather file: twelve days at 47° N, from overcast to clear."""
    yield "place Test\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 400"
    yield "weather_data_file_units 1"
    for month in range(1, 13):
        height = 0.45 + 0.35 * np.cos((month - 6.5) / 6 * np.pi)
        clear = month * 7 % 12 / 11
        for hour in range(24):
            sine = max(0.0, np.sin((hour - 5.5) / 12 * np.pi)) * height
            direct = 850 * clear * sine**0.3 * (9 <= hour < 16)
            diffuse = 400 * sine * (1.2 - 0.7 * clear)
            yield f"{month} 15 {hour + 0.5} {direct:.1f} {diffuse:.1f}"


def study(folder: Path) -> Study:
    """The room of ten polygons, with 168 sensors."""
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    x, y = np.meshgrid(np.linspace(0.4, 3.6, 12), np.linspace(0.4, 4.6, 14))
    places = zip(x.ravel(), y.ravel(), strict=True)
    lines = [f"{a:.3f} {b:.3f} 0.8 0 0 1\n" for a, b in places]
    (folder / "grid.pts").write_text("".join(lines))
    (folder / "days.wea").write_text("\n".join(weather()) + "\n")
    (folder / "study.toml").write_text(STUDY)
    return read_study(folder / "study.toml")


def figures(data: xr.Dataset) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Values and standard errors of the results of one run."""
    lux, error = data["illuminance"], data["standard_error"]
    lit = lux.values > 10
    parts = (error * data["error_components"] / 127).mean("sensor")
    noon = np.flatnonzero(np.arange(288) % 24 == 12)
    found = {
        "illuminance": (np.where(lit, lux, 0), np.where(lit, error, 0)),
        "mean over sensors": (
            lux.mean("sensor").values[noon],
            np.linalg.norm(parts.transpose("component", "time").values, axis=0)[noon],
        ),
    }
    for name in (
        "mean_illuminance",
        "daylight_autonomy",
        "continuous_autonomy",
        "useful",
    ):
        components = data[f"{name}_components"].values
        values = data[name].values
        found[name] = values, data[f"{name}_error"].values
        found[f"{name}, grid"] = (
            values.mean(),
            np.array(error_of_group_mean(components)),
        )
    occupied, sun = data["occupied"].values, direct_sun(data)
    reached = [
        spatial_autonomy(lux, occupied, target_lux=target, **errors_of(data))
        for target in np.linspace(250, 900, 14)
    ]
    exposed = [
        sunlight_exposure(
            sun["illuminance"],
            occupied,
            sun_lux=limit,
            most_hours=_MOST_HOURS,
            **errors_of(sun),
        )
        for limit in np.linspace(200, 1600, 15)
    ]
    for name, shares in (("sDA", reached), ("ASE", exposed)):
        values, errors = zip(*((s.value, s.error) for s in shares), strict=True)
        found[name] = np.array(values), np.array(errors)
    return found


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("repeated")
    repeated = study(folder / "study")
    found = []
    for seed in SEEDS:
        chosen = repeated.with_trace(seed=seed, device="cpu", cluster=None)
        found.append(figures(run_study(chosen, out=folder / str(seed)).data))
    return found


def assert_scatters_as_stated(found: list[tuple[np.ndarray, np.ndarray]]) -> None:
    """Compare root mean squares: of deviations from the mean, and of the errors."""
    values, errors = (np.array([each[k] for each in found]) for k in (0, 1))
    scatter = np.sqrt(values.var(axis=0, ddof=1).mean())
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) / scatter < 1.25


RESULTS = [
    "illuminance",
    "mean over sensors",
    "mean_illuminance",
    "mean_illuminance, grid",
    "daylight_autonomy",
    "daylight_autonomy, grid",
    "continuous_autonomy",
    "continuous_autonomy, grid",
    "useful",
    "useful, grid",
    "sDA",
    "ASE",
]


@pytest.mark.parametrize("name", RESULTS)
def test_results_of_studies_scatter_as_stated(runs, name):
    assert_scatters_as_stated([run[name] for run in runs])


SKY = "void glow sky\n0\n0\n4 1 1 1 0\n\nsky source dome\n0\n0\n4 0 0 1 360\n"


@pytest.mark.parametrize("receiver", ["sensor", "pixel"])
def test_radiance_under_one_sky_scatters_as_stated(tmp_path, receiver):
    (tmp_path / "sky.rad").write_text(SKY)
    scene = cl.read_rad(ROOM / "room.rad", tmp_path / "sky.rad")
    points = np.array([[2.0, y, 0.8] for y in (0.5, 1.5, 3.0, 4.5)])
    sensors = Sensors(points, np.tile([0, 0, 1.0], (4, 1)))
    view = View(position=np.array([2, 4.8, 1.2]), direction=np.array([0, -1.0, -0.2]))
    found = []
    for seed in SEEDS:
        if receiver == "sensor":
            lit = cl.irradiance(scene, sensors, seed=seed, device="cpu")
            found.append((lit.irradiance[:, 1], lit.error[:, 1]))
        else:
            seen = cl.render(scene, view, columns=16, rows=16, seed=seed, device="cpu")
            found.append((seen.picture.radiance[..., 1], seen.error[..., 1]))
    assert_scatters_as_stated(found)
