"""Polar diagram of a luminaire: luminous intensity in vertical planes.

The nadir is at the bottom. Each curve is for a vertical plane: the right half is at
the given horizontal angle, the left half of the curve at the opposite angle.
"""

from collections.abc import Sequence
from textwrap import shorten
from typing import cast

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from clerestory.checks import within
from clerestory.escaping import figure_text
from clerestory.formats.photometry.luminaire import Luminaire

# Angular step along a curve [°]
_STEP_DEG = 0.5
_COLOURS = ("#c1440e", "#1f4e79", "#5f8d4e", "#8064a2")

# Largest number of characters of the luminaire's name in the title
_TITLE = 44

MOST_PLANES = len(_COLOURS)


def polar_figure(luminaire: Luminaire, *, planes_deg: Sequence[float]) -> Figure:
    """Return the polar diagram of the luminous intensity of a luminaire [cd].

    `planes_deg` are the horizontal angles of the planes [°], from +x towards +y.
    """
    within(len(planes_deg), "number of planes", least=1, most=MOST_PLANES)
    figure = Figure(figsize=(5.2, 5.6), layout="constrained")
    axes = cast(PolarAxes, figure.add_subplot(projection="polar"))
    axes.set_theta_zero_location("S")
    angle = np.radians(np.arange(-180, 180 + _STEP_DEG, _STEP_DEG))
    for plane, colour in zip(planes_deg, _COLOURS, strict=False):
        value = luminaire.candela(_directions(angle, plane))
        label = f"{plane:g}° – {(plane + 180) % 360:g}°"
        axes.plot(angle, value, color=colour, linewidth=1.8, label=label)
    grid = range(0, 360, 30)
    axes.set_thetagrids(grid, [f"{min(a, 360 - a)}°" for a in grid])
    axes.set_ylim(bottom=0)
    axes.set_rlabel_position(15)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, prune="lower"))
    axes.tick_params(labelsize=8, colors="#555555")
    axes.grid(color="#d5d5d5", linewidth=0.6)
    name = shorten(luminaire.name, _TITLE, placeholder=" …")
    axes.set_title(f"{figure_text(name)}\n{luminaire.flux():.0f} lm; intensity in cd")
    figure.legend(loc="outside lower center", ncols=len(planes_deg), frameon=False)
    return figure


def _directions(
    angle: Float[np.ndarray, " n"], plane_deg: float
) -> Float[np.ndarray, "n 3"]:
    # `angle` is from the nadir, positive in the half-plane at `plane_deg`
    turn = np.radians(plane_deg)
    side = np.sin(angle)
    return np.stack([side * np.cos(turn), side * np.sin(turn), -np.cos(angle)], axis=1)
