"""Figures of merit of a study for draws of its unknown quantities."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.metrics.climate_based_metrics import share_at, useful_shares
from clerestory.metrics.compliance import Assessment, assess
from clerestory.metrics.replicates import errors_of, replicates
from clerestory.metrics.spatial_metrics import (
    HALF_OF_THE_HOURS,
    MOST_HOURS,
    SUN_LUX,
    area_share,
)
from clerestory.metrics.standards import standards_named
from clerestory.uncertainty.expansion import Expansion

# Number of figures of light of a grid, of which the first is the mean illuminance
FIGURES = 5

# Numbers that round to the same share of the hours
_ROUNDING = 1e-9

# Largest number of hourly values that are computed at a time
_VALUES = 2**25

# Illuminance below which errors are not relative [lux]
_DARK = 1e-3

# Largest number of draws for which standards are assessed, and of hourly values of
# replicates that are kept
_ASSESSED, _KEPT = 256, 2**27


@dataclass(frozen=True, eq=False)
class FigureModel:
    """Illuminance and direct sun as functions of unknown quantities.

    Attributes
    ----------
    names : names of the quantities
    expansion : illuminance in the occupied hours
    direct : direct sun with open shades in the occupied hours, if it was traced
    grid : name of the grid of each sensor
    target_lux, step_hours : target of daylight autonomy [lux], time step [h]
    """

    names: tuple[str, ...]
    expansion: Expansion
    direct: Expansion | None
    grid: np.ndarray
    target_lux: float
    step_hours: float

    __repr__ = brief

    def named(self, draws: Float[np.ndarray, "draw unknown"]) -> dict[str, np.ndarray]:
        """Return draws by name of the quantity."""
        return dict(zip(self.names, draws.T, strict=True))

    def figures(
        self, draws: Float[np.ndarray, "draw unknown"], *, order: int = 2
    ) -> Float[np.ndarray, "figure draw"]:
        """Return the figures of each grid for draws, in the order of a run's figures.

        These are the mean illuminance and the shares of hours and area of
        `study.variant_figures`, then the area with direct sun.
        """
        values = self.named(draws)
        found = _by_sensor(
            self.expansion.order(order), values, lambda lux: light(lux, self.target_lux)
        )
        rows = grid_figures(found, self.grid)
        if self.direct is not None:
            sun = _by_sensor(self.direct, values, self._sunny)
            rows += sun_figures(sun[0], self.grid)
        return np.stack(rows)

    def _sunny(self, lux: np.ndarray) -> np.ndarray:
        return np.asarray((lux > SUN_LUX).sum(axis=-1)[None] * self.step_hours)


def light(lux: Float[np.ndarray, "... time"], target_lux: float) -> np.ndarray:
    """Return mean, autonomy, useful share and share above it, over (metric, …)."""
    bands = useful_shares(lux)
    mean = lux.mean(axis=-1, dtype=float)
    useful = bands[1] + bands[2]
    return np.stack([mean, share_at(lux, target_lux), useful, bands[3]])


def grid_figures(
    found: Float[np.ndarray, "metric draw sensor"], grid: np.ndarray
) -> list[np.ndarray]:
    """Return the figures of light of each grid, each over the draws."""
    rows = []
    for name in dict.fromkeys(grid.tolist()):
        own = found[:, :, grid == name]
        mean, autonomy, useful, above = own.mean(axis=-1)
        often = own[1] >= HALF_OF_THE_HOURS - _ROUNDING
        rows += [mean, 100 * autonomy, 100 * useful, 100 * above]
        rows.append(100 * often.mean(axis=-1))
    return rows


def sun_figures(
    hours: Float[np.ndarray, "draw sensor"], grid: np.ndarray
) -> list[np.ndarray]:
    """Return the area with direct sun of each grid [%], each over the draws."""
    names = dict.fromkeys(grid.tolist())
    return [
        np.array(
            [100 * area_share(one > MOST_HOURS, None) for one in hours[:, grid == name]]
        )
        for name in names
    ]


def _by_sensor(
    expansion: Expansion, values: Mapping[str, np.ndarray], metrics: object
) -> Float[np.ndarray, "metric draw sensor"]:
    # Metrics of blocks of sensors and of draws
    count = len(next(iter(values.values())))
    hours = expansion.scenarios[0][0].value.shape[1]
    rows = max(1, min(expansion.sensors, _VALUES // (32 * hours)))
    few = max(1, min(count, _VALUES // (rows * hours)))
    blocks = []
    for first in range(0, expansion.sensors, rows):
        part = expansion.select(slice(first, first + rows))
        found = []
        for start in range(0, count, few):
            some = {n: own[start : start + few] for n, own in values.items()}
            found.append(metrics(part.illuminance(some)))  # type: ignore[operator]
        blocks.append(np.concatenate(found, axis=1))
    return np.concatenate(blocks, axis=2)


def assessments(
    data: xr.Dataset,
    standards: Sequence[str],
    expansion: Expansion,
    direct: Expansion | None,
    draws: Mapping[str, np.ndarray],
) -> list[tuple[Assessment, ...]]:
    """Return the assessments of standards for draws, with the simulation's error.

    The expansions are those of all time steps. Each draw has the error of one replicate
    of the simulation; without replicates, or with very many hours, none.
    """
    chosen, lux = standards_named(standards), data["illuminance"]
    count = min(len(next(iter(draws.values()))), _ASSESSED)
    noise, bare = _deviations(data), _without_hourly_errors(data)
    found = []
    for number in range(count):
        one = {name: own[number : number + 1] for name, own in draws.items()}
        values = expansion.illuminance(one)[0]
        if noise:
            values = values * (1 + noise[number % len(noise)])
        changed = {"illuminance": lux.copy(data=values.astype(lux.dtype))}
        if direct is not None:
            sun = data["direct_open"]
            beam = direct.illuminance(one)[0]
            changed["direct_open"] = sun.copy(data=beam.astype(sun.dtype))
        found.append(assess(bare.assign(changed), chosen))
    return found


def varying_criteria(data: xr.Dataset, standards: Sequence[str]) -> set[str]:
    """Return the criteria that would change if there were hardly any light.

    Those of daylight factors, view out and glare do not depend on the hourly light.
    """
    chosen, bare = standards_named(standards), _without_hourly_errors(data)
    light = [name for name in ("illuminance", "direct_open") if name in bare]
    dark = bare.assign({name: 1e-6 * bare[name] for name in light})
    return {
        one.criterion
        for each, other in zip(assess(bare, chosen), assess(dark, chosen), strict=True)
        for one, same in zip(each.verdicts, other.verdicts, strict=True)
        if [q.value for q in one.quantities] != [q.value for q in same.quantities]
    }


def _without_hourly_errors(data: xr.Dataset) -> xr.Dataset:
    parts = (name for name in data if str(name).endswith(("_error", "_components")))
    hourly = [name for name in parts if "time" in data[name].dims]
    return data.drop_vars(
        [*hourly, "standard_error", "error_components"], errors="ignore"
    )


def _deviations(data: xr.Dataset) -> list[np.ndarray]:
    # Relative errors of the illuminance in each replicate
    errors = errors_of(data)
    lux = data["illuminance"].transpose("sensor", "time")
    if errors["components"] is None or lux.size * 32 > _KEPT:
        return []
    found = replicates(lux, errors["standard_error"], errors["components"])
    scale = np.maximum(lux.values, _DARK)
    return [((one - lux).values / scale).astype(np.float32) for one in found]
