"""Reading and writing of results folders of honeybee-radiance-postprocess.

A folder contains `grids_info.json` (sensor grids and their light paths),
`sun-up-hours.txt` (hours of the year with the sun above the horizon),
`grid_states.json` (states of dynamic window groups) and, for each light path and state,
`total` and `direct` illuminance of each grid [lux] as NumPy arrays over (sensor, sun-up
hour).
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.documents import json_value
from clerestory.errors import InputError
from clerestory.files import make_folder, read_text, replace_file, write_text

STATIC = "__static_apertures__"
Light = Literal["total", "direct"]

_HOURS_A_YEAR = 8760
_YEAR = np.datetime64("2023-01-01T00:00", "s")


@final
@dataclass(frozen=True, eq=False)
class HoneybeeFolder:
    """A results folder of honeybee-radiance-postprocess.

    Attributes
    ----------
    folder : path of the folder
    paths : names of the light paths (window groups) of each grid
    states : folder names of the states of each dynamic light path
    sun_up_hours : hours of the year with results, at their centres, such as 7.5
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
            the year; −1 excludes the path. Unlisted paths are in state 0.
        light : "total" illuminance, or "direct" illuminance from the sun alone
        """
        if grid not in self.paths:
            raise InputError(
                f"no grid {grid!r}; one of {', '.join(self.paths)} expected",
                file=self.folder,
            )
        hours = self.sun_up_hours.astype(int)
        total = np.zeros((self.counts[grid], len(hours)), dtype=np.float32)
        for path in self.paths[grid]:
            chosen: Any = (states or {}).get(path, 0)
            per_hour = np.broadcast_to(np.asarray(chosen), _HOURS_A_YEAR)[hours]
            for state in np.unique(per_hour):
                if state >= 0:
                    array = self._load(grid, path, int(state), light)
                    total += np.where(per_hour == state, array, np.float32(0))
        year = np.zeros((len(total), _HOURS_A_YEAR), dtype=np.float32)
        year[:, hours] = total
        times = _YEAR + (np.arange(_HOURS_A_YEAR) * 3600 + 1800).astype(
            "timedelta64[s]"
        )
        return xr.DataArray(
            year,
            dims=("sensor", "time"),
            coords={"time": times.astype("datetime64[ns]")},
            attrs={"units": "lux"},
        )

    def by_state(
        self, grid: str, path: str, *, light: Light = "total"
    ) -> Float[np.ndarray, "state sensor time"]:
        """Illuminance from one light path in each state [lux].

        The array is over (state, sensor, hour of the year); the static path has one
        state.
        """
        hours = self.sun_up_hours.astype(int)
        count = 1 if path == STATIC else len(self.states.get(path, ()))
        year = np.zeros((count, self.counts[grid], _HOURS_A_YEAR), dtype=np.float32)
        for state in range(count):
            year[state][:, hours] = self._load(grid, path, state, light)
        return year

    def dynamic_paths(self, grid: str) -> tuple[str, ...]:
        """Names of the light paths of a grid with several states."""
        return tuple(p for p in self.paths[grid] if len(self.states.get(p, ())) > 1)

    def _load(
        self, grid: str, path: str, state: int, light: Light
    ) -> Float[np.ndarray, "sensor hour"]:
        names = ("default",) if path == STATIC else self.states.get(path, ())
        if state >= len(names):
            raise InputError(
                f"light path {path} has {len(names)} states; state 0 to"
                f" {len(names) - 1} expected, not {state}",
                file=self.folder,
            )
        file = self.folder / path / names[state] / light / f"{grid}.npy"
        try:
            array = np.load(file, allow_pickle=False)
        except (OSError, ValueError, EOFError) as error:
            raise InputError(f"cannot be read: {error}", file=file) from error
        expected = (self.counts[grid], len(self.sun_up_hours))
        if array.shape != expected or not np.issubdtype(array.dtype, np.floating):
            raise InputError(
                f"{array.dtype} values of shape {array.shape}; floats of {expected}"
                " expected",
                file=file,
            )
        return np.asarray(array)


def read_honeybee(folder: str | Path) -> HoneybeeFolder:
    """Return a results folder of honeybee-radiance-postprocess."""
    folder = Path(folder)
    info = _json(folder / "grids_info.json")
    try:
        counts = {str(grid["full_id"]): int(grid["count"]) for grid in info}
        paths = {
            str(grid["full_id"]): tuple(
                dict.fromkeys(str(p) for step in grid["light_path"] for p in step)
            )
            for grid in info
        }
    except (TypeError, KeyError, ValueError) as error:
        raise InputError(
            "grids with full_id, count and light_path expected",
            file=folder / "grids_info.json",
        ) from error
    states: dict[str, tuple[str, ...]] = {}
    if (folder / "grid_states.json").is_file():
        try:
            for groups in _json(folder / "grid_states.json").values():
                states |= {str(k): tuple(map(str, v)) for k, v in groups.items()}
        except (AttributeError, TypeError) as error:
            raise InputError(
                "states of light paths of grids expected",
                file=folder / "grid_states.json",
            ) from error
    hours_file = folder / "sun-up-hours.txt"
    try:
        hours = np.array([float(word) for word in read_text(hours_file).split()])
    except ValueError as error:
        raise InputError("hours of the year expected", file=hours_file) from error
    if len(hours) and not (hours.min() >= 0 and hours.max() < _HOURS_A_YEAR):
        raise InputError(
            "an hour outside the year; 0 to 8760 expected", file=hours_file
        )
    if len(np.unique(hours.astype(int))) < len(hours):
        raise InputError(
            "several steps in an hour; one step per hour expected", file=hours_file
        )
    return HoneybeeFolder(folder, paths, states, hours, counts)


def write_honeybee(
    folder: str | Path,
    total: Mapping[str, Float[np.ndarray, "sensor time"]],
    times: np.ndarray,
    *,
    direct: Mapping[str, Float[np.ndarray, "sensor time"]] | None = None,
) -> None:
    """Write the illuminance of grids in the format of honeybee-radiance-postprocess.

    Parameters
    ----------
    total : total illuminance of each grid [lux]
    times : centres of hourly steps of one year; hours in which the illuminance of all
        grids is 0 are omitted
    direct : illuminance of each grid from the sun alone [lux]; default: 0
    """
    moments = times.astype("datetime64[s]")
    hours = (moments - moments.astype("datetime64[Y]")) / np.timedelta64(3600, "s")
    if len(np.unique(hours.astype(int))) < len(hours) or np.any(hours >= _HOURS_A_YEAR):
        raise InputError("steps are not hourly; hours of one year of 365 days expected")
    for name, lux in total.items():
        if lux.ndim != 2 or lux.shape[1] != len(times):
            raise InputError(
                f"grid {name!r} has shape {lux.shape}; (sensor, {len(times)}) expected"
            )
    lit = np.any([lux.max(axis=0) > 0 for lux in total.values()], axis=0)
    folder = make_folder(folder)
    info = [
        {
            "name": name,
            "identifier": name,
            "full_id": name,
            "group": "",
            "count": len(lux),
            "light_path": [[STATIC]],
        }
        for name, lux in total.items()
    ]
    write_text(folder / "grids_info.json", json.dumps(info, indent=2))
    write_text(folder / "grid_states.json", "{}")
    write_text(folder / "sun-up-hours.txt", "\n".join(f"{h:g}" for h in hours[lit]))
    study = {"timestep": 1, "study_hours": [float(h) for h in hours]}
    write_text(folder / "study_info.json", json.dumps(study))
    for light, grids in (("total", total), ("direct", direct or {})):
        place = make_folder(folder / STATIC / "default" / light)
        for name, lux in total.items():
            values = grids.get(name, np.zeros_like(lux))[:, lit]
            with replace_file(place / f"{name}.npy") as stream:
                np.save(stream, values.astype(np.float32), allow_pickle=False)


def _json(path: Path) -> Any:
    return json_value(read_text(path), file=path)
