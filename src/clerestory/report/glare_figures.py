"""Figures of annual glare: heat map of one view, rosette of view directions."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from clerestory.checks import same_length
from clerestory.escaping import figure_text
from clerestory.glare.comfort_classes import (
    EXCEEDANCE,
    LIMITS,
    exceeded_dgp,
    glare_autonomy,
    protection_level,
)
from clerestory.glare.dgp import DGP
from clerestory.glare.index import CATEGORIES
from clerestory.report.figure_axes import compass_axes, draw_year
from clerestory.report.heat_map import day_hour_grid
from clerestory.report.view_glare import class_words

# Colours from imperceptible to intolerable glare, distinct even in greyscale
_COLOURS = ("#dce9f2", "#f6d55c", "#ed7d3a", "#9c1b2f")


def glare_year_figure(
    dgp: Float[np.ndarray, " time"],
    times: np.ndarray,
    *,
    use: Bool[np.ndarray, " time"] | None = None,
    title: str = "",
) -> Figure:
    """Return a heat map of annual DGP, days to the right and hours upwards.

    Parameters
    ----------
    dgp : DGP of each time step
    times : middle of each time step
    use : whether each time step enters the statistics in the title; default: all do

    Raises
    ------
    InputError : `dgp` and `times` differ in length
    """
    same_length(times, dgp, "time steps", "DGP values")
    figure = Figure(figsize=(11, 3.9), layout="constrained")
    axes = figure.subplots()
    draw_year(
        axes,
        day_hour_grid(times),
        dgp,
        cmap=ListedColormap(_COLOURS),
        norm=BoundaryNorm([0, *LIMITS, 1.0001], len(_COLOURS)),
    )
    axes.set_ylabel("hour of the day")
    axes.set_title(_title(dgp if use is None else dgp[use], title), loc="left")
    _legend(figure, len(CATEGORIES))
    return figure


def _title(dgp: np.ndarray, title: str) -> str:
    top = float(exceeded_dgp(dgp))
    level = protection_level(top)
    words = (
        f"DGP {top:.2f} is exceeded in {EXCEEDANCE * 100:.0f} % of the time"
        f" (EN 17037: {'no' if level == 'none' else level} protection);"
        f" glare autonomy {float(glare_autonomy(dgp)) * 100:.0f} %"
    )
    return f"{figure_text(title)}: {words}" if title else words


def _legend(figure: Figure, columns: int) -> None:
    pairs = zip(_COLOURS, class_words(), strict=True)
    patches = [Patch(color=colour, label=words) for colour, words in pairs]
    figure.legend(
        handles=patches, loc="outside lower center", ncols=columns, frameon=False
    )


def glare_rosette_figure(
    dgp: Float[np.ndarray, "view time"],
    azimuth: Float[np.ndarray, " view"],
    *,
    title: str = "",
) -> Figure:
    """Return a polar plot: fraction of time in each glare category, by view direction.

    Parameters
    ----------
    dgp : DGP of each view in the occupied time steps
    azimuth : azimuths of the view directions, clockwise from north [rad]

    Raises
    ------
    InputError : `dgp` and `azimuth` differ in the number of views
    """
    same_length(azimuth, dgp, "azimuths", "views")
    count = len(CATEGORIES)
    group = DGP.category(dgp)
    share = np.stack([(group == i).mean(axis=1) for i in range(count)])
    figure = Figure(figsize=(6.4, 7.0), layout="constrained")
    axes = compass_axes(figure)
    width = 0.86 * 2 * np.pi / max(azimuth.size, 4)
    # Bars start with the worst category at the centre, where they are easily compared
    inner = np.zeros(azimuth.size)
    for i in reversed(range(count)):
        axes.bar(azimuth, share[i], width, bottom=inner, color=_COLOURS[i])
        inner = inner + share[i]
    for angle, top in zip(azimuth, exceeded_dgp(dgp), strict=True):
        axes.text(angle, 1.1, f"{top:.2f}", ha="center", va="center", fontsize=9)
    axes.set_ylim(0, 1.0)
    axes.set_yticks([0.25, 0.5, 0.75, 1.0], ["25 %", "50 %", "75 %", ""], fontsize=8)
    axes.tick_params(axis="x", pad=26)
    axes.grid(alpha=0.4, linewidth=0.6)
    axes.set_axisbelow(False)
    words = f"share of time; rim: DGP exceeded in {EXCEEDANCE * 100:.0f} % of it"
    axes.set_title(f"{figure_text(title)}\n{words}" if title else words, pad=24)
    _legend(figure, 2)
    return figure
