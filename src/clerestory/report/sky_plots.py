"""Figures of the sky dome: luminance at one time step, and annual irradiance.

The sky dome is drawn as a sun-path diagram: a plan with the zenith at the centre, north
up, east to the right, and radii linear in altitude.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter, LogLocator

from clerestory.checks import require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.directions import from_azimuth
from clerestory.escaping import figure_text
from clerestory.report.figure_axes import compass_axes, draw_year
from clerestory.report.heat_map import day_hour_grid
from clerestory.sky.point_sky import perez_point
from clerestory.sky.solar_position import SunFormula, sun_at
from clerestory.sky.weather import Weather

# Numbers of cells of the sky dome in altitude and azimuth
_ALTITUDES, _AZIMUTHS = 90, 240

# Lower limit of the colour scale, relative to the maximum luminance
_DARKEST = 1 / 300

_SUN_COLOUR = "#111111"

# Text style of the hours on the sun path
_HOUR: dict[str, Any] = {
    "xytext": (0, 7),
    "textcoords": "offset points",
    "ha": "center",
    "fontsize": 8,
    "color": "white",
    "bbox": {"boxstyle": "round,pad=0.15", "fc": "#000000a0", "ec": "none"},
}

# Smallest number of days for which sunrise and sunset are drawn
_FEWEST_DAYS = 8

_PALETTE = "inferno"
_NO_DATA = "#d9d9d9"


def dome_figure(weather: Weather, *, sun_formula: SunFormula = "spa") -> Figure:
    """Return the luminance of the Perez sky in false colour, with the sun path.

    `weather` contains a single time step.
    """
    sky = perez_point(weather, sun_formula=sun_formula)
    require(
        sky.diffuse_horizontal() > 0,
        f"no diffuse sky irradiance at {weather.times[0]}; a daytime step expected",
    )
    azimuth = np.linspace(0, 2 * np.pi, _AZIMUTHS + 1)
    altitude = np.linspace(0, np.pi / 2, _ALTITUDES + 1)
    middles = np.meshgrid(
        (azimuth[:-1] + azimuth[1:]) / 2, (altitude[:-1] + altitude[1:]) / 2
    )
    luminance = LUMINOUS_EFFICACY * sky.radiance(from_azimuth(*middles))

    figure = Figure(figsize=(7.6, 6.8), layout="constrained")
    axes = _altitude_axes(figure)
    top = float(luminance.max())
    mesh = axes.pcolormesh(
        azimuth,
        90 - np.degrees(altitude),
        luminance,
        cmap=_PALETTE,
        norm=LogNorm(max(float(luminance.min()), top * _DARKEST), top),
        rasterized=True,
    )
    bar = figure.colorbar(mesh, ax=axes, shrink=0.75, pad=0.09)
    bar.set_label("luminance [cd/m²]")
    bar.locator = LogLocator(subs=(1, 2, 5))
    bar.formatter = FuncFormatter(lambda value, _: f"{value:,.0f}")
    bar.minorticks_off()
    _sun_path(axes, weather, sun_formula)
    axes.set_title(_dome_title(weather, sky.direct_normal, sky.diffuse_horizontal()))
    return figure


def year_figure(weather: Weather) -> Figure:
    """Return annual heat maps of direct normal and diffuse horizontal irradiance.

    Lines mark sunrise and sunset.
    """
    grid = day_hour_grid(weather.times)
    figure = Figure(figsize=(11, 6.4), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    for axes, values, name in (
        (panels[0], weather.direct_normal, "direct normal"),
        (panels[1], weather.diffuse_horizontal, "diffuse horizontal"),
    ):
        axes.set_facecolor(_NO_DATA)
        top = max(float(values.max()), 1.0)
        image = draw_year(axes, grid, values, cmap=_PALETTE, vmin=0, vmax=top)
        figure.colorbar(image, ax=axes, pad=0.01).set_label(f"{name} [W/m²]")
        _sunrise_and_sunset(axes, weather, grid.dates)
        axes.set_ylabel("local standard time [h]")
    first, last = weather.times[[0, -1]].astype("datetime64[D]")
    figure.suptitle(
        f"{_place(weather)}: irradiance in steps of {weather.step_minutes:g} min,"
        f" {first} to {last}"
    )
    return figure


def _place(weather: Weather) -> str:
    return figure_text(weather.place.replace("_", " ").strip() or "unnamed place")


def _altitude_axes(figure: Figure) -> PolarAxes:
    # Rings every 15° of altitude
    axes = compass_axes(figure)
    axes.set_ylim(0, 90)
    rings = np.arange(15, 90, 15)
    labels = [f"{ring}°" for ring in rings]
    axes.set_yticks(90 - rings, labels, fontsize=8, color="white")
    axes.set_rlabel_position(0)
    axes.grid(color="white", alpha=0.35, linewidth=0.6)
    return axes


def _sun_path(axes: PolarAxes, weather: Weather, formula: SunFormula) -> None:
    # Sun path of the day with marks at full hours, and the sun at the time step
    day = weather.times[0].astype("datetime64[D]").astype("datetime64[s]")
    azimuth, zenith = _sun(weather, day + 60 * np.arange(0, 24 * 60 + 1, 5), formula)
    shown = np.where(zenith > 90, np.nan, zenith)
    axes.plot(azimuth, shown, color="white", linewidth=2.6, solid_capstyle="round")
    axes.plot(azimuth, shown, color=_SUN_COLOUR, linewidth=1.2)
    for hour in range(24):
        a, z = (values[12 * hour] for values in (azimuth, zenith))
        if z < 88:
            axes.plot(a, z, "o", color=_SUN_COLOUR, markersize=4, mec="white", mew=0.8)
            if hour % 3 == 0:
                axes.annotate(f"{hour} h", (a, z), **_HOUR)
    a, z = (values[0] for values in _sun(weather, weather.times[:1], formula))
    if z <= 90:
        axes.plot(a, z, "o", color="#ffd84d", markersize=13, mec=_SUN_COLOUR, mew=1.4)


def _sun(
    weather: Weather, times: np.ndarray, formula: SunFormula
) -> tuple[Float[np.ndarray, " time"], Float[np.ndarray, " time"]]:
    # Azimuth [rad] and zenith angle [°] of the sun
    sun = sun_at(weather.site, times, formula=formula)
    return sun.azimuth, 90 - np.degrees(sun.altitude)


def _dome_title(weather: Weather, direct: float, diffuse: float) -> str:
    moment = str(weather.times[0].astype("datetime64[m]")).replace("T", " ")
    lux = [LUMINOUS_EFFICACY * part / 1000 for part in (diffuse, direct)]
    return (
        f"{_place(weather)}, {moment} local standard time\n"
        f"sky {lux[0]:.1f} klx on the ground, sun {lux[1]:.1f} klx facing it"
    )


def _sunrise_and_sunset(axes: Axes, weather: Weather, dates: np.ndarray) -> None:
    # Contours of zero solar altitude, accurate to a few minutes
    if len(dates) < _FEWEST_DAYS:
        return
    minutes = np.arange(0, 24 * 60, 5)
    times = dates.astype("datetime64[s]")[:, None] + 60 * minutes
    _, zenith = _sun(weather, times.ravel(), "radiance")
    height = 90 - zenith.reshape(times.shape)
    axes.contour(
        np.arange(len(dates)) + 0.5,
        minutes / 60,
        height.T,
        levels=[0.0],
        colors="white",
        linewidths=0.9,
        alpha=0.8,
    )
