"""Figures of goniophotometer measurements and their fits.

Discs are seen from the room, with right and up as in the room and the angle to the
normal as distance from the centre. The ring marks the undeviated direction.
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

from clerestory.gonio.angles import from_degrees, undeviated
from clerestory.gonio.cross_validation import CrossValidation
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import rotation_about_normal

_PALETTE = "inferno"
_DECADES = 4
_PIXELS = 300
_SIZE = 3.2
_LABEL: dict[str, Any] = {"fontsize": 9}


def fit_figure(measurement: Measurement, interpolant: Interpolant, scan: int) -> Figure:
    """Draw a scan: measured points, fitted lobes, sum of lobes, incident directions.

    Parameters
    ----------
    scan : number of the scan to draw
    """
    one = measurement.scans[scan]
    lobes = _measured(interpolant, one)
    norm = _norm(one.values)
    figure = Figure(figsize=(4 * _SIZE + 0.8, _SIZE + 0.5), layout="constrained")
    axes = figure.subplots(1, 4)
    _points(axes[0], one, norm)
    _title(axes[0], f"measured: {len(one.values)} points")
    _circles(axes[1], lobes)
    _title(axes[1], f"fitted: {len(lobes)} lobes at half their peak")
    _surface(axes[2], lobes, norm)
    _title(axes[2], f"their sum: {lobes.total:.3f} in all")
    for panel in axes[:3]:
        _straight(panel, one.incident)
    draw_mesh(axes[3], interpolant.network.mesh)
    isotropic = interpolant.symmetry == "isotropic"
    _mark(axes[3], from_degrees(one.theta_deg, 0.0) if isotropic else one.incident)
    _title(axes[3], f"{len(measurement.scans)} incident directions")
    _bar(figure, axes[:3], norm)
    return figure


def between_figure(
    interpolant: Interpolant,
    start: Float[np.ndarray, "3"],
    end: Float[np.ndarray, "3"],
) -> Figure:
    """Draw the BSDF at two incident directions, and interpolated half-way between them.

    For comparison, the arithmetic mean of both BSDFs is drawn; it has every lobe twice.
    """
    middle = (start + end) / np.linalg.norm(start + end)
    ends = [interpolant.lobes(direction) for direction in (start, end)]
    between = interpolant.lobes(middle)
    mean = Lobes(
        np.concatenate([part.centre for part in ends]),
        np.concatenate([part.radius for part in ends]),
        np.concatenate([part.flux / 2 for part in ends]),
    )
    norm = _norm(np.concatenate([part.evaluate(part.centre) for part in ends]))
    figure = Figure(figsize=(4 * _SIZE + 0.8, _SIZE + 0.5), layout="constrained")
    axes = figure.subplots(1, 4)
    panels = (
        (ends[0], start, f"light from {_words(start)}"),
        (between, middle, "half-way: displaced"),
        (ends[1], end, f"light from {_words(end)}"),
        (mean, middle, "half-way: plain mean, two images"),
    )
    for panel, (lobes, incident, title) in zip(axes, panels, strict=True):
        _surface(panel, lobes, norm)
        _straight(panel, incident)
        _title(panel, title)
    _bar(figure, axes, norm)
    return figure


def error_figure(validation: CrossValidation) -> Figure:
    """Draw the cross-validation errors of scans over their incident directions."""
    scans = validation.scans
    x, y = np.array([_disc(from_degrees(s.theta_deg, s.phi_deg)) for s in scans]).T
    quantities = (
        ("error of the total flux", [abs(s.flux_error) for s in scans]),
        ("angle between the beams [°]", [s.peak_deg for s in scans]),
        ("earth mover's distance [°]", [s.earth_mover_deg for s in scans]),
        ("share of the light elsewhere", [s.misplaced for s in scans]),
    )
    figure = Figure(figsize=(4 * _SIZE + 0.8, _SIZE + 0.5), layout="constrained")
    axes = figure.subplots(1, 4)
    for panel, (name, values) in zip(axes, quantities, strict=True):
        rim = ["black" if s.inside else "#37c0ff" for s in scans]
        marks = panel.scatter(
            x, y, c=values, s=34, cmap="viridis", edgecolors=rim, linewidths=0.7
        )
        _frame(panel)
        _title(panel, name)
        figure.colorbar(marks, ax=panel, shrink=0.75)
    return figure


def draw_mesh(axes: Axes, mesh: Mesh) -> None:
    """Draw incident directions and the edges between them."""
    place = _disc(mesh.vertices)
    lines = LineCollection(list(place[mesh.edges]), colors="#888888", linewidths=0.6)
    axes.add_collection(lines)
    axes.plot(*place[np.unique(mesh.edges)].T, ".", color="black", markersize=4)
    _frame(axes)


def _measured(interpolant: Interpolant, scan: Scan) -> Lobes:
    # Fitted lobes; those of isotropic samples are rotated to the azimuth of the scan
    vertices = interpolant.network.mesh.vertices
    incident, turn = scan.incident, np.eye(3)
    if interpolant.symmetry == "isotropic":
        azimuth = np.radians(scan.phi_deg)
        incident, turn = (
            from_degrees(scan.theta_deg, 0.0),
            rotation_about_normal(azimuth),
        )
    nearest = int(np.argmax(vertices @ incident))
    return interpolant.network.lobes[nearest].transformed(turn)


def _disc(direction: Float[np.ndarray, "*points 3"]) -> Float[np.ndarray, "*points 2"]:
    # Angle to the normal [°] as distance from the centre
    flat = np.hypot(direction[..., 0], direction[..., 1])
    theta = np.degrees(np.arctan2(flat, direction[..., 2]))
    scale = theta / np.maximum(flat, 1e-12)
    return np.asarray(direction[..., :2] * scale[..., None])


def _norm(values: Float[np.ndarray, " values"]) -> LogNorm:
    top = float(values.max())
    some = values[values > 0]
    low = float(np.quantile(some, 0.02)) if some.size else top
    return LogNorm(min(max(low, top * 10.0**-_DECADES), top / 10), top)


def _points(axes: Axes, scan: Scan, norm: LogNorm) -> None:
    order = np.argsort(scan.values)
    place = _disc(scan.leaving[order])
    size = np.clip(6000 / len(place), 0.3, 12)
    shown = np.maximum(scan.values[order], norm.vmin or 0)
    x, y = place.T
    axes.scatter(x, y, c=shown, s=size, norm=norm, cmap=_PALETTE, linewidths=0)
    _frame(axes)


def _circles(axes: Axes, lobes: Lobes) -> None:
    place, peak = _disc(lobes.centre), lobes.peak
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
    shown = np.where(inside, np.maximum(values, norm.vmin or 0), np.nan)
    axes.imshow(
        shown, norm=norm, cmap=_PALETTE, origin="lower", extent=(-90, 90, -90, 90)
    )
    _frame(axes)


def _straight(axes: Axes, incident: Float[np.ndarray, "3"]) -> None:
    place = _disc(undeviated(incident))
    axes.plot(*place, "o", markersize=9, fillstyle="none", color="#37c0ff")


def _mark(axes: Axes, incident: Float[np.ndarray, "3"]) -> None:
    axes.plot(*_disc(incident), "o", markersize=7, color="#c03020")


def _frame(axes: Axes) -> None:
    for radius in (30, 60, 90):
        style = {"color": "black", "linewidth": 0.8 if radius == 90 else 0.25}
        axes.add_patch(Circle((0, 0), radius, fill=False, **style))
    axes.set_xlim(-93, 93)
    axes.set_ylim(-93, 93)
    axes.set_aspect("equal")
    axes.axis("off")


def _bar(figure: Figure, axes: Any, norm: LogNorm) -> None:
    bar = figure.colorbar(
        ScalarMappable(norm, _PALETTE), ax=list(axes), shrink=0.8, extend="min"
    )
    bar.set_label("BSDF [1/sr]", **_LABEL)


def _title(axes: Axes, text: str) -> None:
    axes.set_title(text, **_LABEL)


def _words(direction: Float[np.ndarray, "3"]) -> str:
    theta = np.degrees(np.arctan2(np.hypot(*direction[:2]), direction[2]))
    phi = np.degrees(np.arctan2(direction[1], direction[0])) % 360
    return f"{theta:.0f}°, azimuth {phi:.0f}°"
