"""Figures of the BSDFs of one or more layers: angular distribution, transmittance.

Discs show exit directions as seen from the room; the radius is the polar angle. A ring
marks the direction of undeviated transmission or mirror reflection.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.checks import require, within
from clerestory.escaping import figure_text
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.report.figure_axes import (
    colour_bar,
    disc_place,
    draw_disc,
    log_norm,
    mark_undeviated,
    polar_degrees,
)

_PIXELS = 480
_DECADES = 5

# Smallest end of the colour scale [1/sr], so that opaque layers are drawn dark; a
# diffuser of this value transmits 0.3 %
_LEAST_TOP = 1e-3
_LINE: dict[str, Any] = {"color": "white", "linewidth": 0.35, "alpha": 0.35}

# Interval of incidence angle in curves of transmittance or reflectance [°].
_CURVE_DEG = 2.5

# Columns of the legend below the curves
_LEGEND_COLUMNS = 4


def patch_direction(patch: int, function: Function) -> Float[np.ndarray, "3"]:
    """Direction to the source for one incident patch of the full Klems basis."""
    centres = klems("full").centres()
    within(patch, "patch", least=0, most=len(centres) - 1)
    # Undeviated light leaves towards the patch centre, mirrored if it goes outdoors
    signs = (-1.0, -1.0, -1.0 if function.endswith("front") else 1.0)
    return np.asarray(centres[patch] * signs)


def direction_from_angles(
    theta_deg: float, phi_deg: float, function: Function
) -> Float[np.ndarray, "3"]:
    """Direction to a source with the given polar angle and azimuth.

    Seen from the room, azimuth 0° is to the right and 90° is up.
    """
    require(
        0 <= theta_deg < 90,
        f"polar angle is {theta_deg}°; an angle from 0° to below 90° expected",
    )
    theta, phi = np.radians([theta_deg, phi_deg])
    flat = np.sin(theta) * np.array([np.cos(phi), np.sin(phi)])
    z = -np.cos(theta) if function.endswith("front") else np.cos(theta)
    return np.array([*flat, z])


def lobe_figure(
    bsdfs: Sequence[Bsdf],
    directions: Sequence[Float[np.ndarray, "3"]],
    *,
    function: Function = "transmission_front",
    channel: str = "visible",
    names: Sequence[str] = (),
) -> Figure:
    """Draw the BSDF of each layer (columns) for each incident direction (rows).

    All discs share one logarithmic colour scale of at most five decades, which ends at
    0.001/sr or above: layers that transmit or reflect nothing are dark.
    """
    leaving, inside = _disc(function)
    rows = [
        [
            bsdf.evaluate(np.broadcast_to(d, leaving.shape), leaving, channel=channel)
            for bsdf in bsdfs
        ]
        for d in directions
    ]
    for bsdf in bsdfs:
        bsdf.function(function, channel=channel)
    norm = log_norm(
        np.array(rows)[..., inside],
        decades=_DECADES,
        quantile=0.01,
        least_top=_LEAST_TOP,
    )
    size = (3.3 * len(bsdfs) + 1.1, 3.5 * len(directions) + 0.5)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(directions), len(bsdfs), squeeze=False)
    given = list(names) or [bsdf.product.name for bsdf in bsdfs]
    titles = [figure_text(name) for name in given]
    for k, (direction, row) in enumerate(zip(directions, rows, strict=True)):
        for panel, bsdf, title, values in zip(axes[k], bsdfs, titles, row, strict=True):
            draw_disc(panel, np.where(inside, values, np.nan), norm)
            _draw_patches_or_rings(panel, bsdf.scattering(function, channel=channel))
            mark_undeviated(panel, -disc_place(direction))
            panel.set(xticks=[], yticks=[], frame_on=False)
            (share,) = bsdf.hemispherical(
                direction[None], function=function, channel=channel
            )
            head = f"{title}\n" if k == 0 else ""
            panel.set_title(f"{head}{share:.3f} in all directions", fontsize=9)
        axes[k, 0].set_ylabel(_source_words(direction), fontsize=9)
    label = f"{channel} {function.replace('_', ' ')} [1/sr]"
    colour_bar(figure, axes.flat, norm, label)
    return figure


def share_figure(
    bsdfs: Sequence[Bsdf],
    *,
    function: Function = "transmission_front",
    channel: str = "visible",
    names: Sequence[str] = (),
) -> Figure:
    """Plot direct-hemispherical transmittance or reflectance by angle of incidence.

    The left panel is for incidence from above and below, the right one from the sides.
    """
    rows = -(-len(bsdfs) // _LEGEND_COLUMNS)
    figure = Figure(figsize=(8.4, 3.5 + 0.2 * rows), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    angle = np.arange(-87.5, 88, _CURVE_DEG)
    given = list(names) or [bsdf.product.name for bsdf in bsdfs]
    titles = [figure_text(name) for name in given]
    for panel, azimuth, ends in (
        (panels[0], 90.0, "from below | from above"),
        (panels[1], 0.0, "from the left | from the right"),
    ):
        sources = np.array(
            [
                direction_from_angles(abs(a), azimuth + 180 * (a < 0), function)
                for a in angle
            ]
        )
        for bsdf, title in zip(bsdfs, titles, strict=True):
            share = bsdf.hemispherical(sources, function=function, channel=channel)
            panel.plot(angle, share, drawstyle="steps-mid", label=title, linewidth=1.4)
        panel.set_xlabel(f"angle of the source to the normal [°]\n{ends}", fontsize=8)
        panel.set_xlim(-90, 90)
        panel.set_xticks(range(-90, 91, 30))
        panel.grid(alpha=0.25)
    panels[0].set_ylim(bottom=0)
    panels[0].set_ylabel(f"{channel}, {function.replace('_', ' ')}", fontsize=9)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(
        *(handles, labels),
        loc="outside lower center",
        ncols=min(len(labels), _LEGEND_COLUMNS),
        fontsize=8,
        frameon=False,
    )
    return figure


def _disc(function: Function) -> tuple[Float[np.ndarray, "row column 3"], np.ndarray]:
    # Exit direction of each pixel, row 0 at the bottom, and whether it is on the disc
    line = (np.arange(_PIXELS) + 0.5) / _PIXELS * 2 - 1
    x, y = np.meshgrid(line, line)
    radius = np.hypot(x, y)
    theta = np.minimum(radius, 1) * np.pi / 2
    scale = np.sin(theta) / np.maximum(radius, 1e-9)
    to_room = function in ("transmission_front", "reflection_back")
    z = np.maximum(np.cos(theta), 1e-6) * (1 if to_room else -1)
    return np.stack([x * scale, y * scale, z], axis=-1), radius < 1


def _draw_patches_or_rings(axes: Axes, part: ScatteringFunction) -> None:
    # Draw the rim, and patch outlines (matrix) or circles at 30° and 60° (tensor tree)
    if isinstance(part, ScatteringMatrix):
        _draw_patches(axes, part.exits)
    else:
        _draw_rings(axes, np.radians([30.0, 60.0]))
    _draw_rings(axes, np.array([np.pi / 2]), color="black", alpha=1.0, linewidth=0.6)


def _draw_patches(axes: Axes, partition: RingPartition) -> None:
    theta = np.degrees(partition.theta)
    _draw_rings(axes, partition.theta)
    for low, high, count in zip(theta, theta[1:], partition.count, strict=False):
        if count > 1:
            phi = (np.arange(count) + 0.5) * 2 * np.pi / count
            ends = np.array([[low], [high]])
            axes.plot(ends * np.cos(phi), ends * np.sin(phi), **_LINE)


def _draw_rings(axes: Axes, theta: Float[np.ndarray, " ring"], **style: Any) -> None:
    phi, radius = np.linspace(0, 2 * np.pi, 181)[:, None], np.degrees(theta)
    axes.plot(radius * np.cos(phi), radius * np.sin(phi), **{**_LINE, **style})


def _source_words(direction: Float[np.ndarray, "3"]) -> str:
    theta, phi = polar_degrees(direction)
    if theta < 0.5:
        return "light along the normal"
    return f"light from {theta:.0f}° off the normal,\nazimuth {phi:.0f}°"
