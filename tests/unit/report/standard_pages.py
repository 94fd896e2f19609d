"""Results with verdicts of standards, whose maps are known, for tests of the pages."""

import numpy as np
import xarray as xr

from clerestory.metrics.compliance import assess
from clerestory.metrics.standards import standards_named
from clerestory.study.compliance_table import compliance_table
from clerestory.study.results import Results

STANDARDS = ("LM-83", "LEED v4", "LEED v4.1", "EN 17037", "BREEAM")


def with_standards(results, *, names=STANDARDS):
    """Add verdicts, and what they follow from; the grid `desks` is the only space."""
    data = results.data.drop_sel(
        sensor=[n for n in results.data["sensor"].values if n.startswith("eyes")]
    )
    depth = data["position"].values[:, 1]
    count, lux = len(depth), data["illuminance"]
    lit = data["occupied"].values
    direct = np.where((depth < 2)[:, None] & lit, 5000.0, 0.0)
    more = {
        "space": ("sensor", np.full(count, "desks")),
        "floor_area": ("sensor", np.full(count, 0.64)),
        "height_above_floor": ("sensor", np.full(count, 0.76)),
        "direct_open": (("sensor", "time"), direct),
        "sun_hours": ("sensor", direct.astype(bool).sum(axis=1).astype(float)),
        "daylight_hours": ("time", lux.values.mean(axis=0) > 0),
        "daylight_factor": ("sensor", 0.08 / (1 + depth)),
        "daylight_factor_error": ("sensor", np.full(count, 1e-4)),
        "view_width": ("sensor", 90 / (1 + depth)),
        "view_distance": ("sensor", np.full(count, 1e6)),
        "view_layers": ("sensor", np.full(count, 7)),
    }
    attrs = {"median_diffuse_lux": 15_000.0, "step_minutes": 60.0}
    data = data.assign({k: xr.Variable(*v) for k, v in more.items()})
    data = data.assign_attrs(attrs)
    found = compliance_table(assess(data, standards_named(names)))
    return Results(data.merge(found, combine_attrs="override"), results.run)
