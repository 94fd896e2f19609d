"""Comparison of simulation methods on one scene: deviations from the last method."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.metrics.agreement import LIMITS
from clerestory.report.markup import Markup, render
from clerestory.report.uncertain_value import number
from clerestory.study.method_comparison import LEAST_LUX, differences


@dataclass(frozen=True, eq=False)
class MethodComparison:
    """Illuminance by several simulation methods.

    Attributes
    ----------
    methods : names of the methods; the last one is the reference
    illuminance : illuminance by each method [lux]
    grids : name of the grid of each sensor
    occupied : whether each time step is an occupied hour
    """

    methods: tuple[str, ...]
    illuminance: Float[np.ndarray, "method sensor time"]
    grids: tuple[str, ...]
    occupied: Bool[np.ndarray, " time"]


def method_comparison(data: xr.Dataset) -> MethodComparison | None:
    """Return the comparison in the results, or None if only one method was run."""
    if "illuminance_by_method" not in data:
        return None
    values = data["illuminance_by_method"].transpose("method", "sensor", "time")
    return MethodComparison(
        tuple(map(str, data["method"].values)),
        np.asarray(values.values, dtype=np.float32),
        tuple(map(str, data["grid"].values)),
        np.asarray(data["occupied"].values, dtype=bool),
    )


def methods_section(compared: MethodComparison | None) -> Markup:
    """Return a table of deviations of every method and grid from the last method."""
    if compared is None:
        return Markup("")
    head = ["Method", "Grid", "Mean [lux]", "Mean bias", "Root mean square"]
    head += [f"Within {100 * share:.0f} %" for share in LIMITS]
    rows = []
    grids, hours = np.array(compared.grids), np.flatnonzero(compared.occupied)
    for name, lux in zip(compared.methods, compared.illuminance, strict=True):
        for grid in dict.fromkeys(compared.grids):
            chosen = np.ix_(np.flatnonzero(grids == grid), hours)
            found = differences(lux[chosen], compared.illuminance[-1][chosen])
            mean = number(float(lux[chosen].mean()))
            rows.append((name, [grid, mean, *map(_percent, found)]))
    return render(
        "methods.html",
        reference=compared.methods[-1],
        least=f"{LEAST_LUX:.0f}",
        head=head,
        rows=rows,
    )


def _percent(value: float) -> str:
    return f"{value:.1f} %" if np.isfinite(value) else "–"
