"""Hourly illuminance for `clerestory metrics`, from tables, .ill files or folders."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.checks import require
from clerestory.cli.requests.study import Metrics
from clerestory.control.lm83_blinds import operate_by_direct_sun
from clerestory.control.schedule import read_schedule
from clerestory.metrics import en17037, honeybee
from clerestory.metrics.lm83_conditions import departures
from clerestory.metrics.space import direct_sun
from clerestory.sky.weather_formats import read_weather
from clerestory.study.results import read_results

HOURS_A_YEAR = 8760


@dataclass(frozen=True, eq=False)
class HourlyGrid:
    """Illuminance of one grid, and of direct sun [lux], with errors if known."""

    name: str
    hourly: xr.Dataset
    sun: xr.Dataset | None
    step_hours: float = 1.0
    departures: tuple[str, ...] = ()  # from LM-83

    @property
    def lux(self) -> xr.DataArray:
        """Illuminance over (sensor, time) [lux]."""
        return self.hourly["illuminance"]


def hourly_grids(request: Metrics) -> Iterator[HourlyGrid]:
    """Yield the grids of a results folder or file."""
    path, states, operate = request.results, request.states, request.operate
    if path.is_dir() and (path / "grids_info.json").is_file():
        folder = honeybee.read_honeybee(path)
        for name in folder.paths:
            chosen = _operated(folder, name) if operate else _scheduled(states)
            lux = folder.illuminance(name, states=chosen)
            direct = folder.illuminance(name, light="direct")
            hourly, sun = (xr.Dataset({"illuminance": x}) for x in (lux, direct))
            odd = departures(
                hourly, from_hour=request.from_hour, to_hour=request.to_hour
            )
            fixed = folder.dynamic_paths(name) and not operate
            shades = ["shades that do not follow LM-83; --lm83 expected"]
            departed = (*odd, *(shades if fixed else []))
            yield HourlyGrid(name, hourly, sun, departures=departed)
        return
    require(
        states is None and not operate,
        "--states or --lm83 is given with the results of a run; a honeybee results"
        " folder expected",
        file=path,
    )
    found = read_results(path)
    for name in found.grids():
        part = found.data.isel(sensor=np.flatnonzero(found.data["grid"] == name))
        # ASE requires the sun at its exact position, not spread over patches
        exposed = direct_sun(part) if "sun_hours" in part else None
        step = float(found.data.attrs.get("step_minutes", 60)) / 60
        departed = departures(
            part, from_hour=request.from_hour, to_hour=request.to_hour
        )
        yield HourlyGrid(name, part, exposed, step, departed)


def _scheduled(path: Path | None) -> dict[str, np.ndarray]:
    if path is None:
        return {}
    schedule = read_schedule(path)
    require(
        len(schedule.times) == HOURS_A_YEAR,
        f"has {len(schedule.times)} time steps; {HOURS_A_YEAR} hourly steps expected",
        file=path,
    )
    return dict(schedule.states)


def _operated(folder: honeybee.HoneybeeFolder, name: str) -> dict[str, np.ndarray]:
    # Shade states by LM-83; window groups without shade states are unshaded
    groups = folder.dynamic_paths(name)
    if not groups:
        return {}
    fixed = [path for path in folder.paths[name] if path not in groups]
    static = sum(folder.by_state(name, path, light="direct")[0] for path in fixed)
    direct = {path: folder.by_state(name, path, light="direct") for path in groups}
    given = static if isinstance(static, np.ndarray) else None
    return operate_by_direct_sun(direct, static=given).states


def brightest_half(path: Path, lux: xr.DataArray) -> np.ndarray:
    """Return whether each hour is one of EN 17037's daylight hours of a weather file.

    These are the half of the year with the most diffuse irradiance.
    """
    diffuse = read_weather(path).diffuse_horizontal
    require(
        len(diffuse) == lux.sizes["time"],
        f"has {len(diffuse)} time steps, but the results have {lux.sizes['time']}; the"
        " weather file of the run expected",
        file=path,
    )
    return en17037.daylight_hours(diffuse)
