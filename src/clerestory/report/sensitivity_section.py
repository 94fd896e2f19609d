"""Sensitivity of the metrics to materials: tornado plots and a table."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure, number

_LESS, _MORE, _INK = "#2f6f9f", "#d9a521", "#4a463e"

# Size of the drawings: width, width of the names, height of a row
_WIDTH, _NAMES, _ROW, _FOOT = 460.0, 120.0, 26.0, 24.0

# Largest number of materials in a drawing
_MOST = 20

# Half the width of a letter
_HALF = 3.8

# Last decimal of changes of an index
_FINEST = 0.0001

# Largest number of letters of a name
_LETTERS = 17


class _Line(NamedTuple):
    # Row of the table
    material: str
    present: str
    changes: list[tuple[str, str]]


def sensitivity_section(content: ReportContent) -> Section:
    """Return the section on sensitivity; empty if the study did not ask for it."""
    data = content.data
    if "sensitivity" not in data:
        return Section()
    found = [data, *([_of_glare(data)] if "glare_sensitivity" in data else [])]
    parts = [(str(p), one.sel(place=p)) for one in found for p in one["place"].values]
    return Section(
        render(
            "sensitivity.html",
            parts=[(place, _figures(part)) for place, part in parts],
            several=len(parts) > 1,
            tables=[(place, _heads(part), _lines(part)) for place, part in parts],
            example=_example(data),
            step=_step(data),
            keys=((_MORE, "lighter or clearer"), (_LESS, "darker or less clear")),
            glare=len(found) > 1,
        )
    )


def _of_glare(data: xr.Dataset) -> xr.Dataset:
    # Changes of glare under the names of those of light
    names = [name for name in data if str(name).startswith("glare_sensitivity")]
    common = ["sensitivity_value", "sensitivity_quantity"]
    renamed = {name: str(name).removeprefix("glare_") for name in names}
    renamed |= {"glare_figure": "figure", "view": "place"}
    return data[[*names, *common]].rename(renamed)


def _heads(data: xr.Dataset) -> list[str]:
    return [_head(data, str(name)) for name in data["figure"].values]


def _head(data: xr.Dataset, name: str) -> str:
    unit = str(data["sensitivity_unit"].sel(figure=name).values)
    return f"{name} [{'points' if unit == '%' else unit}]" if unit else name


def _figures(data: xr.Dataset) -> list[tuple[str, Markup]]:
    # A tornado plot of each metric that changes
    found = []
    for name in data["figure"].values.tolist():
        one = data.sel(figure=name)
        if np.any(one["sensitivity"].values):
            unit = _unit(one)
            base = number(float(one["sensitivity_base"]))
            sign = "%" if unit == "points" else unit
            found.append((f"{name}, now {base} {sign}".strip(), _tornado(one, unit)))
    return found


def _unit(data: xr.Dataset) -> str:
    unit = str(data["sensitivity_unit"].values)
    return "points" if unit == "%" else unit


def _tornado(data: xr.Dataset, unit: str) -> Markup:
    # Bars of both changes by material, the largest first
    change, error = data["sensitivity"].values, data["sensitivity_error"].values
    order = np.argsort(-np.abs(change).max(axis=1), kind="stable")[:_MOST]
    reach = max(float((np.abs(change) + error)[order].max()), 1e-9)
    middle = _NAMES + (_WIDTH - _NAMES) / 2
    scale = (_WIDTH - _NAMES) / 2 / reach * 0.94
    names = [str(name) for name in data["parameter"].values]
    marks = list[Markup]()
    for row, index in enumerate(order.tolist()):
        y = row * _ROW
        label = names[index]
        shown = label if len(label) <= _LETTERS else f"{label[: _LETTERS - 1]}…"
        place = {"x": f"{_NAMES - 8:.0f}", "y": f"{y + 17:.1f}", "text_anchor": "end"}
        marks.append(element("text", shown, **place))
        for side, colour in enumerate((_LESS, _MORE)):
            value, spread = float(change[index, side]), float(error[index, side])
            wide = abs(value) * scale
            left = middle if value >= 0 else middle - wide
            words = f"{label}: {_signed(value, spread, unit, index=not unit)}"
            marks.append(
                element(
                    "rect",
                    element("title", words),
                    x=f"{left:.1f}",
                    y=f"{y + 4:.1f}",
                    width=f"{wide:.1f}",
                    height=_ROW - 8,
                    fill=colour,
                )
            )
            end, high = middle + value * scale, y + _ROW / 2
            whisker = f"M{end - spread * scale:.1f},{high:.1f}h{2 * spread * scale:.1f}"
            marks.append(element("path", d=whisker, stroke=_INK, stroke_width=1.4))
    tall = len(order) * _ROW
    marks.append(element("path", d=f"M{middle:.1f},0V{tall}", stroke=_INK))
    marks += _axis(reach, middle, scale, tall, unit)
    label = "Change of the metric by material: " + "; ".join(
        f"{names[k]} "
        + _signed(float(change[k, 1]), float(error[k, 1]), unit, index=not unit)
        for k in order.tolist()
    )
    return drawing(label, *marks, width=_WIDTH, height=tall + _FOOT)


def _axis(
    reach: float, middle: float, scale: float, tall: float, unit: str
) -> list[Markup]:
    # Numbers at the ends and in the middle of the axis
    power = 10.0 ** np.floor(np.log10(reach))
    # The largest whose text stays within the drawing
    step = next(
        m * power
        for m in (5, 2, 1, 0.5, 0.2)
        if m * power * scale + len(_mark(m * power, unit)) * _HALF <= _WIDTH - middle
    )
    return [
        element(
            "text",
            _mark(value, unit),
            x=f"{middle + value * scale:.1f}",
            y=tall + 17,
            text_anchor="middle",
        )
        for value in (-step, 0.0, step)
    ]


def _mark(value: float, unit: str) -> str:
    return f"{value:+g} {unit}".strip() if value else "0"


def _lines(data: xr.Dataset) -> list[_Line]:
    found = []
    for name in data["parameter"].values.tolist():
        one = data.sel(parameter=name)
        quantity = str(one["sensitivity_quantity"].values)
        present = f"{quantity} {float(one['sensitivity_value']):.3g}"
        changes = []
        for figure in one["figure"].values.tolist():
            here = one.sel(figure=figure)
            low, high = (
                _signed(float(value), float(error), "", index=not _unit(here))
                for value, error in zip(
                    here["sensitivity"].values,
                    here["sensitivity_error"].values,
                    strict=True,
                )
            )
            changes.append((low, high))
        found.append(_Line(name, present, changes))
    return found


def _signed(value: float, error: float, unit: str, *, index: bool = False) -> str:
    # Changes of an index, such as DGP, have a fixed number of decimals
    text = str(Figure(value, error, unit)).strip()
    if index:
        spread = f"{error:.4f}" if error >= _FINEST / 2 else f"<{_FINEST}"
        text = f"{value:.4f} ± {spread}"
    return f"+{text}" if value > 0 else text


def _example(data: xr.Dataset) -> str:
    # The material with the largest effect in words
    place = str(data["place"].values[0])
    of = data.sel(place=place)
    name = "spatial autonomy"
    # Few sensors may all stay on their side of the target
    if not np.any(of["sensitivity"].sel(figure=name, change="more").values):
        name = "mean illuminance"
    one = of.sel(figure=name)
    largest = int(np.argmax(np.abs(one["sensitivity"].values[:, 1])))
    step = float(one["sensitivity_step"].values[largest, 1])
    change = _signed(
        float(one["sensitivity"].values[largest, 1]),
        float(one["sensitivity_error"].values[largest, 1]),
        _unit(one),
    )
    material = str(one["parameter"].values[largest])
    return f"{step:+.2g} on {material}: {name} of {place} {change}"


def _step(data: xr.Dataset) -> str:
    # Step of the study; single materials may have a smaller one
    return f"{float(np.abs(data['sensitivity_step'].values).max()):.2g}"
