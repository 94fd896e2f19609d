"""Figures of merit of runs, and their differences with standard errors.

Runs that share matrices, or that sample with the same random numbers, share most of
their statistical error. The error components of a figure, one for each replicate of
`metrics.replicates`, are differences of the same batches in every run: those of a
difference are the differences of the components. Errors of glare have no components:
they are taken as independent, which gives upper limits.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import require, same_length
from clerestory.glare.view_grid_metrics import DISTURBING, view_figures
from clerestory.metrics.climate_based_metrics import USEFUL_RANGES
from clerestory.metrics.compliance import Verdict
from clerestory.metrics.occupied_hours import within_hours
from clerestory.metrics.replicates import errors_of, metric_components
from clerestory.metrics.space import direct_sun
from clerestory.metrics.spatial_metrics import (
    HALF_OF_THE_HOURS,
    MOST_HOURS,
    area_share,
    sunlight_exposure,
)
from clerestory.study.compliance_table import assessments_of
from clerestory.study.results import Results
from clerestory.study.view_grid_outputs import view_grids

Aspect = Literal["light", "sun", "glare", "energy"]

# Numbers that round to the same share of the hours
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class VariantFigure:
    """A figure of merit of one run, such as the daylight autonomy of a grid.

    Attributes
    ----------
    name, place, unit : what it is; grid, view or "all zones"; unit
    components : error components, one per replicate; None if unknown
    rising : whether more is better
    """

    name: str
    place: str
    unit: str
    aspect: Aspect
    value: float
    error: float
    components: Float[np.ndarray, " replicate"] | None = None
    rising: bool = True

    __repr__ = brief

    @property
    def key(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.place

    def minus(self, other: "VariantFigure") -> "VariantFigure":
        """Return the difference from the same figure of another run.

        >>> one = VariantFigure("a", "", "lux", "light", 5.0, 1.0, np.array([1.0, 0.0]))
        >>> difference = replace(one, value=7.0).minus(one)
        >>> difference.value, difference.error
        (2.0, 0.0)
        """
        parts, error = None, float(np.hypot(self.error, other.error))
        if self.components is not None and other.components is not None:
            parts = self.components - other.components
            error = float(np.linalg.norm(parts))
        return replace(
            self, value=self.value - other.value, error=error, components=parts
        )


@dataclass(frozen=True, eq=False)
class RunFigures:
    """Figures of merit of one run or variant, with its settings in a sweep.

    `sensors` has grid, position and daylight autonomy of each sensor, `verdicts` those
    on all spaces by standard and criterion.
    """

    name: str
    figures: tuple[VariantFigure, ...]
    settings: Mapping[str, str] = field(default_factory=dict)
    sensors: xr.Dataset = field(default_factory=xr.Dataset)
    verdicts: Mapping[tuple[str, str], Verdict] = field(default_factory=dict)

    __repr__ = brief

    def of(self, key: tuple[str, str]) -> VariantFigure | None:
        """Return a figure by name and place."""
        return next((figure for figure in self.figures if figure.key == key), None)


def run_figures(
    results: Results, *, name: str, settings: Mapping[str, str] | None = None
) -> RunFigures:
    """Return the figures of merit of a run: light, sunlight, glare, lighting energy."""
    data = results.data
    figures = (
        *_light(results),
        *_sun(results),
        *_glare(data),
        *_grid_glare(results),
        *_energy(data),
    )
    sensors = data[["daylight_autonomy", "grid", "position", "direction"]].load()
    verdicts = {
        (one.standard, verdict.criterion): verdict
        for one in assessments_of(data)
        for verdict in one.verdicts
    }
    return RunFigures(name, figures, settings or {}, sensors, verdicts)


def _light(results: Results) -> Iterator[VariantFigure]:
    data = results.data
    target = f"{float(data.attrs['target_lux']):g} lux"
    for grid in results.grids():
        part = data.isel(sensor=np.flatnonzero(data["grid"].values == grid))
        named = (
            ("mean illuminance", "mean_illuminance", 1, "lux", True),
            (f"hours with {target} or more", "daylight_autonomy", 100, "%", True),
            ("useful illuminance", "useful", 100, "%", True),
        )
        for name, variable, factor, unit, rising in named:
            value = factor * float(part[variable].mean())
            parts = factor * part[f"{variable}_components"].values.mean(axis=-1)
            yield _with_parts(name, grid, unit, "light", value, parts, rising=rising)
        high = part["useful_bands"].sel(band=USEFUL_RANGES[-1])
        parts = part["useful_bands_components"].sel(band=USEFUL_RANGES[-1])
        mean, spread = 100 * float(high.mean()), 100 * parts.values.mean(axis=-1)
        name = "hours above the useful range"
        yield _with_parts(name, grid, "%", "light", mean, spread, rising=False)
        yield _spatial_autonomy(part, f"area with {target} in half of the hours", grid)


def _spatial_autonomy(part: xr.Dataset, name: str, grid: str) -> VariantFigure:
    # Share of sensors whose autonomy is 50 %, for the run and each replicate
    autonomy = part["daylight_autonomy"].values.astype(float)
    parts = part["daylight_autonomy_components"].values.astype(float)
    least = HALF_OF_THE_HOURS - _ROUNDING
    varied = [
        np.array(100 * area_share(autonomy + own * np.sqrt(len(parts)) >= least, None))
        for own in parts
    ]
    share = 100 * area_share(autonomy >= least, None)
    found = metric_components(np.array(share), varied)
    return _with_parts(name, grid, "%", "light", share, found)


def _sun(results: Results) -> Iterator[VariantFigure]:
    # Annual sunlight exposure, if the sun was traced at its true position
    data = results.data
    if "sun_hours" not in data or "direct_open" not in data:
        return
    hours = data["occupied"].values.astype(bool)
    step_hours = float(data.attrs["step_minutes"]) / 60
    for grid in results.grids():
        part = data.isel(sensor=np.flatnonzero(data["grid"].values == grid))
        sun = within_hours(direct_sun(part), hours).load()
        share = sunlight_exposure(
            sun["illuminance"],
            np.ones(sun.sizes["time"], dtype=bool),
            step_hours=step_hours,
            **errors_of(sun),
        )
        varied = [np.array(100 * each) for each in share.replicates]
        value = 100 * share.value
        parts = metric_components(np.array(value), varied)
        name = f"area with direct sun in more than {MOST_HOURS:.0f} h, shades open"
        yield _with_parts(name, grid, "%", "sun", value, parts, rising=False)


def _glare(data: xr.Dataset) -> Iterator[VariantFigure]:
    if "glare_dgp" not in data:
        return
    hours = data["occupied"].values.astype(bool)
    dgp = data["glare_dgp"].transpose("view", "time").values[:, hours].astype(float)
    error = data.get("glare_dgp_error")
    spread = None
    if error is not None:
        spread = error.transpose("view", "time").values[:, hours].astype(float)
    found = view_figures(dgp, spread)
    for number, view in enumerate(data["view"].values.astype(str)):
        yield VariantFigure(
            f"hours with DGP above {DISTURBING:.2f}",
            str(view),
            "%",
            "glare",
            100 * float(found.share[number, 1]),
            100 * float(found.share_error[number, 1]),
            rising=False,
        )


def _grid_glare(results: Results) -> Iterator[VariantFigure]:
    data = results.data
    for number, grid in enumerate(view_grids(results)):
        yield VariantFigure(
            f"views with DGP above {DISTURBING:.2f} in over 5 % of the hours",
            grid,
            "%",
            "glare",
            100 * float(data["disturbed_views"][number]),
            100 * float(data["disturbed_views_error"][number]),
            rising=False,
        )


def _energy(data: xr.Dataset) -> Iterator[VariantFigure]:
    # Energy of the building, simulated by EnergyPlus, and of the luminaires
    if "annual_energy" in data:
        uses = ("heating", "cooling", "lighting")
        found = [float(data["annual_energy"].sel(energy_use=use)) for use in uses]
        named = {"heating, cooling and lighting": sum(found)}
        named |= dict(zip(uses[:2], found, strict=False))
        for use, kwh in named.items():
            yield VariantFigure(
                use, "building", "kWh", "energy", kwh, 0.0, rising=False
            )
        yield from _loads(data)
    if "lighting_energy" not in data:
        return
    name, value = "lighting energy", float(data["lighting_energy"].sum()) / 1000
    if "lighting_energy_components" in data:
        parts = data["lighting_energy_components"].sum("zone").values / 1000
        yield _with_parts(
            name, "all zones", "kWh", "energy", value, parts, rising=False
        )
        return
    error = float(data["lighting_energy_error"].sum()) / 1000
    yield VariantFigure(name, "all zones", "kWh", "energy", value, error, rising=False)


def _loads(data: xr.Dataset) -> Iterator[VariantFigure]:
    # Peak loads of the building, and discomfort in its zones
    for use in ("heating", "cooling"):
        peak = float(data["peak_power"].sel(energy_use=use))
        yield VariantFigure(
            f"peak {use}", "building", "kW", "energy", peak, 0.0, rising=False
        )
    for zone, hours in data["hours_out_of_comfort"].to_series().items():
        yield VariantFigure(
            "hours out of comfort", str(zone), "h", "energy", hours, 0.0, rising=False
        )


def _with_parts(
    name: str,
    place: str,
    unit: str,
    aspect: Aspect,
    value: float,
    parts: Float[np.ndarray, " replicate"],
    *,
    rising: bool = True,
) -> VariantFigure:
    error = float(np.linalg.norm(parts))
    parts = np.asarray(parts, dtype=float)
    return VariantFigure(name, place, unit, aspect, value, error, parts, rising)


def common_keys(runs: Sequence[RunFigures]) -> list[tuple[str, str]]:
    """Return name and place of the figures that every run has, in order."""
    require(len(runs) > 1, f"{len(runs)} run to compare; two or more expected")
    keys = [figure.key for figure in runs[0].figures]
    found = [key for key in keys if all(run.of(key) for run in runs)]
    require(
        found,
        "the runs have no figure in common; grids and views of equal names expected",
    )
    return found


def figure_rows(
    runs: Sequence[RunFigures], key: tuple[str, str]
) -> list[tuple[VariantFigure, VariantFigure]]:
    """Return a figure of each run, and its difference from the first run."""
    found = [figure for run in runs if (figure := run.of(key)) is not None]
    same_length(found, runs, "figures", "runs")
    return [(figure, figure.minus(found[0])) for figure in found]
