"""Terms of the matrix equation and the effect of the direct-sun correction.

I = V T D S − V_d T D_d S_ds + C_ds S_sun (five-phase method): illuminance without
correction, minus direct sunlight spread over sky patches, plus direct sunlight from the
exact sun position. The page contains annual series of a few sensors and draws one day.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.phases.methods import DIRECT_IN_PATCHES, DIRECT_SUN, METHODS, MethodName
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import CODE_STEP, illuminance_codes, packed
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.period import date_words, evenly
from clerestory.report.section import Section
from clerestory.report.uncertain_value import number

# Largest number of sensors for which the page contains equation terms
_MOST = 12

# Ratio of correction to uncorrected illuminance above which a correction is large
_MUCH = 0.10

# CSS classes of the lines in the drawing
_CLASSES = ("whole", "spread", "sun", "sum")

# Round numbers within a decade, for the intervals of the illuminance axis
_STEPS = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8)

_WIDTH, _HEIGHT, _LEFT, _TOP, _FOOT = 760, 250, 62, 12, 30


@dataclass(frozen=True, eq=False)
class EquationTerms:
    """Terms of the matrix equation and their sum, as illuminance [lux].

    Attributes
    ----------
    lux : illuminance without correction, from direct sun spread over patches, from
        direct sun at its exact position, and with correction
    method : name of the method with direct-sun correction, such as "5-phase"
    """

    lux: Float[np.ndarray, "4 sensor time"]
    method: MethodName

    def names(self) -> tuple[str, str]:
        """Names of the methods without and with direct-sun correction."""
        method = METHODS[self.method]
        if method.correction == "choice":
            return f"{self.method} method", f"{self.method} method with the exact sun"
        plain = next(name for name, m in METHODS.items() if m.whole == method.whole)
        return f"{plain} method", f"{self.method} method"

    def labels(self) -> tuple[str, str, str, str]:
        """Label of the line of each term of `lux`: words and formula."""
        method, (plain, corrected) = METHODS[self.method], self.names()
        whole, spread, sun = map(method.formula, method.terms(corrected=True))
        return (
            f"{plain}, {whole}",
            f"less the sun in patches, {spread}",
            f"plus the sun at its position, {sun}",
            f"{corrected}, the sum",
        )

    def correction(self) -> Float[np.ndarray, "sensor time"]:
        """Direct-sun correction: corrected minus uncorrected illuminance [lux]."""
        return np.asarray(self.lux[2] - self.lux[1])

    def chosen(self) -> list[int]:
        """Indices of sensors shown: the most corrected one, others evenly spaced."""
        changed = np.abs(self.correction()).sum(axis=1)
        most = int(np.argmax(changed))
        others = [k for k in evenly(len(changed), _MOST) if k != most]
        return [most, *others[: _MOST - 1]]

    def strongest_day(self, sensor: int, times: np.ndarray) -> np.datetime64:
        """Return the day with the largest total correction at a sensor."""
        days, place = np.unique(times.astype("datetime64[D]"), return_inverse=True)
        changed = np.bincount(place, weights=np.abs(self.correction()[sensor]))
        return np.datetime64(days[int(np.argmax(changed))])


def equation_terms(data: xr.Dataset) -> EquationTerms | None:
    """Return the terms of the matrix equation; None without direct-sun correction."""
    found = [
        name
        for name, method in METHODS.items()
        if method.whole in data and method.correction != "never"
    ]
    if not found or DIRECT_SUN not in data:
        return None
    names = (METHODS[found[0]].whole, DIRECT_IN_PATCHES, DIRECT_SUN)
    whole, spread, sun = (data[n].transpose("sensor", "time").values for n in names)
    lux = np.stack([whole, spread, sun, whole - spread + sun], dtype=np.float32)
    return EquationTerms(lux, found[0])


def equation_section(content: ReportContent) -> Section:
    """Return the equation terms at one sensor on one day, and their means by grid.

    The section is empty without direct-sun correction.
    """
    terms, times, names = (
        equation_terms(content.data),
        content.times,
        content.sensors.names,
    )
    if terms is None:
        return Section()
    chosen = terms.chosen()
    day = terms.strongest_day(chosen[0], times)
    body = render(
        "equation.html",
        sensors=[names[sensor] for sensor in chosen],
        day=date_words(day),
        drawing=_drawing(terms, chosen[0], day, times),
        lines=list(zip(_CLASSES, terms.labels(), strict=True)),
        headings=terms.names(),
        patches="patches of sky" + " and window" * METHODS[terms.method].windows,
        much=f"{100 * _MUCH:.0f}",
        rows=_grid_rows(terms, content),
    )
    days = times.astype("datetime64[D]")
    series = [
        {"name": names[k], "codes": packed(illuminance_codes(terms.lux[:, k]))}
        for k in chosen
    ]
    data = {
        "start": day.astype(int).item(),
        "day": packed(days.astype(np.int32)),
        "minute": packed((times - days).astype("timedelta64[m]").astype(np.uint16)),
        "code_step": CODE_STEP,
        "box": [_WIDTH, _HEIGHT, _LEFT, _TOP],
        "steps": list(_STEPS),
        "series": series,
    }
    return Section(body, {"terms": data})


def _drawing(
    terms: EquationTerms, sensor: int, day: np.datetime64, times: np.ndarray
) -> Markup:
    steps = np.flatnonzero(times.astype("datetime64[D]") == day)
    lux = np.maximum(terms.lux[:, sensor, steps], 0)
    top = ceiling(float(lux.max(initial=0)))
    minute = (times[steps] - day).astype("timedelta64[m]").astype(int)
    paths = [
        element("path", d=_path(minute, values / top), class_=kind)
        for kind, values in zip(_CLASSES, lux, strict=True)
    ]
    label = f"Terms of the {terms.method} equation over a day [lux]"
    marks = [
        element("text", f"{h:02d}:00", x=f"{_x(60 * h):.1f}", y=_TOP + _HEIGHT + 20)
        for h in range(0, 25, 3)
    ]
    levels = [
        element("text", number(top * k / 4), x=_LEFT - 8, y=_y(k / 4) + 4, class_="end")
        for k in range(5)
    ]
    lines = [element("path", d=f"M{_LEFT},{_y(k / 4)}h{_WIDTH}") for k in range(5)]
    return drawing(
        label,
        element("g", *lines, class_="grid"),
        element("g", *marks),
        element("g", *levels, id="term-levels"),
        element("text", "lux", x=_LEFT + 6, y=_TOP + 14, class_="start"),
        element("g", *paths, id="term-lines"),
        width=_LEFT + _WIDTH + 20,
        height=_TOP + _HEIGHT + _FOOT,
        class_="terms",
        id="term-chart",
    )


def ceiling(lux: float) -> float:
    """Return the lowest axis limit ≥ `lux`, at least 4, with four round intervals.

    >>> ceiling(950.0), ceiling(0.0), ceiling(40_001.0)
    (1000.0, 4.0, 60000.0)
    """
    steps = (4 * m * 10.0**d for d in range(6) for m in _STEPS)
    return float(next((top for top in steps if top >= lux), 1e6))


def _x(minute: float) -> float:
    return _LEFT + _WIDTH * minute / 1440


def _y(share: float) -> float:
    return _TOP + _HEIGHT * (1 - share)


def _path(minute: Int[np.ndarray, " step"], share: Float[np.ndarray, " step"]) -> str:
    points = zip(minute.tolist(), share.tolist(), strict=True)
    return "M" + "L".join(f"{_x(m):.1f},{_y(s):.1f}" for m, s in points)


def _grid_rows(
    terms: EquationTerms, content: ReportContent
) -> list[tuple[str, list[str]]]:
    # For each grid: mean of each term, percentage of values with a large correction
    rows = []
    for grid, members in content.sensors.by_grid().items():
        lux = terms.lux[:, members][..., content.occupied].astype(float)
        whole, spread, sun, _ = lux
        lit = whole > 0
        much = np.abs(sun - spread)[lit] > _MUCH * whole[lit]
        share = 100 * float(much.mean()) if much.size else 0.0
        means = [number(float(mean)) for mean in lux.mean(axis=(1, 2))]
        rows.append((grid, [*means, f"{share:.1f} %"]))
    return rows
