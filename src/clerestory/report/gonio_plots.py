"""Figures of goniophotometer measurements and their fits.

Discs show directions as seen from the room; the radius is the polar angle. A ring
marks the direction of undeviated light.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from clerestory.escaping import figure_text
from clerestory.gonio.angles import from_degrees, undeviated
from clerestory.gonio.cross_validation import CrossValidation
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import rotation_about_normal
from clerestory.report.figure_axes import (
    colour_bar,
    disc_place,
    draw_disc,
    draw_points,
    log_norm,
    mark_undeviated,
    polar_degrees,
)

_DECADES = 4
_PIXELS = 300
_SIZE = 3.2
_LABEL = "BSDF [1/sr]"


def fit_figure(measurement: Measurement, interpolant: Interpolant, scan: int) -> Figure:
    """Draw one scan: measured points, fitted lobes, sum of lobes, incident directions.

    `scan` is the index of the scan in the measurement.
    """
    one = measurement.scans[scan]
    lobes = _measured(interpolant, one)
    norm = log_norm(one.values, decades=_DECADES, quantile=0.02)
    figure, axes = _panels(
        f"measured: {len(one.values)} points",
        f"fitted: {len(lobes)} lobes at half of their peaks",
        f"sum of the lobes: {lobes.total:.3f} in all directions",
        f"{len(measurement.scans)} incident directions",
    )
    draw_points(axes[0], disc_place(one.leaving), one.values, norm)
    _frame(axes[0])
    _circles(axes[1], lobes)
    _surface(axes[2], lobes, norm)
    for panel in axes[:3]:
        mark_undeviated(panel, disc_place(undeviated(one.incident)))
    draw_mesh(axes[3], interpolant.network.mesh)
    isotropic = interpolant.symmetry == "isotropic"
    incident = from_degrees(one.theta_deg, 0.0) if isotropic else one.incident
    axes[3].plot(*disc_place(incident), "o", markersize=7, color="#c03020")
    colour_bar(figure, axes[:3], norm, _LABEL)
    return figure


def between_figure(
    interpolant: Interpolant, start: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"]
) -> Figure:
    """Draw the BSDF at two incident directions, and interpolated half-way between them.

    For comparison, the arithmetic mean of both BSDFs is drawn; it doubles each lobe.
    """
    middle = (start + end) / np.linalg.norm(start + end)
    ends = [interpolant.lobes(direction) for direction in (start, end)]
    mean = Lobes(
        np.concatenate([part.centre for part in ends]),
        np.concatenate([part.radius for part in ends]),
        np.concatenate([part.flux / 2 for part in ends]),
    )
    peaks = np.concatenate([part.evaluate(part.centre) for part in ends])
    norm = log_norm(peaks, decades=_DECADES, quantile=0.02)
    figure, axes = _panels(
        _source_words(start),
        "half-way: interpolated by displacement",
        _source_words(end),
        "half-way: arithmetic mean",
    )
    shown = (ends[0], interpolant.lobes(middle), ends[1], mean)
    incidents = (start, middle, end, middle)
    for panel, lobes, incident in zip(axes, shown, incidents, strict=True):
        _surface(panel, lobes, norm)
        mark_undeviated(panel, disc_place(undeviated(incident)))
    colour_bar(figure, axes, norm, _LABEL)
    return figure


def error_figure(validation: CrossValidation) -> Figure:
    """Draw cross-validation errors on discs, each scan at its incident direction."""
    scans = validation.scans
    place = disc_place(np.array([from_degrees(s.theta_deg, s.phi_deg) for s in scans]))
    quantities = {
        "error of the total flux": [abs(s.flux_error) for s in scans],
        "angle between the peaks [°]": [s.peak_deg for s in scans],
        "earth mover's distance [°]": [s.earth_mover_deg for s in scans],
        "fraction of the flux misplaced": [s.misplaced for s in scans],
    }
    rim = ["black" if s.inside else "#37c0ff" for s in scans]
    style: dict[str, Any] = {"cmap": "viridis", "edgecolors": rim, "linewidths": 0.7}
    figure, axes = _panels(*quantities)
    for panel, values in zip(axes, quantities.values(), strict=True):
        marks = panel.scatter(*place.T, c=values, s=34, **style)
        _frame(panel)
        figure.colorbar(marks, ax=panel, shrink=0.75)
    return figure


def _panels(*titles: str) -> tuple[Figure, Any]:
    # Figure with one disc per title, side by side
    size = (len(titles) * _SIZE + 0.8, _SIZE + 0.5)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(1, len(titles))
    for panel, title in zip(axes, titles, strict=True):
        panel.set_title(figure_text(title), fontsize=9)
    return figure, axes


def _source_words(direction: Float[np.ndarray, "3"]) -> str:
    theta, phi = polar_degrees(direction)
    return f"light from {theta:.0f}°, azimuth {phi:.0f}°"


def draw_mesh(axes: Axes, mesh: Mesh) -> None:
    """Draw the mesh of incident directions: vertices and edges."""
    place = disc_place(mesh.vertices)
    lines = LineCollection(list(place[mesh.edges]), colors="#888888", linewidths=0.6)
    axes.add_collection(lines)
    axes.plot(*place[np.unique(mesh.edges)].T, ".", color="black", markersize=4)
    _frame(axes)


def _measured(interpolant: Interpolant, scan: Scan) -> Lobes:
    # Lobes fitted to a scan; for isotropic samples, rotated to the scan's azimuth
    vertices = interpolant.network.mesh.vertices
    incident, turn = scan.incident, np.eye(3)
    if interpolant.symmetry == "isotropic":
        incident = from_degrees(scan.theta_deg, 0.0)
        turn = rotation_about_normal(np.radians(scan.phi_deg))
    nearest = int(np.argmax(vertices @ incident))
    return interpolant.network.lobes[nearest].transformed(turn)


def _circles(axes: Axes, lobes: Lobes) -> None:
    place, peak = disc_place(lobes.centre), lobes.peak
    radius = np.degrees(lobes.half_maximum)
    order = np.argsort(-radius)
    scale = LogNorm(max(float(peak.max()) * 10.0**-_DECADES, peak.min()), peak.max())
    circles = PatchCollection(
        [Circle((place[k, 0], place[k, 1]), radius[k]) for k in order],
        facecolors="none",
        edgecolors=ScalarMappable(scale, "viridis_r").to_rgba(peak[order]),
        linewidths=0.8,
    )
    rim = Circle((0, 0), 90, transform=axes.transData)
    axes.add_collection(circles)
    circles.set_clip_path(rim)
    _frame(axes)


def _surface(axes: Axes, lobes: Lobes, norm: LogNorm) -> None:
    line = (np.arange(_PIXELS) + 0.5) / _PIXELS * 180 - 90
    x, y = np.meshgrid(line, line)
    theta = np.hypot(x, y)
    inside = theta < 90
    phi = np.degrees(np.arctan2(y, x))
    values = np.full(x.shape, np.nan)
    values[inside] = lobes.evaluate(from_degrees(theta[inside], phi[inside]))
    draw_disc(axes, values, norm)
    _frame(axes)


def _frame(axes: Axes) -> None:
    for radius in (30, 60, 90):
        style = {"color": "black", "linewidth": 0.8 if radius == 90 else 0.25}
        axes.add_patch(Circle((0, 0), radius, fill=False, **style))
    axes.set(xlim=(-93, 93), ylim=(-93, 93), aspect="equal")
    axes.axis("off")
