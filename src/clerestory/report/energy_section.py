"""Energy of the building: months, sunlight at the windows, and two weeks."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.section import Section
from clerestory.report.solar_flow import solar_drawing, solar_words
from clerestory.report.uncertain_value import number

_COLOURS = {
    "heating": "#b5482e",
    "cooling": "#2f6f9f",
    "lighting": "#d9a521",
    "equipment": "#8a8a8a",
}
_MONTHS = "JFMAMJJASOND"

# Size of the drawings, and margins of their axes
_WIDTH, _HEIGHT, _LEFT, _FOOT, _TOP = 560.0, 180.0, 64.0, 22.0, 10.0

# Weeks that are drawn: title, first day of the year, counted from 0
_WEEKS = (("A week of January", 14), ("A week of July", 195))
_HOURS = 168


def energy_section(content: ReportContent) -> Section:
    """Return the section of EnergyPlus' results; empty without them."""
    data = content.data
    if "annual_energy" not in data:
        return Section()
    uses = [use for use in _COLOURS if use in data["energy_use"].values]
    rows = [
        (
            use,
            number(float(data["annual_energy"].sel(energy_use=use))),
            number(float(data["peak_power"].sel(energy_use=use))),
        )
        for use in uses
    ]
    weeks = [(title, _week(data, uses, day, title)) for title, day in _WEEKS]
    return Section(
        render(
            "energy.html",
            rows=rows,
            comfort=_comfort(data),
            months=_months(data, uses),
            sun=solar_drawing(data),
            sun_words=solar_words(data),
            fixed=_fixed(data),
            checks=_checks(data),
            keys=[(use, _COLOURS[use]) for use in uses],
            weeks=[(title, drawn) for title, drawn in weeks if drawn],
        )
    )


def _comfort(data: xr.Dataset) -> list[str]:
    low, high = np.ravel(data["hours_out_of_comfort"].attrs["comfort_c"])
    return [
        f"{zone}: {number(hours)} occupied hours with an operative temperature outside"
        f" {low:g} to {high:g} °C."
        for zone, hours in zip(
            data["thermal_zone"].values.tolist(),
            data["hours_out_of_comfort"].values.tolist(),
            strict=True,
        )
    ]


def _months(data: xr.Dataset, uses: Sequence[str]) -> Markup:
    # Stacked bars of energy by month
    month = data["time"].dt.month.values - 1
    sums = np.array(
        [
            np.bincount(month, np.nan_to_num(data["energy"].sel(energy_use=u)), 12)
            for u in uses
        ]
    )
    top = max(float(sums.sum(axis=0).max()), 1e-9)
    step = (_WIDTH - _LEFT) / 12
    marks = _axis(top, "kWh")
    for k in range(12):
        x, base = _LEFT + (k + 0.15) * step, 0.0
        for use, value in zip(uses, sums[:, k].tolist(), strict=True):
            tall = _HEIGHT * value / top
            marks.append(
                element(
                    "rect",
                    element("title", f"{use}: {number(value)} kWh"),
                    x=f"{x:.1f}",
                    y=f"{_TOP + _HEIGHT - base - tall:.1f}",
                    width=f"{0.7 * step:.1f}",
                    height=f"{tall:.1f}",
                    fill=_COLOURS[use],
                )
            )
            base += tall
        place = {"x": f"{x + 0.35 * step:.1f}", "y": _TOP + _HEIGHT + 15}
        marks.append(element("text", _MONTHS[k], text_anchor="middle", **place))
    label = "Energy by month: " + "; ".join(
        f"{use} {number(float(total))} kWh in the year"
        for use, total in zip(uses, sums.sum(axis=1), strict=True)
    )
    return drawing(label, *marks, width=_WIDTH, height=_TOP + _HEIGHT + _FOOT)


def _axis(top: float, unit: str) -> list[Markup]:
    # Lines and labels of a quarter, a half … of a round number below the largest value
    power = 10.0 ** np.floor(np.log10(top))
    step = next(m * power for m in (5, 2, 1, 0.5, 0.2) if top / (m * power) >= 2)
    marks = []
    for value in np.arange(0, top * 1.0001, step).tolist():
        y = _TOP + _HEIGHT * (1 - value / top)
        line = f"M{_LEFT},{y:.1f}H{_WIDTH}"
        marks.append(element("path", d=line, stroke="#d8d4ca", stroke_width=0.7))
        text = f"{number(value)} {unit}" if value else "0"
        place = {"x": _LEFT - 5, "y": f"{y + 4:.1f}"}
        marks.append(element("text", text, text_anchor="end", **place))
    return marks


def _fixed(data: xr.Dataset) -> list[tuple[str, ...]]:
    # Energy of this operation, and with each shade state at all hours
    if "fixed_state_energy" not in data:
        return []
    uses = ["heating", "cooling", "lighting"]
    rows = {"this study": data["annual_energy"].sel(energy_use=uses).values}
    fixed = data["fixed_state_energy"].sel(energy_use=uses).values
    rows |= {f"always in state {number}": row for number, row in enumerate(fixed)}
    return [
        (name, *(number(float(value)) for value in (*row, row.sum())))
        for name, row in rows.items()
    ]


def _checks(data: xr.Dataset) -> list[str]:
    # Energy balance of windows, closure of zones, and errors of zone models
    lines = []
    if "solar_balance" in data:
        lines.append(
            "Reflected, absorbed and transmitted radiation differ from the radiation on"
            f" a window by {_at_most(float(data['solar_balance'].max()))} in any hour;"
            " before scaling, surfaces absorb"
            f" {100 * float(data['zone_closure'].min()):.1f} % of the radiation that"
            " reaches the zone."
        )
    if "zone_model_error" in data:
        for name, (kelvin, load, energy) in zip(
            data["zone_model"].values.tolist(),
            data["zone_model_error"].values.tolist(),
            strict=True,
        ):
            lines.append(
                f"Zone model of {name}: the air temperature differs from EnergyPlus by"
                f" {kelvin:.2g} K (root mean square), loads by {100 * load:.0f} %, the"
                f" energy of a year by at most {100 * energy:.1f} %."
            )
    return lines


def _at_most(share: float) -> str:
    return "less than 0.01 %" if share < 1e-4 else f"at most {100 * share:.2g} %"


def _week(data: xr.Dataset, uses: Sequence[str], day: int, title: str) -> Markup:
    # Power of each use, hour by hour
    steps = data.sizes["time"] // 8760
    if not steps:
        return Markup("")
    chosen = slice(day * 24 * steps, (day * 24 + _HOURS) * steps)
    power = np.nan_to_num(data["energy"].isel(time=chosen).values) * steps
    top = max(float(power.max()), 1e-9)
    marks = _axis(top, "kW")
    days = data["time"].dt.day.values[chosen][:: 24 * steps].tolist()
    wide = (_WIDTH - _LEFT) / len(days)
    for k, number_of_day in enumerate(days):
        x = _LEFT + wide * k
        line = f"M{x:.1f},{_TOP}V{_TOP + _HEIGHT}"
        marks.append(element("path", d=line, stroke="#d8d4ca", stroke_width=0.7))
        place = {"x": f"{x + wide / 2:.1f}", "y": _TOP + _HEIGHT + 15}
        marks.append(element("text", number_of_day, text_anchor="middle", **place))
    known = data["energy_use"].values.tolist()
    marks += [_curve(power[known.index(use)], top, _COLOURS[use]) for use in uses]
    return drawing(
        f"{title}: heating, cooling, lighting and equipment power",
        *marks,
        width=_WIDTH,
        height=_TOP + _HEIGHT + _FOOT,
    )


def _curve(values: Float[np.ndarray, " step"], top: float, colour: str) -> Markup:
    x = np.linspace(_LEFT, _WIDTH, len(values))
    y = _TOP + _HEIGHT * (1 - values / top)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return element(
        "polyline", points=points, fill="none", stroke=colour, stroke_width=1.4
    )
