"""Writer of results folders of honeybee-radiance-postprocess; see `honeybee`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.checks import has_shape, require
from clerestory.escaping import file_stems
from clerestory.files import make_folder, replace_file, write_text
from clerestory.metrics.honeybee import STATIC, Light

_HOURS_A_YEAR = 8760

# Arrays over (sensor, time) by grid, for total and direct illuminance
Arrays = Mapping[Light, Mapping[str, Float[np.ndarray, "_ time"]]]


@final
@dataclass(frozen=True)
class GridRecord:
    """A sensor grid of a results folder: names, number of sensors, light paths.

    Files have the name `full_id`: the identifier, after the group and a slash if any.
    """

    name: str
    identifier: str
    count: int
    group: str = ""
    light_paths: tuple[str, ...] = (STATIC,)

    @property
    def full_id(self) -> str:
        """Identifier with the group."""
        return f"{self.group}/{self.identifier}" if self.group else self.identifier


def write_grids_info(folder: str | Path, grids: Sequence[GridRecord]) -> None:
    """Write `grids_info.json`: name, identifier and number of sensors of each grid."""
    info = [
        {
            "name": grid.name,
            "identifier": grid.identifier,
            "full_id": grid.full_id,
            "group": grid.group,
            "count": grid.count,
            "light_path": [[path] for path in grid.light_paths],
        }
        for grid in grids
    ]
    folder = make_folder(folder)
    write_text(folder / "grids_info.json", json.dumps(info, indent=2))


def hours_of_year(times: np.ndarray) -> Float[np.ndarray, " time"]:
    """Return hours of the year, such as 7.5; 29 February is not allowed."""
    moments = times.astype("datetime64[s]")
    hours = (moments - moments.astype("datetime64[Y]")) / np.timedelta64(3600, "s")
    message = "times are not in a year of 365 days; one of 8760 hours expected"
    require(np.all(hours < _HOURS_A_YEAR), message)
    return np.asarray(hours, dtype=float)


def write_states(
    folder: str | Path,
    grids: Sequence[GridRecord],
    times: np.ndarray,
    paths: Mapping[str, Mapping[str, Arrays]],
    *,
    timestep: int = 1,
) -> None:
    """Write illuminance by light path and state, with the files that describe it.

    Parameters
    ----------
    paths : for each light path and state, arrays over (sensor, time) by grid [lux]; the
        static light path has one state, "default". Those of a light path are written
        for the grids that have it in their record
    times : centres of the time steps, `timestep` an hour. Steps in which all grids have
        0 lux in every state are omitted
    """
    hours = hours_of_year(times)
    rare = len(np.unique((hours * timestep).astype(int))) == len(hours)
    message = "times are repeated; at most one time in each step of the year expected"
    require(rare, message)
    every = [arrays for states in paths.values() for arrays in states.values()]
    for arrays in every:
        for name, lux in arrays["total"].items():
            has_shape(lux, (len(lux), len(times)), f"illuminance of grid {name!r}")
    totals = [lux for arrays in every for lux in arrays["total"].values()]
    lit = np.any([lux.max(axis=0) > 0 for lux in totals], axis=0)
    folder = make_folder(folder)
    write_grids_info(folder, grids)
    known = {
        grid.full_id: {p: list(paths[p]) for p in grid.light_paths if p != STATIC}
        for grid in grids
    }
    named = {name: states for name, states in known.items() if states}
    write_text(folder / "grid_states.json", json.dumps(named))
    write_text(folder / "sun-up-hours.txt", "\n".join(f"{h:g}" for h in hours[lit]))
    study = {"timestep": timestep, "study_hours": [float(h) for h in hours]}
    write_text(folder / "study_info.json", json.dumps(study))
    for path, states in paths.items():
        for state, arrays in states.items():
            for light, found in arrays.items():
                for grid in grids:
                    if path not in grid.light_paths:
                        continue
                    values = found[grid.full_id][:, lit].astype(np.float32)
                    place = folder / path / state / light / f"{grid.full_id}.npy"
                    make_folder(place.parent)
                    with replace_file(place) as stream:
                        np.save(stream, values, allow_pickle=False)


def write_honeybee(
    folder: str | Path,
    total: Mapping[str, Float[np.ndarray, "sensor time"]],
    times: np.ndarray,
    *,
    direct: Mapping[str, Float[np.ndarray, "sensor time"]] | None = None,
) -> None:
    """Write the illuminance of grids in the format of honeybee-radiance-postprocess.

    `total` illuminance and `direct` illuminance from the sun alone are in lux; `times`
    are centres of hourly steps. Hours in which all grids have 0 lux are omitted.
    """
    stems = file_stems(total)
    grids = [GridRecord(name, stems[name], len(lux)) for name, lux in total.items()]
    suns = direct or {}
    arrays: Arrays = {
        "total": {stems[name]: lux for name, lux in total.items()},
        "direct": {
            stems[name]: suns.get(name, np.zeros_like(lux))
            for name, lux in total.items()
        },
    }
    write_states(folder, grids, times, {STATIC: {"default": arrays}})
