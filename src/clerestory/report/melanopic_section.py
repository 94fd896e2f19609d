"""Melanopic daylight of the year: hours and days at each eye, colour, and annual maps.

Eyes are the sensors with spectra of the light; without these, vertical sensors.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import xarray as xr
from jaxtyping import Float, Int, UInt8

from clerestory.metrics.melanopic import LOW_MELANOPIC_LUX
from clerestory.report.class_map import DayMap, keys
from clerestory.report.content import ReportContent
from clerestory.report.markup import render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure
from clerestory.spectral.alpha_opic import EML_PER_EDI

# Limits of the classes of melanopic EDI [lux], and their colours from dark to bright
_LIMITS = (10.0, 50.0, LOW_MELANOPIC_LUX, 250.0, 500.0, 1000.0)
_COLOURS: UInt8[np.ndarray, "kind 3"] = np.array(
    [
        [40, 40, 60],
        [70, 78, 122],
        [105, 130, 175],
        [150, 185, 205],
        [252, 222, 140],
        [246, 180, 80],
        [222, 120, 50],
    ],
    dtype=np.uint8,
)

# Shares of days with melanopic light
_DAYS = ("melanopic_days", "low_melanopic_days")

# Largest number of annual maps, and of eyes in the tables
_MOST_MAPS, _MOST_ROWS = 8, 60

# Largest vertical component of the direction of an eye
_LEVEL = 0.5

# Illuminance above which colours count [lux]
_LIT_LUX = 10.0


def melanopic_section(content: ReportContent) -> Section:
    """Return the section on melanopic light; empty without it."""
    data = content.data
    if "melanopic_edi" not in data:
        return Section()
    eyes = _eyes(content)
    if not len(eyes):
        return Section()
    names = [content.sensors.names[k] for k in eyes]
    maps = [
        DayMap(
            f"melanopic-{number}",
            f"Melanopic EDI at {name} by day and hour",
            _classes(data["melanopic_edi"].values[k]),
            _texts(),
            _COLOURS,
        )
        for number, (k, name) in enumerate(
            zip(eyes[:_MOST_MAPS], names[:_MOST_MAPS], strict=True)
        )
    ]
    target = float(data.attrs.get("melanopic_target_lux", 250.0))
    body = render(
        "melanopic.html",
        head=_head(target) + _head_of_both(content, target),
        rows=[_row(content, k) for k in eyes[:_MOST_ROWS].tolist()],
        left=max(0, len(eyes) - _MOST_ROWS),
        colours=_colour_rows(content),
        receptors=_receptor_rows(content),
        classes=keys(_texts(), _COLOURS),
        bands=str(data.attrs.get("band_errors", "")),
        maps=[
            {
                "name": name,
                "map": one.drawing(content.grid, occupied=content.occupied),
            }
            for name, one in zip(names, maps, strict=False)
        ],
    )
    return Section(body, maps=maps)


def _eyes(content: ReportContent) -> Int[np.ndarray, " eye"]:
    # Sensors with spectra, or those that look ahead
    names = np.array(content.sensors.names, dtype=object)
    if "eye" in content.data:
        return np.flatnonzero(np.isin(names, content.data["eye"].values))
    upright = np.abs(content.sensors.direction[:, 2]) <= _LEVEL
    return np.flatnonzero(upright)


def _head(target: float) -> list[str]:
    return [
        "Eye",
        "Mean melanopic EDI",
        "as EML",
        f"Hours with {target:,.0f} lux",
        f"Days with {target:,.0f} lux for 4 h by noon",
        f"Days with {LOW_MELANOPIC_LUX:,.0f} lux for 4 h by noon",
    ]


def _head_of_both(content: ReportContent, target: float) -> list[str]:
    # Heads of the columns of days with daylight and electric light
    levels = (target, LOW_MELANOPIC_LUX)
    return [
        f"… {level:,.0f} lux with electric light"
        for level, name in zip(levels, _DAYS, strict=True)
        if f"total_{name}" in content.metrics
    ]


def _row(content: ReportContent, k: int) -> tuple[str, list[str]]:
    metrics = content.metrics
    mean = _figure(metrics, "mean_melanopic_edi", k, "lux")
    shares = ("melanopic_autonomy", *_DAYS, *(f"total_{name}" for name in _DAYS))
    return content.sensors.names[k], [
        str(mean),
        f"{mean.value * EML_PER_EDI:,.0f}",
        *(str(_figure(metrics, name, k, "%")) for name in shares if name in metrics),
    ]


def _figure(metrics: xr.Dataset, name: str, k: int, unit: str) -> Figure:
    factor = 100 if unit == "%" else 1
    value, error = (float(metrics[n].values[k]) for n in (name, f"{name}_error"))
    return Figure(factor * value, factor * error, unit)


def _receptor_rows(content: ReportContent) -> list[tuple[str, list[str]]]:
    # Mean equivalent daylight illuminance of each photoreceptor, occupied hours
    data = content.data
    if "edi" not in data or data.sizes["photoreceptor"] < 2:
        return []
    edi = data["edi"].values[..., content.occupied].mean(axis=-1)
    lux = data["eye_illuminance"].values[:, content.occupied].mean(axis=-1)
    names = data["eye"].values.tolist()
    return [
        (name, [f"{value:,.0f}" for value in (lux[k], *edi[:, k])])
        for k, name in enumerate(names[:_MOST_ROWS])
    ]


def _colour_rows(content: ReportContent) -> list[tuple[str, list[str]]]:
    # Median and range of colour temperature, Duv and rendering, in occupied lit hours
    data = content.data
    if "colour_temperature" not in data:
        return []
    forms: dict[str, Callable[[float], str]] = {
        "colour_temperature": lambda x: f"{x:,.0f} K",
        "duv": lambda x: f"{x:+.4f}",
        "colour_rendering": lambda x: f"{x:.0f}",
        "colour_rendering_red": lambda x: f"{x:.0f}",
    }
    rows = []
    for k, name in enumerate(data["eye"].values.tolist()[:_MOST_ROWS]):
        lit = data["eye_illuminance"].values[k] > _LIT_LUX
        counted = lit & content.occupied
        cells = [
            _range(data[key].values[k][counted], form) for key, form in forms.items()
        ]
        days = 100 * float(data["bright_days"].values[k])
        rows.append((name, [*cells, f"{days:.0f} %"]))
    return rows


def _range(values: Float[np.ndarray, " time"], form: Callable[[float], str]) -> str:
    known = values[np.isfinite(values)]
    if not len(known):
        return "–"
    low, middle, high = np.quantile(known, (0.05, 0.5, 0.95))
    return f"{form(middle)} ({form(low)} to {form(high)})"


def _classes(edi: Float[np.ndarray, " time"]) -> Int[np.ndarray, " time"]:
    # Class of each time step, -1 in the dark
    return np.where(edi > 0, np.searchsorted(_LIMITS, edi, side="right"), -1)


def _texts() -> tuple[str, ...]:
    limits = [f"{limit:,.0f}" for limit in _LIMITS]
    between = [f"{a} to {b} lux" for a, b in pairwise(limits)]
    return f"below {limits[0]} lux", *between, f"{limits[-1]} lux or more"
