"""Comparison of several phase methods for one scene.

All methods have the same shade states, which the last method determines.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.engine.work_units import Executor
from clerestory.escaping import csv_line
from clerestory.files import make_folder, write_text
from clerestory.metrics.agreement import LIMITS, agreement
from clerestory.phases.matrix_store import Store
from clerestory.phases.recent_values import RecentValues
from clerestory.study.config import Study
from clerestory.study.job import Display
from clerestory.study.method_run import run_method
from clerestory.study.outputs import write_tables
from clerestory.study.results import Results, save_results
from clerestory.warning_log import WarningLog

COMPARISON_FILE = "comparison.csv"

# Minimum illuminance by the reference method for values to be compared [lux]
LEAST_LUX = 100.0

_HEAD = (
    "method,grid,mean [lux],mean bias [%],root mean square difference [%],"
    + ",".join(f"within {limit:.0%} [%]" for limit in LIMITS)
    + ",values"
)


def compare_methods(
    study: Study,
    *,
    out: Path,
    store: Store,
    executor: Executor,
    display: Display,
    recent: RecentValues | None = None,
) -> Results:
    """Run a study with each of its methods; return the results of the last method.

    These results, a comparison table and a folder per method are written to `out`.
    """
    found: dict[str, Results] = {}
    states: list[np.ndarray] | None = None
    warning_log = WarningLog()
    for method in reversed(study.methods):
        found[method] = run_method(
            study.with_method(method),
            out=make_folder(out / method),
            store=store,
            executor=executor,
            display=display,
            states=states,
            recent=recent,
            warning_log=warning_log,
        )
        if states is None and "state" in found[method].data:
            states = list(found[method].data["state"].values.astype(int))
    last = found[study.methods[-1]]
    methods: dict[str, xr.Dataset] = {name: found[name].data for name in study.methods}
    lux = np.stack([data["illuminance"].values for data in methods.values()])
    axes = ("method", "sensor", "time")
    data = last.data.assign_coords(method=list(methods))
    data["illuminance_by_method"] = (axes, lux, {"units": "lux"})
    write_text(out / COMPARISON_FILE, comparison_table(methods))
    results = Results(data.assign_attrs(study=study.to_json()), last.run)
    write_tables(study, results, out)
    save_results(results, out)
    return results


def comparison_table(methods: Mapping[str, xr.Dataset]) -> str:
    """Return a CSV table of illuminance differences from the last method, per grid."""
    reference = list(methods.values())[-1]
    lines = [_HEAD]
    for name, data in methods.items():
        for grid in dict.fromkeys(data["grid"].values.tolist()):
            chosen = np.flatnonzero(data["grid"].values == grid)
            hours = data["occupied"].values
            ours = data["illuminance"].values[chosen][:, hours]
            theirs = reference["illuminance"].values[chosen][:, hours]
            figures = ",".join(f"{x:.4g}" for x in differences(ours, theirs))
            count = np.count_nonzero(theirs >= LEAST_LUX)
            row = csv_line([name, grid])
            lines.append(f"{row},{ours.mean():.5g},{figures},{count}")
    return "\n".join(lines) + "\n"


def differences(
    illuminance: Float[np.ndarray, "*shape"], reference: Float[np.ndarray, "*shape"]
) -> list[float]:
    """Relative MBE, CV(RMSE), and fraction of values within 5, 10 and 20 %, all in %.

    Only values with a reference of at least 100 lux are included; NaN if there is none.
    """
    lit = reference >= LEAST_LUX
    if not lit.any():
        return [np.nan] * (2 + len(LIMITS))
    found = agreement(reference[lit].astype(float), illuminance[lit].astype(float))
    shares = found.relative_bias, found.variation, *found.within
    return [100 * share for share in shares]
