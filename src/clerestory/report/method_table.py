"""Table of simulation methods: deviations of illuminance from the last method."""

import numpy as np

from clerestory.metrics.agreement import LIMITS
from clerestory.report.content import ReportContent
from clerestory.report.markup import render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import number
from clerestory.study.method_comparison import LEAST_LUX, differences


def methods_section(content: ReportContent) -> Section:
    """Return illuminance deviations from the last method; empty for a single method."""
    if "illuminance_by_method" not in content.data:
        return Section()
    by_method = content.data["illuminance_by_method"]
    ordered = by_method.transpose("method", "sensor", "time")
    illuminance = ordered.values.astype(np.float32)
    methods = content.data["method"].values.tolist()
    hours = np.flatnonzero(content.data["occupied"].values)
    head = ["Method", "Grid", "Mean [lux]", "Mean bias", "Root mean square"]
    head += [f"Within {100 * share:.0f} %" for share in LIMITS]
    rows = []
    for name, lux in zip(methods, illuminance, strict=True):
        for grid, members in content.sensors.by_grid().items():
            chosen = np.ix_(members, hours)
            found = differences(lux[chosen], illuminance[-1][chosen])
            mean = number(float(lux[chosen].mean()))
            shares = [f"{x:.1f} %" if np.isfinite(x) else "–" for x in found]
            rows.append((name, [grid, mean, *shares]))
    return Section(
        render(
            "methods.html",
            reference=methods[-1],
            least=f"{LEAST_LUX:.0f}",
            head=head,
            rows=rows,
        )
    )
