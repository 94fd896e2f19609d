"""Section on the total uncertainty: what is not known exactly, and its effect."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure, number

_WIDTH, _LEFT, _ROW = 960.0, 250.0, 30.0
_COLOURS = (
    "#1f4e79",
    "#d9772b",
    "#2f8f5b",
    "#6a3d9a",
    "#c2a100",
    "#b5367a",
    "#5a9bd4",
    "#8a6d4b",
    "#8a939d",
)

# Share of the variance below which a quantity does not matter
_SMALL = 0.05

_SHAPES = {
    "normal": "normal",
    "uniform": "all values equally probable",
    "triangular": "triangular",
    "choice": "one of several weather files",
}


class KnownFigure(NamedTuple):
    """A figure of merit with both of its errors, and what causes them."""

    name: str
    place: str
    simulation: str
    knowledge: str
    range: str
    cause: str


def knowledge_section(content: ReportContent) -> Section:
    """Return the section on total uncertainty; empty without [uncertainty]."""
    data = content.data
    if "known_figure_value" not in data:
        return Section()
    return Section(
        render(
            "knowledge.html",
            figures=[(own.name, list(own[1:])) for own in known_figures(data)],
            draws=f"{data.sizes['draw']:,}",
            lead=_lead(data),
            interval=_intervals(data),
            bars=_shares(data),
            keys=list(zip(_groups(data), _palette(data), strict=True)),
            unknowns=_unknowns(data),
            chances=probabilities(data),
            checks=_checks(data),
            case_names=[f"Case {k + 1}" for k in range(data.sizes.get("check", 0))],
            together=_together(data),
        )
    )


def knowledge_error(data: xr.Dataset, number_of_figure: int) -> str:
    """Return the error of a figure that is due to what is not known, in words.

    Empty without [uncertainty].
    """
    if "known_figure_deviation" not in data:
        return ""
    unit = str(data["known_figure_unit"].values[number_of_figure])
    spread = float(data["known_figure_deviation"].values[number_of_figure])
    return f"± {_short_number(spread)} {unit} from what is not known exactly"


def _short_number(value: float) -> str:
    # Two digits
    return f"{value:,.0f}" if value >= 10 else f"{value:.2g}"


def known_figures(data: xr.Dataset) -> list[KnownFigure]:
    """Return all figures with their errors, in words."""
    found = []
    for k in range(data.sizes["known_figure"]):
        name, place, unit = (
            str(data[f"known_figure_{part}"].values[k])
            for part in ("name", "place", "unit")
        )
        value, error, spread = (
            float(data[f"known_figure_{part}"].values[k])
            for part in ("value", "error", "deviation")
        )
        low, _, high = data["known_figure_quantile"].values[k].tolist()
        found.append(
            KnownFigure(
                name,
                place,
                str(Figure(value, error, unit)),
                f"± {_short_number(spread)} {unit}",
                f"{number(low)} to {number(high)} {unit}",
                _cause(data, k) if spread > 0 else "nothing",
            )
        )
    return found


def _cause(data: xr.Dataset, figure: int) -> str:
    # The quantities that cause most of the variance
    share = data["total_index"].values[figure]
    names = _groups(data)
    order = [k for k in np.argsort(-share).tolist() if share[k] >= _SMALL][:2]
    return ", ".join(f"{names[k]} ({100 * min(share[k], 1):.0f} %)" for k in order)


def _groups(data: xr.Dataset) -> list[str]:
    return [str(name) for name in data["unknown_group"].values]


def _palette(data: xr.Dataset) -> list[str]:
    count = data.sizes["unknown_group"]
    return [_COLOURS[min(k, len(_COLOURS) - 1)] for k in range(count)]


def _lead(data: xr.Dataset) -> list[str]:
    # Sentences on the first grid's autonomy
    first = 1
    figure = known_figures(data)[first]
    value = float(data["known_figure_value"].values[first])
    error = float(data["known_figure_error"].values[first])
    spread = float(data["known_figure_deviation"].values[first])
    larger = spread / error if error > 0 else np.inf
    compared = (
        "The random numbers of the simulation matter less than what is not known."
    )
    if larger < 1:
        compared = "The random numbers of the simulation matter more than what is not"
        compared += " known: more samples would help."
    cause = _cause(data, first)
    words = [
        f"{figure.name.capitalize()} of “{figure.place}” is {value:.1f} % in the model."
        f" With all that is not known exactly it is between {figure.range} in nine of"
        f" ten cases. {compared}"
    ]
    if cause:
        words.append(
            f"Most of this comes from {cause}: to know the result better, measure that"
            " first. A percentage is the share of the variance that the quantity has to"
            " do with."
        )
    return words


def _together(data: xr.Dataset) -> str:
    # Whether effects of quantities add up
    first, total = data["first_index"].values, data["total_index"].values
    varies = data["known_figure_deviation"].values > 0
    if not varies.any():
        return ""
    alone = float(np.mean(first[varies].sum(axis=1)))
    if alone > 0.9 or float(np.mean(total[varies].sum(axis=1))) < 1.1:
        return "Here the quantities act almost independently: shares add up to 100 %."
    return (
        f"Here the shares of single quantities add up to {100 * alone:.0f} % on"
        " average; the rest arises where several deviate at once."
    )


def _intervals(data: xr.Dataset) -> Markup:
    # For each figure in %: range of 90 % and 50 % of the draws, and value of the model
    chosen = [
        k
        for k in range(data.sizes["known_figure"])
        if str(data["known_figure_unit"].values[k]) == "%"
    ]
    marks, high = [], 24.0 + _ROW * len(chosen)
    for share in range(0, 101, 20):
        x = _across(share)
        line = f"M{x:.1f},18V{high:.0f}"
        marks.append(element("path", d=line, stroke="#d9dde2"))
        marks.append(element("text", f"{share} %", x=x, y=12, text_anchor="middle"))
    words = []
    for row, k in enumerate(chosen):
        draws = data["known_figure_draws"].values[k]
        ends = np.quantile(draws, [0.05, 0.25, 0.75, 0.95]).tolist()
        value = float(data["known_figure_value"].values[k])
        y = 24 + _ROW * (row + 0.5)
        name = f"{data['known_figure_name'].values[k]}"
        place = f"{data['known_figure_place'].values[k]}"
        marks += [
            *_label(name, place, y),
            _bar(ends[0], ends[3], y, 3, "#7d9db9"),
            _bar(ends[1], ends[2], y, 11, "#7d9db9"),
            element("circle", cx=f"{_across(value):.1f}", cy=y, r=4.5, fill="#b3261e"),
        ]
        words.append(
            f"{name} of {place}: {value:.1f} %, {ends[0]:.1f} to {ends[3]:.1f}"
        )
    label = "Ranges of the figures. " + "; ".join(words)
    return drawing(label, *marks, width=_WIDTH, height=high + 6)


def _label(name: str, place: str, y: float) -> list[Markup]:
    return [
        element("text", _short(name), x=0, y=f"{y - 1:.0f}"),
        element("text", _short(place), x=0, y=f"{y + 11:.0f}", fill="#8a939d"),
    ]


def _short(words: str, most: int = 42) -> str:
    return words if len(words) <= most else f"{words[: most - 1]}…"


def _across(share: float) -> float:
    return _LEFT + (_WIDTH - _LEFT - 18) * min(max(share, 0), 100) / 100


def _bar(low: float, high: float, y: float, tall: float, colour: str) -> Markup:
    x = _across(low)
    width = max(_across(high) - x, 1.0)
    place = {"x": f"{x:.1f}", "y": f"{y - tall / 2:.1f}"}
    return element("rect", width=f"{width:.1f}", height=tall, fill=colour, **place)


def _shares(data: xr.Dataset) -> Markup:
    # Stacked bars of the shares of the variance, for each figure
    names, colours = _groups(data), _palette(data)
    marks, words = [], []
    count = data.sizes["known_figure"]
    for k in range(count):
        y = _ROW * (k + 0.5) + 4
        shown = np.clip(data["total_index"].values[k], 0, None)
        whole = shown.sum()
        label = str(data["known_figure_name"].values[k])
        marks += _label(label, str(data["known_figure_place"].values[k]), y)
        at = 0.0
        for name, colour, share in zip(names, colours, shown.tolist(), strict=True):
            if whole <= 0 or share <= 0:
                continue
            part = 100 * share / whole
            own = _bar(at, at + part, y, 16, colour)
            marks.append(
                element("g", element("title", f"{name}: {100 * share:.0f} %"), own)
            )
            at += part
        words.append(f"{label}: {_cause(data, k) or 'nothing'}")
    text = "Causes of the uncertainty. " + "; ".join(words)
    return drawing(text, *marks, width=_WIDTH, height=_ROW * count + 8)


def _unknowns(data: xr.Dataset) -> list[tuple[str, list[str]]]:
    # Name, value in the model, range and distribution of each quantity
    rows = []
    for k, name in enumerate(data["unknown"].values.astype(str)):
        low, high, reference = (
            float(data[f"unknown_{part}"].values[k])
            for part in ("low", "high", "reference")
        )
        shape = str(data["unknown_shape"].values[k])
        ends = f"{number(low)} to {number(high)}"
        if shape == "choice":
            ends, told = "any year", "file of the study"
        else:
            told = number(reference)
        rows.append((name, [told, ends, _SHAPES.get(shape, shape)]))
    return rows


def probabilities(data: xr.Dataset) -> list[tuple[str, list[str]]]:
    """Return standard and criterion, then space, level and its probability."""
    if "probability" not in data:
        return []
    rows = []
    for k in range(data.sizes["probable"]):
        standard, space, criterion, level = (
            str(data[f"probable_{part}"].values[k])
            for part in ("standard", "space", "criterion", "level")
        )
        chance = f"{100 * float(data['probability'].values[k]):.0f} %"
        rows.append((f"{standard}: {criterion}", [space, level, chance]))
    return rows


def _checks(data: xr.Dataset) -> list[tuple[str, list[str]]]:
    # For each figure: expanded and traced values of all checks
    if "check_traced" not in data:
        return []
    rows = []
    for k in range(data.sizes["checked_figure"]):
        unit = str(data["known_figure_unit"].values[k])
        name = str(data["known_figure_name"].values[k])
        place = str(data["known_figure_place"].values[k])
        cells = []
        for check in range(data.sizes["check"]):
            expanded = float(data["check_expanded"].values[check, k])
            traced = float(data["check_traced"].values[check, k])
            fails = bool(data["check_fails"].values[check, k])
            words = f"{number(expanded)} / {number(traced)} {unit}"
            cells.append(f"{words} (fails)" if fails else words)
        rows.append((f"{name}, {place}", cells))
    return rows
