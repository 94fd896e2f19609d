"""Axes of figures: hemisphere as a disc, compass, year by day and hour.

Discs show directions as seen from the room; the radius is the polar angle.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.projections.polar import PolarAxes

from clerestory.report.heat_map import DayHourGrid

_PALETTE = "inferno"


def log_norm(
    values: Float[np.ndarray, "*batch"],
    *,
    decades: int,
    quantile: float,
    least_top: float = 0.0,
) -> LogNorm:
    """Return a logarithmic scale from a quantile of the positive values to the maximum.

    The scale spans at least one decade and at most `decades`, and ends at `least_top`
    or above.

    >>> dim = np.full(3, 1e-6)
    >>> norm = log_norm(dim, decades=5, quantile=0.01, least_top=1e-3)
    >>> norm.vmin, norm.vmax
    (1e-06, 0.001)
    """
    top = max(float(values.max()), least_top) or 1.0
    some = values[values > 0]
    low = float(np.quantile(some, quantile)) if some.size else top
    return LogNorm(min(max(low, top * 10.0**-decades), top / 10), top)


def draw_disc(
    axes: Axes, values: Float[np.ndarray, "row column"], norm: LogNorm
) -> None:
    """Draw an image of values on a disc, row 0 at the bottom; NaN is left blank."""
    shown = np.maximum(values, norm.vmin or 0)
    square = (-90, 90, -90, 90)
    axes.imshow(shown, norm=norm, cmap=_PALETTE, origin="lower", extent=square)


def draw_points(
    axes: Axes,
    place: Float[np.ndarray, "point 2"],
    values: Float[np.ndarray, " point"],
    norm: LogNorm,
) -> None:
    """Draw values as coloured dots on a disc, the largest values on top."""
    order = np.argsort(values)
    size = np.clip(6000 / len(place), 0.3, 12)
    shown = np.maximum(values[order], norm.vmin or 0)
    x, y = place[order].T
    axes.scatter(x, y, c=shown, s=size, norm=norm, cmap=_PALETTE, linewidths=0)


def disc_place(
    direction: Float[np.ndarray, "*points 3"],
) -> Float[np.ndarray, "*points 2"]:
    """Positions of directions on a disc [°]; directions with z < 0 are mirrored."""
    across = np.hypot(direction[..., 0], direction[..., 1])
    theta = np.degrees(np.arctan2(across, np.abs(direction[..., 2])))
    scale = theta / np.maximum(across, 1e-12)
    return np.asarray(direction[..., :2] * scale[..., None])


def polar_degrees(direction: Float[np.ndarray, "3"]) -> tuple[float, float]:
    """Polar angle from the normal, 0…90°, and azimuth, 0…360°, of a direction."""
    x, y = disc_place(direction)
    return float(np.hypot(x, y)), float(np.degrees(np.arctan2(y, x)) % 360)


def mark_undeviated(axes: Axes, place: Float[np.ndarray, "2"]) -> None:
    """Mark the direction of undeviated light by a ring."""
    axes.plot(*place, "o", markersize=9, fillstyle="none", color="#37c0ff")


def colour_bar(figure: Figure, axes: Any, norm: LogNorm, label: str) -> None:
    """Add the colour bar of one or more discs to a figure."""
    bar = figure.colorbar(
        ScalarMappable(norm, _PALETTE), ax=list(axes), shrink=0.8, extend="min"
    )
    bar.set_label(label)


def compass_axes(figure: Figure) -> PolarAxes:
    """Return polar axes with north up and east right."""
    axes: PolarAxes = figure.add_subplot(projection="polar")  # type: ignore[assignment]
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    names = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
    axes.set_xticks(np.radians(np.arange(0, 360, 45)), names)
    return axes


def draw_year(
    axes: Axes, grid: DayHourGrid, values: Float[np.ndarray, " time"], **style: Any
) -> AxesImage:
    """Draw a heat map of the year, days to the right and hours upwards."""
    axes.set_yticks(range(0, 25, 6))
    starts, _, names = zip(*grid.day_marks(), strict=True)
    axes.set_xticks(starts, names, ha="left")
    return axes.imshow(
        grid.fill(values),
        aspect="auto",
        origin="lower",
        interpolation="nearest",
        extent=(0, grid.days, 0, 24),
        **style,
    )
