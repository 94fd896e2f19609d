"""Maps behind the verdicts of standards: hours at the target, of sun, and the view."""

from collections.abc import Sequence

import numpy as np

from clerestory.image.colour_scale import ColourScale
from clerestory.metrics.climate_based_metrics import TARGET_LUX
from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.spatial_metrics import MOST_HOURS, SUN_LUX
from clerestory.report.colour import percent_scale
from clerestory.report.content import ReportContent
from clerestory.report.metric_maps import MetricMap

# Keys of the maps that belong to each standard
_LM83 = ("standard-hours", "standard-sun")
_EN17037 = ("standard-half", "standard-factor", "standard-width", "standard-reach")
_BREEAM = ("standard-factor",)


def compliance_maps(content: ReportContent) -> dict[str, MetricMap]:
    """Return the maps of standards by key; empty without [compliance]."""
    data = content.data
    if "verdict_standard" not in data:
        return {}
    standards = set(data["verdict_standard"].values.astype(str).tolist())
    wanted = {key for name in standards for key in map_keys(name)}
    return {m.key: m for m in _maps(content, wanted)}


def map_keys(standard: str) -> Sequence[str]:
    """Return the keys of the maps behind the verdicts of a standard."""
    if standard == "EN 17037":
        return _EN17037
    return _BREEAM if standard == "BREEAM" else _LM83


def map_scale(metric: MetricMap) -> ColourScale:
    """Return the colour scale of a map: linear from zero, up to a round value."""
    if metric.unit == "%" and metric.key != "standard-factor":
        return percent_scale()
    finite = metric.values[np.isfinite(metric.values)]
    top = float(finite.max(initial=0.0))
    steps = [m * 10**k for k in range(5) for m in (1, 2, 5)]
    high = float(next((x for x in steps if x >= top), 1e5))
    levels = tuple(high * k / 5 for k in range(6)) if high >= 5 else (0.0, high)
    return ColourScale(
        0, high, levels, metric.unit, palette="viridis", ends=(0.04, 0.98), steps=128
    )


def _maps(content: ReportContent, wanted: set[str]) -> list[MetricMap]:
    data, found = content.data, []
    if "standard-hours" in wanted:
        hours = occupied_hours(content.times)
        reached = content.illuminance[:, hours] >= TARGET_LUX
        share = 100 * reached.mean(axis=1) if hours.any() else np.zeros(len(reached))
        note = f"hours from 8 to 18 h with {TARGET_LUX:.0f} lux; sDA counts 50 %"
        found.append(_map("standard-hours", "Daylight autonomy", note, share, "%"))
    if "standard-sun" in wanted and "direct_open" in data and "sun_hours" in data:
        lit = occupied_hours(content.times)
        sun = data["direct_open"].values[:, lit] > SUN_LUX
        hours_of_sun = sun.sum(axis=1) * content.grid.hours(np.ones(1, dtype=bool))
        note = f"above {SUN_LUX:,.0f} lux; ASE counts more than {MOST_HOURS:.0f} h"
        found.append(
            _map("standard-sun", "Hours of direct sun", note, hours_of_sun, "h")
        )
    if "standard-half" in wanted and "daylight_hours" in data:
        lit = data["daylight_hours"].values.astype(bool)
        share = 100 * (content.illuminance[:, lit] >= TARGET_LUX).mean(axis=1)
        note = f"daylight hours with {TARGET_LUX:.0f} lux; half of them are required"
        found.append(_map("standard-half", "Daylight provision", note, share, "%"))
    if "standard-factor" in wanted and "daylight_factor" in data:
        factor = 100 * data["daylight_factor"].values.astype(float)
        note = "under the CIE overcast sky, with open shades"
        found.append(_map("standard-factor", "Daylight factor", note, factor, "%"))
    if "standard-width" in wanted and "view_width" in data:
        width = data["view_width"].values.astype(float)
        note = "horizontal sight angle; levels at 14, 28 and 54°"
        found.append(_map("standard-width", "Width of the view", note, width, "°"))
        reach = np.minimum(data["view_distance"].values.astype(float), 100.0)
        note = "100 m if it is unobstructed; levels at 6, 20 and 50 m"
        found.append(_map("standard-reach", "Distance of the view", note, reach, "m"))
    return found


def _map(key: str, title: str, note: str, values: np.ndarray, unit: str) -> MetricMap:
    none = np.zeros(len(values))
    return MetricMap(key, title, note, values, none, unit, np.zeros((0, len(values))))
