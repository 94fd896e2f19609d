"""Annual glare of each view: categories, hours and worst time steps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int, UInt8

from clerestory.glare.comfort_classes import (
    EXCEEDANCE,
    LIMITS,
    exceeded_dgp,
    glare_autonomy,
    protection_level,
)
from clerestory.glare.dgp import DGP
from clerestory.glare.index import CATEGORIES
from clerestory.report.class_map import DayMap, keys
from clerestory.report.content import ReportContent
from clerestory.report.markup import render
from clerestory.report.period import moment_words
from clerestory.report.section import Section
from clerestory.report.uncertain_value import number

# Colours from imperceptible to intolerable glare, distinct even in greyscale
COLOURS = np.array(
    [[158, 196, 222], [246, 213, 92], [237, 125, 58], [156, 27, 47]], dtype=np.uint8
)

# Resolution of DGP on the page, and number of worst time steps listed
_STEP = 0.01
_WORST = 5

# DGP at zero eye illuminance (constant of the formula), and its colour
_PALEST = 0.16
_PALE = np.array([235.0, 243.0, 249.0])


@dataclass(frozen=True, eq=False)
class ViewGlare:
    """Annual glare of one view; values are NaN in the dark.

    `illuminance` is the illuminance at the eye [lux], `brightest` the luminance of the
    brightest pixel [cd/m²], `error` the standard error of DGP, NaN if unknown.
    """

    view: str
    dgp: Float[np.ndarray, " time"]
    illuminance: Float[np.ndarray, " time"]
    brightest: Float[np.ndarray, " time"]
    error: Float[np.ndarray, " time"]

    def words(self, step: int) -> str:
        """Return DGP of a time step with its standard error, if known."""
        value, error = self.dgp[step], self.error[step]
        if not np.isfinite(error):
            return f"{value:.2f}"
        digits = 2 if error >= _STEP / 2 else 3
        return f"{value:.{digits}f} ± {max(error, 0.001):.{digits}f}"

    def class_of(self, step: int) -> str:
        """Return the glare category of a time step."""
        return CATEGORIES[int(DGP.category(self.dgp[step : step + 1])[0])]

    def rated(self) -> Float[np.ndarray, " time"]:
        """DGP of each time step, 0 in the dark."""
        return np.asarray(np.nan_to_num(self.dgp, nan=0.0))


def view_glare(data: xr.Dataset) -> tuple[ViewGlare, ...]:
    """Return the annual glare of each view in the results; empty without views."""
    if "glare_dgp" not in data:
        return ()
    names = (
        "glare_dgp",
        "glare_illuminance",
        "glare_brightest_luminance",
        "glare_dgp_error",
    )
    missing = xr.full_like(data["glare_dgp"], np.nan)
    values = [data.get(name, missing).transpose("view", "time") for name in names]
    rows = zip(*(value.values.astype(float) for value in values), strict=True)
    views = data["view"].values.tolist()
    return tuple(ViewGlare(view, *row) for view, row in zip(views, rows, strict=True))


def glare_maps(views: Sequence[ViewGlare]) -> list[DayMap]:
    """Return an annual map of DGP, in steps of 0.01, for each view."""
    level = np.arange(round(1 / _STEP) + 1) * _STEP
    group = DGP.category(level)
    texts = tuple(
        f"DGP {x:.2f}, {CATEGORIES[k]}" for x, k in zip(level, group, strict=True)
    )
    return [
        DayMap(
            f"glare-{number}",
            f"Glare at {glare.view} by day and hour",
            dgp_steps(glare.dgp),
            texts,
            shades(level),
        )
        for number, glare in enumerate(views)
    ]


def shades(dgp: Float[np.ndarray, " level"]) -> UInt8[np.ndarray, "level 3"]:
    """Colour of each DGP by glare category; low imperceptible DGP is paler."""
    colours = COLOURS[DGP.category(dgp)].astype(float)
    low = dgp <= LIMITS[0]
    share = np.clip((dgp[low] - _PALEST) / (LIMITS[0] - _PALEST), 0, 1)[:, None]
    colours[low] = _PALE + share * (COLOURS[0] - _PALE)
    return np.asarray(np.round(colours), dtype=np.uint8)


def dgp_steps(dgp: Float[np.ndarray, " time"]) -> Int[np.ndarray, " time"]:
    """Return DGP × 100, rounded to integers of the same category; -1 for NaN."""
    exact = np.nan_to_num(dgp)
    steps = np.round(np.clip(exact, 0, 1) / _STEP).astype(int)
    moved = DGP.category(exact) - DGP.category(steps * _STEP)
    return np.asarray(np.where(np.isnan(dgp), -1, steps + np.sign(moved)))


def class_words() -> list[str]:
    """Return the glare categories with their DGP limits."""
    limits = [*(f"to {limit:.2f}" for limit in LIMITS), f"above {LIMITS[-1]:.2f}"]
    return [f"{c}, DGP {limit}" for c, limit in zip(CATEGORIES, limits, strict=True)]


def glare_section(content: ReportContent) -> Section:
    """Return the annual glare of each view, with categories and worst time steps."""
    views = view_glare(content.data)
    if not views:
        return Section()
    maps = glare_maps(views)
    shown = [
        {
            "name": glare.view,
            "text": glare_words(glare, content.occupied),
            "map": one.drawing(content.grid, occupied=content.occupied),
        }
        for glare, one in zip(views, maps, strict=True)
    ]
    body = render(
        "glare.html",
        views=shown,
        classes=keys(class_words(), COLOURS),
        categories=[category.capitalize() for category in CATEGORIES],
        shares=_class_rows(views, content),
        worst=_worst_rows(views, content),
    )
    return Section(body, maps=maps)


def glare_words(glare: ViewGlare, occupied: Bool[np.ndarray, " time"]) -> str:
    """Return the annual glare of a view in words."""
    dgp = glare.rated()[occupied]
    top = float(exceeded_dgp(dgp))
    level = protection_level(top)
    protection = "no" if level == "none" else level
    # The time step whose DGP is that percentile has its error
    step = int(np.argmin(np.where(occupied, np.abs(glare.rated() - top), np.inf)))
    value = glare.words(step) if np.isfinite(glare.dgp[step]) else f"{top:.2f}"
    free = 100 * float(glare_autonomy(dgp))
    return (
        f"A DGP of {value} is exceeded in {100 * EXCEEDANCE:.0f} % of the occupied"
        f" hours: {protection} protection from glare after EN 17037."
        f" {free:.1f} % of the hours are free of disturbing glare."
    )


def glare_note(views: Sequence[ViewGlare], view: str, step: int) -> str:
    """Return the glare of a view at a time step in words; empty if unknown."""
    glare = next((each for each in views if each.view == view), None)
    if glare is None or not np.isfinite(glare.dgp[step]):
        return ""
    words = f"DGP {glare.words(step)}, {glare.class_of(step)}"
    if np.isfinite(glare.illuminance[step]):
        words += f"; {number(float(glare.illuminance[step]))} lux at the eye"
    return words


def _class_rows(
    views: Sequence[ViewGlare], content: ReportContent
) -> list[tuple[str, list[str]]]:
    return [
        (
            glare.view,
            [
                content.occupied_share(DGP.category(glare.rated()) == kind)
                for kind in range(len(CATEGORIES))
            ],
        )
        for glare in views
    ]


def _worst_rows(
    views: Sequence[ViewGlare], content: ReportContent
) -> list[tuple[str, list[str]]]:
    return [
        (
            f"{glare.view}, {moment_words(content.times[step])}",
            [
                glare.words(step),
                glare.class_of(step),
                _or_dash(float(glare.illuminance[step])),
                _or_dash(float(glare.brightest[step])),
            ],
        )
        for glare in views
        for step in worst_steps(glare, content.times, content.occupied).tolist()
    ]


def worst_steps(
    glare: ViewGlare, times: np.ndarray, occupied: Bool[np.ndarray, " time"]
) -> Int[np.ndarray, " step"]:
    """Occupied time steps of highest DGP, at most five, one per day, worst first.

    Time steps without perceptible glare are left out, unless there are no others; then
    only the worst is returned.
    """
    rated = np.where(occupied & np.isfinite(glare.dgp), glare.rated(), -1.0)
    order = np.argsort(-rated, kind="stable")
    order = order[rated[order] >= 0]
    _, first = np.unique(times[order].astype("datetime64[D]"), return_index=True)
    worst = order[np.sort(first)]
    count = int((DGP.category(rated[worst]) > 0).sum())
    return np.asarray(worst[: min(max(count, 1), _WORST)])


def _or_dash(value: float) -> str:
    return number(value) if np.isfinite(value) else "–"
