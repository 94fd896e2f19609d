"""Figures of annual glare: heat map of one view, rosette of view directions."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.projections.polar import PolarAxes

from clerestory.errors import InputError
from clerestory.glare.comfort_classes import (
    EXCEEDANCE,
    LIMITS,
    exceeded_dgp,
    glare_autonomy,
    protection_level,
)
from clerestory.glare.dgp import DGP
from clerestory.glare.index import CATEGORIES
from clerestory.report.heat_map import day_hour_grid

# Colours of imperceptible to intolerable glare, which also differ in lightness
_COLOURS = ("#dce9f2", "#f6d55c", "#ed7d3a", "#9c1b2f")
_NO_DATA = "#ffffff"
_WORDS = (
    f"imperceptible, DGP to {LIMITS[0]:.2f}",
    f"perceptible, to {LIMITS[1]:.2f}",
    f"disturbing, to {LIMITS[2]:.2f}",
    f"intolerable, above {LIMITS[2]:.2f}",
)


def glare_year_figure(
    dgp: Float[np.ndarray, " time"],
    times: np.ndarray,
    *,
    use: Bool[np.ndarray, " time"] | None = None,
    title: str = "",
) -> Figure:
    """Return a heat map of the year, days to the right and hours upwards.

    Parameters
    ----------
    dgp : DGP of each time step
    times : middle of each time step
    use : time steps included in the statistics of the title; default: all

    Raises
    ------
    InputError : the numbers of time steps differ
    """
    if len(dgp) != len(times):
        raise InputError(
            f"{len(times)} times for {len(dgp)} DGPs; equal numbers expected"
        )
    grid = day_hour_grid(times)
    figure = Figure(figsize=(11, 3.9), layout="constrained")
    axes = figure.subplots()
    axes.set_facecolor(_NO_DATA)
    axes.imshow(
        grid.fill(dgp),
        aspect="auto",
        origin="lower",
        interpolation="nearest",
        cmap=ListedColormap(_COLOURS),
        norm=BoundaryNorm([0, *LIMITS, 1.0001], len(_COLOURS)),
        extent=(0, grid.days, 0, 24),
    )
    axes.set(yticks=range(0, 25, 6), ylabel="hour of the day")
    starts, names = _months(grid.dates)
    axes.set_xticks(starts, names, ha="left")
    axes.set_title(_title(dgp if use is None else dgp[use], title), loc="left")
    _legend(figure, len(CATEGORIES))
    return figure


def _months(dates: np.ndarray) -> tuple[list[int], list[str]]:
    month = dates.astype("datetime64[M]")
    first = np.flatnonzero(np.append(True, month[1:] != month[:-1]))
    names = [str(dates[i].astype(object).strftime("%b")) for i in first]
    return first.tolist(), names


def _title(dgp: np.ndarray, title: str) -> str:
    top = float(exceeded_dgp(dgp))
    level = protection_level(top)
    words = (
        f"DGP {top:.2f} is exceeded in {EXCEEDANCE * 100:.0f} % of the time"
        f" (EN 17037: {'no' if level == 'none' else level} protection);"
        f" glare autonomy {float(glare_autonomy(dgp)) * 100:.0f} %"
    )
    return f"{title}: {words}" if title else words


def _legend(figure: Figure, columns: int) -> None:
    patches = [Patch(color=c, label=w) for c, w in zip(_COLOURS, _WORDS, strict=True)]
    figure.legend(
        handles=patches, loc="outside lower center", ncols=columns, frameon=False
    )


def glare_rosette_figure(
    dgp: Float[np.ndarray, "view time"],
    azimuth: Float[np.ndarray, " view"],
    *,
    title: str = "",
) -> Figure:
    """Return a polar plot of time fractions by glare category and view direction.

    Parameters
    ----------
    dgp : DGP of each view in the occupied time steps
    azimuth : azimuths of the view directions, clockwise from north [rad]

    Raises
    ------
    InputError : the numbers of views differ
    """
    if dgp.shape[0] != azimuth.size:
        raise InputError(
            f"{azimuth.size} azimuths for {dgp.shape[0]} views; equal numbers expected"
        )
    count = len(CATEGORIES)
    group = DGP.category(dgp)
    share = np.stack([(group == i).mean(axis=1) for i in range(count)])
    figure = Figure(figsize=(6.4, 7.0), layout="constrained")
    axes: PolarAxes = figure.add_subplot(projection="polar")  # type: ignore[assignment]
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    width = 0.86 * 2 * np.pi / max(azimuth.size, 4)
    # The worst category is at the centre, where views are easily compared
    inner = np.zeros(azimuth.size)
    for i in reversed(range(count)):
        axes.bar(azimuth, share[i], width, bottom=inner, color=_COLOURS[i])
        inner = inner + share[i]
    for angle, top in zip(azimuth, exceeded_dgp(dgp), strict=True):
        axes.text(angle, 1.1, f"{top:.2f}", ha="center", va="center", fontsize=9)
    axes.set_ylim(0, 1.0)
    axes.set_yticks([0.25, 0.5, 0.75, 1.0], ["25 %", "50 %", "75 %", ""], fontsize=8)
    axes.set_xticks(np.radians(np.arange(0, 360, 45)))
    axes.set_xticklabels(["N", "NE", "E", "SE", "S", "SW", "W", "NW"])
    axes.tick_params(axis="x", pad=26)
    axes.grid(alpha=0.4, linewidth=0.6)
    axes.set_axisbelow(False)
    words = f"share of time; rim: DGP exceeded in {EXCEEDANCE * 100:.0f} % of it"
    axes.set_title(f"{title}\n{words}" if title else words, pad=24)
    _legend(figure, 2)
    return figure
