"""Section on the total uncertainty: what is not known exactly, and its effect."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from clerestory.report.content import ReportContent
from clerestory.report.knowledge_drawings import intervals, shares
from clerestory.report.markup import render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure, number

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

_KINDS = {
    "reflectance": "share of the light that it reflects",
    "transmittance": "of the glass, or factor on its light",
    "dirt": "share of the light that dirt lets pass",
    "bsdf": "factor on the light through the window",
    "sky": "factor on the light of the sky",
    "sun": "factor on the light of the sun",
    "weather": "weather of a year",
}


# Probability that is not rounded to 0 or 1
_NEARLY_NONE = 0.01


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
            interval=intervals(data),
            bars=shares(data, _groups(data), _palette(data)),
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
    between = figure.range.replace(" to ", " and ")
    words = [
        f"{figure.name.capitalize()} of “{figure.place}” is {value:.1f} % in the model."
        f" With all that is not known exactly it is between {between} in nine of"
        f" ten cases. {compared}"
    ]
    if cause:
        words.append(
            f"The largest part comes from {cause}: to know the result better, measure"
            " that first. Percentages are shares of the scatter, explained below."
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
        return (
            "Here the effects of the quantities add up, and so do their shares, to"
            " about 100 %."
        )
    return (
        f"Here quantities that vary one at a time explain {100 * alone:.0f} % of the"
        " scatter on average; the rest arises where several deviate at once, and counts"
        " for each of them. Bars are drawn to the same length."
    )


def _unknowns(data: xr.Dataset) -> list[tuple[str, list[str]]]:
    # Name, value in the model, range, distribution and meaning of each quantity
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
        meaning = _KINDS[str(data["unknown_kind"].values[k])]
        rows.append((name, [told, ends, _SHAPES.get(shape, shape), meaning]))
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
        chance = _share(float(data["probability"].values[k]))
        rows.append((f"{standard}: {criterion}", [space, level, chance]))
    return rows


def _share(value: float) -> str:
    # 0 and 100 % only if it is none or all of the cases
    if 0 < value < _NEARLY_NONE:
        return "below 1 %"
    return "above 99 %" if 1 - _NEARLY_NONE < value < 1 else f"{100 * value:.0f} %"


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
