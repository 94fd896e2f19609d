"""Geometry of venetian blinds and microlouvres, horizontal or vertical.

At tilt 0 slats are perpendicular to the window. Positive tilts lower the outer edge of
horizontal slats, which blocks the sun, and turn the outer edge of vertical slats to the
left, as seen from the room. Microlouvres are woven metal screens of small bars that
block direct light at profile angles above the cut-off angle.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clerestory.array_types import Points2
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.extrusion import arc, extruded, rotated
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.bsdfgen.system_parameters import (
    Share,
    bands,
    channel_values,
    check_not_negative,
    check_positive,
)
from clerestory.errors import InputError
from clerestory.scene.model import Plastic, Polygon, Scene

# Default ratio of thickness to width for slats with two different reflectances.
_THIN = 1e-3

# Smallest ratio of the unit cell's width and height to its depth, so that few paths
# cross its sides.
_SLENDER = 8.0

_MOST_SLATS = 100_000


def venetian(
    *,
    slat_width: float,
    spacing: float,
    tilt_deg: float = 0.0,
    rise: float = 0.0,
    thickness: float = 0.0,
    reflectance: Share = 0.5,
    reflectance_below: Share | None = None,
    solar_reflectance: float | None = None,
    solar_reflectance_below: float | None = None,
    specularity: float = 0.0,
    roughness: float = 0.0,
    vertical: bool = False,
    slats: int | None = None,
    length: float | None = None,
) -> System:
    """Return the unit cell of an infinite blind, or a finite sample of a blind.

    Parameters
    ----------
    slat_width : chord of a slat [m]
    spacing : distance between slats [m]
    tilt_deg : slat angle, −90 to 90; 0 is perpendicular to the window, and positive
        angles lower the outer edge, or turn it to the left for vertical slats
    rise : height of the middle of a curved slat above its chord [m]; negative if below
    thickness : slat thickness [m]
    reflectance : reflectance of the upper side at tilt 0, or of the right side of
        vertical slats
    reflectance_below : reflectance of the opposite side; default: `reflectance`
    solar_reflectance, solar_reflectance_below : reflectances in the solar band; None
        for the visible band only
    specularity, roughness : parameters of Radiance's material `plastic`, for both sides
    vertical : whether the slats are vertical
    slats : number of slats of a finite sample; None for an infinite blind
    length : slat length of a finite sample [m]; default: number of slats × spacing

    Examples
    --------
    >>> blind = venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.48)
    >>> round(blind.area.thickness, 6), blind.area.periodic
    (0.056569, True)
    """
    check_positive(slat_width=slat_width, spacing=spacing)
    check_not_negative(thickness=thickness)
    if not -90 <= tilt_deg <= 90:
        raise InputError(f"tilt_deg = {tilt_deg}; -90 to 90 expected")
    if abs(rise) > slat_width / 2:
        raise InputError(
            f"rise = {rise}; at most half the slat width, {slat_width / 2}, expected"
        )
    below = reflectance if reflectance_below is None else reflectance_below
    solar = solar_reflectance
    solar_below = solar if solar_reflectance_below is None else solar_reflectance_below
    if solar is None and solar_below is not None:
        raise InputError(
            "solar_reflectance_below without solar_reflectance; both expected"
        )
    upper, lower = (
        Plastic(name, channel_values(what, value, band), specularity, roughness)
        for name, what, value, band in (
            ("upper", "reflectance", reflectance, solar),
            ("lower", "reflectance_below", below, solar_below),
        )
    )
    alike = bool(np.all(upper.reflectance == lower.reflectance))
    if not alike and thickness == 0:
        thickness = _THIN * slat_width

    section = _section(slat_width, rise, thickness, math.radians(tilt_deg))
    high, low = section[:, 1].max(), section[:, 1].min()
    section = section - np.array([0, high])
    depth = max(high - low, 1e-3 * slat_width)
    reach = float(np.abs(section[:, 0]).max())
    layout = (
        _cell(spacing, depth, reach)
        if slats is None
        else _sample(spacing, slats, length)
    )
    surfaces: list[Polygon] = []
    for number in range(-layout.beyond, layout.slats + layout.beyond):
        strips = extruded(
            section + np.array([(number + 0.5) * spacing, 0]),
            ends=layout.ends,
            material="upper",
            name=f"slat{number}",
            closed=thickness > 0,
        )
        surfaces += rotated(strips) if vertical else strips
    if not alike:
        surfaces = [_painted(s, len(section) // 2) for s in surfaces]
    size = layout.slats * spacing, layout.across
    return System(
        Scene(
            {"upper": upper} if alike else {"upper": upper, "lower": lower},
            tuple(surfaces),
        ),
        _area(*size, depth, vertical=vertical, periodic=slats is None),
        bands(solar=solar is not None),
        Product(
            name=_name(slat_width, spacing, tilt_deg, vertical=vertical),
            device_type="Venetian Blinds",
        ),
    )


class _Layout(NamedTuple):
    # Number of slats in the sample area; number of slats on each side of the area that
    # extend into it; width of the area; range of x that the slats cover
    slats: int
    beyond: int
    across: float
    ends: tuple[float, float]


def _cell(spacing: float, depth: float, reach: float) -> _Layout:
    count = max(1, math.ceil(_SLENDER * depth / spacing))
    beyond = math.ceil(max(0.0, reach - spacing / 2) / spacing)
    across = max(count * spacing, _SLENDER * depth)
    return _Layout(count, beyond, across, (-0.01 * across, 1.01 * across))


def _sample(spacing: float, slats: int, length: float | None) -> _Layout:
    if not (float(slats).is_integer() and 1 <= slats <= _MOST_SLATS):
        raise InputError(
            f"slats = {slats}; a whole number from 1 to {_MOST_SLATS} expected"
        )
    across = slats * spacing if length is None else length
    check_positive(length=across)
    return _Layout(int(slats), 0, across, (0.0, across))


def _section(width: float, rise: float, thickness: float, tilt: float) -> Points2:
    # Points (y, z) of a slat around its middle: the upper side from the inner to the
    # outer edge, then the lower side from the outer to the inner edge
    line = arc(width, rise)[::-1]
    lift = np.array([0, thickness / 2])
    points = line + lift
    if thickness > 0:
        points = np.concatenate([points, line[::-1] - lift])
    along, above = points.T
    y = along * np.sin(tilt) + above * np.cos(tilt)
    z = along * np.cos(tilt) - above * np.sin(tilt)
    return np.stack([y, z], axis=1)


def _painted(strip: Polygon, half: int) -> Polygon:
    number = int(strip.name.rpartition(".")[2])
    lower = number >= half
    return Polygon(strip.vertices, "lower" if lower else "upper", strip.name)


def _area(
    high: float, wide: float, depth: float, *, vertical: bool, periodic: bool
) -> SampleArea:
    low, far = np.array([0, 0, -depth]), np.array([wide, high, 0.0])
    if vertical:
        low, far = np.array([0, -wide, -depth]), np.array([high, 0, 0.0])
    return SampleArea(np.stack([low, far]), periodic)


def _name(width: float, spacing: float, tilt_deg: float, *, vertical: bool) -> str:
    kind = "Vertical" if vertical else "Horizontal"
    return (
        f"{kind} blind, slats of {width * 1e3:g} mm every {spacing * 1e3:g} mm"
        f" at {tilt_deg:g} degrees"
    )


def microlouvre(
    *,
    depth: float = 1.25e-3,
    thickness: float = 0.22e-3,
    cutoff_deg: float = 40.0,
    tilt_deg: float = 0.0,
    reflectance: Share = 0.1,
    solar_reflectance: float | None = None,
) -> System:
    """Return the unit cell of an infinite microlouvre.

    Parameters
    ----------
    depth, thickness : dimensions of a bar [m]
    cutoff_deg : profile angle above which no direct light passes
    tilt_deg : tilt of the bars; positive if the outer edge is lower
    reflectance : reflectance of the bars
    solar_reflectance : reflectance in the solar band; None for the visible band only

    Examples
    --------
    >>> louvre = microlouvre()
    >>> round(louvre.area.thickness * 1e3, 3)
    1.25
    """
    check_positive(depth=depth, thickness=thickness)
    if not (0 < cutoff_deg < 90 and abs(tilt_deg) < 90):
        raise InputError(
            f"cutoff_deg = {cutoff_deg}, tilt_deg = {tilt_deg}; a cut-off angle"
            " between 0 and 90° and a tilt between -90 and 90° expected"
        )
    louvre = venetian(
        slat_width=depth,
        spacing=_spacing(depth, thickness, math.radians(cutoff_deg), tilt_deg),
        tilt_deg=tilt_deg,
        thickness=thickness,
        reflectance=reflectance,
        solar_reflectance=solar_reflectance,
    )
    name = (
        f"Microlouvre, bars of {depth * 1e3:g} mm by {thickness * 1e3:g} mm,"
        f" cut-off {cutoff_deg:g} degrees"
    )
    return replace(louvre, product=Product(name=name))


def _spacing(depth: float, thickness: float, cutoff: float, tilt_deg: float) -> float:
    # At the cut-off angle the projections of adjacent bars along the ray just touch
    turn = cutoff + math.radians(tilt_deg)
    across = depth * abs(math.sin(turn)) + thickness * abs(math.cos(turn))
    return across / math.cos(cutoff)
