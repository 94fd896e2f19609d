"""Figures of a comparison: scatter plots, daily curves, time series, grid maps."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clerestory.comparison.series import (
    GLARE,
    ILLUMINANCE,
    UNITS,
    group_of,
    quantity_of,
)
from clerestory.comparison.series_comparison import Comparison
from clerestory.comparison.time_alignment import Pairs
from clerestory.escaping import figure_text
from clerestory.metrics.agreement import agreement
from clerestory.report.period import evenly

# Measurements in black, simulations in colour-blind-safe colours (Okabe and Ito)
_MEASURED = "#1b1f24"
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9")
_MOST_DAYS = 6
_MOST_SCANS = 6
_WIDE_RANGE = 30.0
_TITLE: dict[str, Any] = {"loc": "left", "fontsize": 10}


def scatter_figure(comparisons: Sequence[Comparison], quantity: str) -> Figure | None:
    """Draw simulated against measured values, one panel per simulation.

    Bands mark deviations of 10 and 20 %. Returns None if no simulation has `quantity`.
    """
    panels = [(c.name, _pairs(c, quantity)) for c in comparisons]
    panels = [(name, pairs) for name, pairs in panels if pairs.measured.size]
    if not panels:
        return None
    low = min(min(p.measured.min(), max(p.simulated.min(), 1e-9)) for _, p in panels)
    high = max(max(p.measured.max(), p.simulated.max()) for _, p in panels)
    wide = high > _WIDE_RANGE * low and quantity not in GLARE
    ends = np.array([low / 1.2 if wide else 0.0, high * (1.2 if wide else 1.05)])
    figure = Figure(figsize=(4.4 * len(panels) + 0.4, 4.6), layout="constrained")
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for number, ((name, pairs), panel) in enumerate(zip(panels, axes, strict=True)):
        panel.fill_between(ends, 0.8 * ends, 1.2 * ends, color="#eceff2", lw=0)
        panel.fill_between(ends, 0.9 * ends, 1.1 * ends, color="#d5dbe2", lw=0)
        panel.plot(ends, ends, color=_MEASURED, lw=0.8)
        size, colour = 14 if pairs.measured.size < 300 else 5, _colour(number)
        panel.scatter(
            pairs.measured, pairs.simulated, s=size, color=colour, alpha=0.6, lw=0
        )
        scale = "log" if wide else "linear"
        panel.set(xscale=scale, yscale=scale, xlim=ends, ylim=ends, aspect="equal")
        panel.set_xlabel(f"measured {_unit(quantity)}")
        found = agreement(pairs.measured, pairs.simulated)
        panel.set_title(
            f"{figure_text(name)}: bias {100 * found.relative_bias:+.0f} %, CV(RMSE)"
            f" {100 * found.variation:.0f} %, r {found.correlation:.2f}",
            **_TITLE,
        )
    axes[0].set_ylabel(f"simulated {_unit(quantity)}")
    return figure


def days_figure(comparisons: Sequence[Comparison], name: str) -> Figure:
    """Draw the daily curves of one series, measured and simulated."""
    found = [
        (figure_text(c.name), c.pairs.of(name))
        for c in comparisons
        if name in c.pairs.names
    ]
    times = np.concatenate([pairs.times for _, pairs in found])
    days, counts = np.unique(times.astype("datetime64[D]"), return_counts=True)
    # Evenly spaced days, each with at least 60 % of the values of the fullest day
    days = days[counts >= max(1, 0.6 * counts.max())]
    days = days[evenly(len(days), _MOST_DAYS)]
    columns = min(len(days), 3)
    rows = -(-len(days) // columns)
    size = (3.7 * columns + 0.4, 2.6 * rows + 0.5)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for panel in panels.flat[len(days) :]:
        panel.set_visible(False)
    for day, panel in zip(days, panels.flat, strict=False):
        for number, (label, pairs) in enumerate(found):
            part = pairs.where(pairs.times.astype("datetime64[D]") == day)
            _draw_day(panel, part, label=label, number=number)
        panel.set_title(str(day), **_TITLE)
        panel.set_xlabel("hour, local standard time")
        panel.grid(lw=0.3)
    _finish(figure, panels[0, 0], quantity_of(name))
    figure.suptitle(figure_text(name), x=0.01, ha="left", fontsize=11)
    return figure


def time_figure(comparisons: Sequence[Comparison], group: str, quantity: str) -> Figure:
    """Plot the mean of a group of sensors over time, without gaps such as nights."""
    figure = Figure(figsize=(10.5, 3.2), layout="constrained")
    axes = figure.subplots()
    drawn = [_means(_pairs(c, quantity, group)) for c in comparisons]
    stamps = np.unique(np.concatenate([times for times, _, _ in drawn]))
    marker = "o" if len(stamps) < 100 else ""
    style: dict[str, Any] = {"lw": 0.9, "marker": marker, "ms": 3.5}
    for number, (times, measured, simulated) in enumerate(drawn):
        place, lines = _by_day(times, stamps, [measured, simulated])
        if number == 0:
            axes.plot(place, lines[0], color=_MEASURED, label="measured", **style)
        name = figure_text(comparisons[number].name)
        axes.plot(place, lines[1], color=_colour(number), label=name, **style)
    _mark_days(axes, stamps)
    axes.set_title(f"{figure_text(group)}: mean over its series at each time", **_TITLE)
    axes.grid(lw=0.3, axis="y")
    _finish(figure, axes, quantity)
    return figure


def _finish(figure: Figure, axes: Axes, quantity: str) -> None:
    axes.set_ylim(bottom=0)
    axes.set_ylabel(_unit(quantity))
    style: dict[str, Any] = {"frameon": False, "fontsize": 8, "ncols": 4}
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", **style)


def scan_figure(
    comparison: Comparison, group: str, places: dict[str, Float[np.ndarray, " 3"]]
) -> Figure | None:
    """Draw maps of a sensor grid at several times: measured, simulated and deviation.

    `places` are the positions [m] of the sensors by name. Returns None if no hour has
    nine measurements.
    """
    pairs = _pairs(comparison, ILLUMINANCE, group)
    stamps, counts = np.unique(pairs.times.astype("datetime64[h]"), return_counts=True)
    stamps = stamps[counts >= 9]
    if not len(stamps):
        return None
    stamps = stamps[evenly(len(stamps), _MOST_SCANS)]
    spots = np.array([places[name] for name in pairs.names])
    if np.isnan(spots).any():
        return None
    tall = np.ptp(spots[:, 1]) / max(np.ptp(spots[:, 0]), 0.1)
    height = float(np.clip(1.75 * tall, 1.1, 2.6))
    size = (1.9 * len(stamps) + 1.2, 3 * height + 1)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(3, len(stamps), squeeze=False)
    limits = np.percentile(np.concatenate([pairs.measured, pairs.simulated]), [2, 98])
    for column, stamp in enumerate(stamps):
        part = pairs.where(pairs.times.astype("datetime64[h]") == stamp)
        where = spots[part.series]
        change = 100 * (part.simulated / part.measured - 1)
        shown = (part.measured, part.simulated, change)
        for row, panel in enumerate(panels[:, column]):
            drawn = _map(panel, where, shown[row], limits if row < 2 else (-100, 100))
            if column == len(stamps) - 1 and row in (0, 2):
                label = "lux" if row == 0 else "deviation [%]"
                side = panels[:2, :] if row == 0 else panels[2, :]
                figure.colorbar(drawn, ax=side, label=label, fraction=0.04)
        middle = part.times[len(part.times) // 2].astype("datetime64[m]")
        panels[0, column].set_title(str(middle).replace("T", "\n"), fontsize=9)
    for row, word in enumerate(("measured", figure_text(comparison.name), "deviation")):
        panels[row, 0].set_ylabel(word, fontsize=9)
    return figure


def _map(
    panel: Axes, where: np.ndarray, values: np.ndarray, limits: tuple[float, float]
) -> Any:
    drawn = panel.scatter(
        where[:, 0],
        where[:, 1],
        c=values,
        s=42,
        marker="s",
        cmap="RdBu_r" if limits[0] < 0 else "viridis",
        vmin=limits[0],
        vmax=limits[1],
        lw=0,
    )
    panel.set(xticks=[], yticks=[], aspect="equal")
    panel.margins(0.12)
    return drawn


def _draw_day(panel: Axes, part: Pairs, *, label: str, number: int) -> None:
    day = part.times.astype("datetime64[D]")
    hour = (part.times - day) / np.timedelta64(3600, "s")
    marker = "o" if len(hour) < 40 else ""
    style: dict[str, Any] = {"marker": marker, "ms": 3, "lw": 1.1}
    if number == 0:
        panel.plot(hour, part.measured, color=_MEASURED, label="measured", **style)
    panel.plot(hour, part.simulated, color=_colour(number), label=label, **style)
    if len(hour) and not np.isnan(part.error).any():
        low, high = part.simulated - part.error, part.simulated + part.error
        panel.fill_between(hour, low, high, color=_colour(number), alpha=0.25, lw=0)


def _pairs(comparison: Comparison, quantity: str, group: str | None = None) -> Pairs:
    # Measured and simulated values of one quantity, of one or all groups of sensors
    pairs = comparison.pairs
    chosen = [
        quantity_of(name) == quantity and group in (None, group_of(name))
        for name in pairs.names
    ]
    return pairs.where(np.array(chosen)[pairs.series])


def _means(pairs: Pairs) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    times, to = np.unique(pairs.times, return_inverse=True)
    count = np.bincount(to)
    measured = np.bincount(to, pairs.measured) / count
    return times, measured, np.bincount(to, pairs.simulated) / count


def _by_day(
    times: np.ndarray, stamps: np.ndarray, lines: list[np.ndarray]
) -> tuple[np.ndarray, list[np.ndarray]]:
    # Axis positions count the time steps; NaN values interrupt lines between days
    day = times.astype("datetime64[D]").astype(int)
    cuts = np.flatnonzero(np.diff(day)) + 1
    days = np.unique(stamps.astype("datetime64[D]").astype(int))
    place = np.searchsorted(stamps, times) + np.searchsorted(days, day)
    broken = [np.insert(line, cuts, np.nan) for line in (place.astype(float), *lines)]
    return broken[0], broken[1:]


def _mark_days(axes: Axes, stamps: np.ndarray) -> None:
    days, first = np.unique(stamps.astype("datetime64[D]"), return_index=True)
    places = first + np.arange(len(days))
    chosen = evenly(len(days), 8)
    axes.set_xticks(places[chosen], [str(day) for day in days[chosen]], ha="left")
    if len(days) <= 40:
        for place in places[1:]:
            axes.axvline(place - 1, color="#c9d0d8", lw=0.6)


def _unit(quantity: str) -> str:
    word = quantity.upper() if len(quantity) == 3 else quantity
    return f"{word} [{UNITS[quantity]}]" if UNITS[quantity] else word


def _colour(number: int) -> str:
    return _COLOURS[number % len(_COLOURS)]
