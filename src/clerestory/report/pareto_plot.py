"""Plot of light against glare of several runs, coloured by lighting energy.

A run is efficient in the sense of Pareto if no other run is at least as good in all
quantities shown and better in one of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from clerestory.image.colour_scale import ColourScale
from clerestory.report.colour import colour_bar, hexadecimal, value_colours
from clerestory.report.label_places import label_places
from clerestory.report.markup import Markup, drawing, element, join
from clerestory.report.uncertain_value import number
from clerestory.study.optimise_tables import GoalTable
from clerestory.study.variant_figures import RunFigures, VariantFigure

_WIDTH, _HEIGHT = 640.0, 400.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 58.0, 24.0, 16.0, 46.0

_RADIUS = 6
_PLAIN = "#1f4e79"

# Smallest range of an axis, in the unit of the figure
_LEAST_SPAN = 0.01


@dataclass(frozen=True, eq=False)
class Objectives:
    """Quantities that are weighed against each other, for each run.

    `across` and `up` are the axes of the plot, `colour` is shown by colour, if known.
    """

    across: list[VariantFigure]
    up: list[VariantFigure]
    colour: list[VariantFigure] | None = None

    def efficient(self) -> Bool[np.ndarray, " run"]:
        """Whether no other run is better in one quantity and as good in the others."""
        shown = [self.across, self.up, *([self.colour] if self.colour else [])]
        signs = [1 if own[0].rising else -1 for own in shown]
        return pareto_front(
            np.array(
                [
                    [sign * figure.value for figure in own]
                    for sign, own in zip(signs, shown, strict=True)
                ]
            ).T
        )


def pareto_front(values: Float[np.ndarray, "run quantity"]) -> Bool[np.ndarray, " run"]:
    """Return which runs no other run dominates; larger values are better.

    >>> pareto_front(np.array([[1.0, 3.0], [2.0, 2.0], [1.0, 2.0]])).tolist()
    [True, True, False]
    """
    as_good = (values[:, None] >= values[None]).all(axis=2)
    better = (values[:, None] > values[None]).any(axis=2)
    return np.asarray(~(as_good & better).any(axis=0))


def objectives(runs: Sequence[RunFigures]) -> Objectives | None:
    """Return light against glare and lighting energy, as far as the runs have them.

    Light is the autonomy of the first grid, glare that of the worst view in each run.
    Without views, the hours above the useful range stand for glare.
    """
    light = _first(runs, "light", 1)
    glare = [_worst(run) for run in runs]
    across = [figure for figure in glare if figure is not None]
    if len(across) < len(runs):
        across = _first(runs, "light", 3)
    if len(light) < len(runs) or len(across) < len(runs):
        return None
    energy = _first(runs, "energy", 0)
    return Objectives(across, light, energy if len(energy) == len(runs) else None)


def goal_objectives(
    runs: Sequence[RunFigures], goals: Sequence[GoalTable]
) -> Objectives | None:
    """Return the goals of an optimisation, up to three; None for a single goal."""
    found = []
    for goal in goals:
        own = next(
            figure
            for figure in runs[0].figures
            if figure.name == goal.figure
            and figure.place == (goal.place or figure.place)
        )
        rising = own.rising if goal.aim is None else goal.aim == "more"
        each = [run.of(own.key) for run in runs]
        found.append([replace(one, rising=rising) for one in each if one is not None])
    if len(found) < 2 or any(len(own) < len(runs) for own in found):
        return None
    return Objectives(found[1], found[0], found[2] if len(found) > 2 else None)


def _first(runs: Sequence[RunFigures], aspect: str, number: int) -> list[VariantFigure]:
    # The figure of an aspect that comes at a place in the first run
    own = [figure for figure in runs[0].figures if figure.aspect == aspect]
    if len(own) <= number:
        return []
    found = (run.of(own[number].key) for run in runs)
    return [figure for figure in found if figure is not None]


def _worst(run: RunFigures) -> VariantFigure | None:
    glare = [figure for figure in run.figures if figure.aspect == "glare"]
    return max(glare, key=lambda figure: figure.value, default=None)


def pareto_plot(runs: Sequence[RunFigures], shown: Objectives) -> Markup:
    """Return the plot as SVG; the runs are numbered as in the tables."""
    axes = [_range(shown.across), _range(shown.up)]
    efficient = shown.efficient()
    colours, bar = [_PLAIN] * len(runs), Markup("")
    if shown.colour:
        scale = _scale(shown.colour)
        values = np.array([figure.value for figure in shown.colour])
        colours = hexadecimal(value_colours(scale, values))
        bar = join(element("p", shown.colour[0].name, class_="note"), colour_bar(scale))
    places = [
        (_across(x.value, axes), _up(y.value, axes))
        for x, y in zip(shown.across, shown.up, strict=True)
    ]
    labels = label_places(places, radius=_RADIUS)
    dots = [
        _dot(
            k,
            runs[k].name,
            shown,
            axes,
            colours[k],
            efficient=bool(efficient[k]),
            label=labels[k],
        )
        for k in np.argsort(efficient, kind="stable").tolist()
    ]
    names = f"{shown.up[0].name} against {shown.across[0].name}"
    label = f"{names}; efficient: " + ", ".join(
        run.name for run, best in zip(runs, efficient, strict=True) if best
    )
    plot = drawing(
        label,
        _frame(shown, axes),
        *dots,
        width=_WIDTH,
        height=_HEIGHT,
        class_="pareto",
    )
    return join(plot, bar)


def _range(figures: Sequence[VariantFigure]) -> tuple[float, float]:
    # Round limits of an axis
    low = min(figure.value - figure.error for figure in figures)
    high = max(figure.value + figure.error for figure in figures)
    span = max(high - low, 0.02 * abs(high), _LEAST_SPAN)
    step = _step(span)
    least = np.floor((low - 0.04 * span) / step) * step
    most = np.ceil((high + 0.04 * span) / step) * step
    if min(figure.value for figure in figures) >= 0:
        least = max(least, 0.0)
    return float(least), float(most)


def _step(span: float) -> float:
    power = 10.0 ** np.floor(np.log10(span / 4))
    return float(next(m * power for m in (1, 2, 5, 10) if span / (m * power) <= 6))


def _scale(figures: Sequence[VariantFigure]) -> ColourScale:
    low, high = _range(figures)
    levels = tuple(np.linspace(low, high, 5).tolist())
    unit = figures[0].unit
    return ColourScale(
        low, high, levels, unit, palette="viridis", ends=(0.04, 0.92), steps=128
    )


def _place(value: float, axis: tuple[float, float], first: float, last: float) -> float:
    return first + (value - axis[0]) / (axis[1] - axis[0]) * (last - first)


def _across(value: float, axes: list[tuple[float, float]]) -> float:
    return _place(value, axes[0], _LEFT, _WIDTH - _RIGHT)


def _up(value: float, axes: list[tuple[float, float]]) -> float:
    return _place(value, axes[1], _HEIGHT - _BOTTOM, _TOP)


def _dot(
    at: int,
    name: str,
    shown: Objectives,
    axes: list[tuple[float, float]],
    colour: str,
    *,
    efficient: bool,
    label: tuple[float, float],
) -> Markup:
    across, up = shown.across[at], shown.up[at]
    x, y = _across(across.value, axes), _up(up.value, axes)
    bars = (
        f"M{_across(max(across.value - across.error, axes[0][0]), axes):.1f} {y:.1f}"
        f"H{_across(across.value + across.error, axes):.1f}"
        f"M{x:.1f} {_up(max(up.value - up.error, axes[1][0]), axes):.1f}"
        f"V{_up(up.value + up.error, axes):.1f}"
    )
    words = f"{at + 1} {name}: {number(up.value)} {up.unit}, "
    words += f"{number(across.value)} {across.unit}"
    rim = {"stroke": "#1b1f24", "stroke_width": 2.2} if efficient else {}
    return element(
        "g",
        element("title", words),
        element("path", d=bars, stroke="#8a939d", fill="none"),
        element("circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=_RADIUS, fill=colour, **rim),
        element("text", at + 1, x=f"{label[0]:.1f}", y=f"{label[1]:.1f}"),
    )


def _frame(shown: Objectives, axes: list[tuple[float, float]]) -> Markup:
    parts = []
    for value in _ticks(axes[0]):
        x = _across(value, axes)
        line = f"M{x:.1f} {_TOP}V{_HEIGHT - _BOTTOM}"
        parts += [
            element("path", d=line, stroke="#d9dde2"),
            element(
                "text",
                number(value),
                x=f"{x:.1f}",
                y=_HEIGHT - _BOTTOM + 16,
                text_anchor="middle",
            ),
        ]
    for value in _ticks(axes[1]):
        y = _up(value, axes)
        parts += [
            element("path", d=f"M{_LEFT} {y:.1f}H{_WIDTH - _RIGHT}", stroke="#d9dde2"),
            element(
                "text", number(value), x=_LEFT - 7, y=f"{y + 4:.1f}", text_anchor="end"
            ),
        ]
    middle = (_TOP + _HEIGHT - _BOTTOM) / 2
    parts += [
        element(
            "text",
            _title(shown.across[0]),
            x=(_LEFT + _WIDTH - _RIGHT) / 2,
            y=_HEIGHT - 10,
            text_anchor="middle",
        ),
        element(
            "text",
            _title(shown.up[0]),
            x=14,
            y=middle,
            text_anchor="middle",
            transform=f"rotate(-90 14 {middle})",
        ),
    ]
    return join(*parts)


def _title(figure: VariantFigure) -> str:
    better = "more" if figure.rising else "less"
    return f"{figure.name} [{figure.unit}], {better} is better"


def _ticks(axis: tuple[float, float]) -> list[float]:
    step = _step(axis[1] - axis[0])
    first = np.ceil(axis[0] / step - 1e-9) * step
    # Adding zero makes a positive zero of a negative one
    return [float(x) + 0.0 for x in np.arange(first, axis[1] + 1e-9 * step, step)]
