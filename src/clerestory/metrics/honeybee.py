"""Reading of results folders of honeybee-radiance-postprocess.

A folder contains `grids_info.json` (sensor grids and their light paths),
`sun-up-hours.txt` (hours of the year with the sun above the horizon),
`grid_states.json` (states of dynamic window groups) and, for each light path and state,
`total` and `direct` illuminance of each grid [lux] as NumPy arrays over (sensor, sun-up
hour).
"""

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.checks import has_shape, one_of, require, within
from clerestory.documents import json_value
from clerestory.errors import InputError, located
from clerestory.files import read_bytes, read_text

STATIC = "__static_apertures__"
Light = Literal["total", "direct"]

_HOURS_A_YEAR = 8760
_MOST_SENSORS = 10_000_000
_YEAR = np.datetime64("2023-01-01T00:00", "s")


@final
@dataclass(frozen=True, eq=False)
class HoneybeeFolder:
    """A results folder of honeybee-radiance-postprocess.

    Attributes
    ----------
    paths : names of the light paths (window groups) of each grid
    states : folder names of the states of each dynamic light path
    sun_up_hours : centres of the hours with results, in hours of the year, such as 7.5
    counts : number of sensors of each grid
    """

    folder: Path
    paths: dict[str, tuple[str, ...]]
    states: dict[str, tuple[str, ...]]
    sun_up_hours: Float[np.ndarray, " hour"]
    counts: dict[str, int]

    def illuminance(
        self,
        grid: str,
        *,
        states: Mapping[str, int | Int[np.ndarray, " time"]] | None = None,
        light: Light = "total",
    ) -> xr.DataArray:
        """Illuminance of a grid at the 8760 hours of a year [lux].

        Parameters
        ----------
        states : state number of each dynamic light path, constant or one per hour of
            the year; −1 excludes the light path. Unlisted light paths are in state 0.
        light : "total" illuminance, or "direct" illuminance from the sun alone
        """
        with located(file=self.folder):
            one_of(grid, "grid", choices=self.paths)
        hours = self.sun_up_hours.astype(int)
        # Files that contradict the number of sensors are refused before it is allocated
        parts = []
        for path in self.paths[grid]:
            chosen: Any = (states or {}).get(path, 0)
            per_hour = np.broadcast_to(np.asarray(chosen), _HOURS_A_YEAR)[hours]
            for state in np.unique(per_hour):
                if state >= 0:
                    array = self._load(grid, path, int(state), light)
                    parts.append(np.where(per_hour == state, array, np.float32(0)))
        total = np.zeros((self.counts[grid], len(hours)), dtype=np.float32)
        for part in parts:
            total += part
        year = np.zeros((len(total), _HOURS_A_YEAR), dtype=np.float32)
        year[:, hours] = total
        minutes = np.arange(30, 60 * _HOURS_A_YEAR, 60)
        times = (_YEAR + minutes.astype("timedelta64[m]")).astype("datetime64[ns]")
        axes, attrs = ("sensor", "time"), {"units": "lux"}
        return xr.DataArray(year, dims=axes, coords={"time": times}, attrs=attrs)

    def by_state(
        self, grid: str, path: str, *, light: Light = "total"
    ) -> Float[np.ndarray, "state sensor time"]:
        """Illuminance from one light path in each of its states [lux]."""
        hours = self.sun_up_hours.astype(int)
        count = 1 if path == STATIC else len(self.states.get(path, ()))
        year = np.zeros((count, self.counts[grid], _HOURS_A_YEAR), dtype=np.float32)
        for state in range(count):
            year[state][:, hours] = self._load(grid, path, state, light)
        return year

    def dynamic_paths(self, grid: str) -> tuple[str, ...]:
        """Names of those light paths of a grid that have several states."""
        return tuple(p for p in self.paths[grid] if len(self.states.get(p, ())) > 1)

    def _load(
        self, grid: str, path: str, state: int, light: Light
    ) -> Float[np.ndarray, "sensor hour"]:
        names = ("default",) if path == STATIC else self.states.get(path, ())
        with located(file=self.folder):
            within(state, f"state of light path {path}", least=0, most=len(names) - 1)
        file = self.folder / path / names[state] / light / f"{grid}.npy"
        data = read_bytes(file)
        try:
            array = np.load(io.BytesIO(data), allow_pickle=False)
        except Exception as error:  # NumPy raises many exception types on damage
            reason = str(error) or type(error).__name__
            raise InputError(f"no NumPy array: {reason}", file=file) from error
        shape = self.counts[grid], len(self.sun_up_hours)
        has_shape(array, shape, "array of illuminance", file=file)
        floating = np.issubdtype(array.dtype, np.floating)
        require(floating, f"values are {array.dtype}; floats expected", file=file)
        return np.asarray(array)


def read_honeybee(folder: str | Path) -> HoneybeeFolder:
    """Return a results folder of honeybee-radiance-postprocess."""
    folder = Path(folder)
    file = folder / "grids_info.json"
    expected = "grids with full_id, count and light_path"
    with located(file=file), _expecting(expected, file):
        info = {str(grid["full_id"]): grid for grid in _json(file)}
        counts = {name: int(grid["count"]) for name, grid in info.items()}
        for name, count in counts.items():
            what = f"number of sensors of grid {name}"
            within(count, what, least=1, most=_MOST_SENSORS)
        paths = {
            name: tuple(dict.fromkeys(map(str, chain(*grid["light_path"]))))
            for name, grid in info.items()
        }
    states: dict[str, tuple[str, ...]] = {}
    file = folder / "grid_states.json"
    if file.is_file():
        with _expecting("states of the light paths of each grid", file):
            for groups in _json(file).values():
                states |= {str(k): tuple(map(str, v)) for k, v in groups.items()}
    file = folder / "sun-up-hours.txt"
    with _expecting("hours of the year", file):
        hours = np.array([float(word) for word in read_text(file).split()])
    with located(file=file):
        within(hours, "hour of the year", least=0, most=np.nextafter(_HOURS_A_YEAR, 0))
    hourly = len(np.unique(hours.astype(int))) == len(hours)
    message = "several times within one hour of the year; at most one per hour expected"
    require(hourly, message, file=file)
    return HoneybeeFolder(folder, paths, states, hours, counts)


@contextmanager
def _expecting(what: str, file: Path) -> Iterator[None]:
    # Convert errors caused by invalid contents of a file
    try:
        yield
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{what} expected", file=file) from error


def _json(path: Path) -> Any:
    return json_value(read_text(path), file=path)
