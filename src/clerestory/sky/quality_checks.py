"""Quality checks of weather data: missing steps, irradiance at night, clock errors.

The clock error is the time shift that maximises the correlation of the irradiance with
the sine of the solar altitude. Over a year the uncertainty of this shift is a quarter
of an hour, except in climates with frequent morning fog or afternoon storms.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Series
from clerestory.errors import ClerestoryWarning
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.solar_position import sun_at
from clerestory.sky.weather import Weather

# Candidate time shifts [h]
_SHIFTS = np.arange(-12, 13) / 4

# Limits of the time shift, larger than the shifts caused by climate [h]; with times in
# daylight saving time, the irradiance in summer is an hour late
_LARGEST_SHIFT = 0.5
_SUMMER_LATE, _SUMMER_EARLY = -0.45, 0.65

# Smallest number of days with irradiance for an estimate of the time shift
_FEWEST_DAYS = 20

# Solar altitude at the end of twilight [rad], and threshold of irradiance [W/m²]
_BELOW = np.radians(-6.0)
_LIGHT = 20.0

_NORTHERN_SUMMER, _NORTHERN_WINTER = (5, 6, 7, 8), (11, 12, 1, 2)


@dataclass(frozen=True)
class ClockShift:
    """Time [h] by which irradiance leads the sun; positive if the logger clock is slow.

    `whole` is the shift over all time steps, `summer_less_winter` the shift in summer
    minus the shift in winter, or 0 if data of a season are missing.
    """

    whole: float
    summer_less_winter: float


def clock_shift(weather: Weather) -> ClockShift | None:
    """Return the time shift that aligns irradiance with the solar position.

    The result is None for fewer than twenty days with irradiance.
    """
    light = weather.direct_normal + weather.diffuse_horizontal
    days = np.unique(weather.times[light > _LIGHT].astype("datetime64[D]"))
    if len(days) < _FEWEST_DAYS:
        return None
    heights = np.array([_height(weather, hours) for hours in _SHIFTS])
    month = weather.times.astype("datetime64[M]").astype(int) % 12 + 1
    summer, winter = _NORTHERN_SUMMER, _NORTHERN_WINTER
    if weather.latitude_deg < 0:
        summer, winter = winter, summer
    seasons = [
        _best_shift(light[chosen], heights[:, chosen])
        for chosen in (np.isin(month, summer), np.isin(month, winter))
        if np.count_nonzero(light[chosen] > _LIGHT) > _FEWEST_DAYS
    ]
    difference = seasons[0] - seasons[1] if len(seasons) == 2 else 0.0
    return ClockShift(_best_shift(light, heights), difference)


def quality_problems(weather: Weather) -> Iterator[str]:
    """Yield a message for each problem of the weather data, with its magnitude."""
    gaps = np.diff(weather.times).astype(float) / (weather.step_minutes * 60) - 1
    missing = int(np.round(gaps[gaps > 0.5]).sum())
    if missing:
        first = weather.times[int(np.argmax(gaps > 0.5))]
        yield (
            f"{missing} time steps are missing in {np.count_nonzero(gaps > 0.5)} gaps"
            f" (first: after {first}) and are left out of sums"
        )
    light = weather.direct_normal + weather.diffuse_horizontal > _LIGHT
    odd = light & (sun_over(weather).altitude < _BELOW)
    if np.any(odd):
        yield (
            f"{np.count_nonzero(odd)} steps have more than {_LIGHT:g} W/m² with the sun"
            f" more than 6° below the horizon (first: {weather.times[np.argmax(odd)]}):"
            " are time zone and longitude right?"
        )
    yield from _clock_problems(weather)


def warn_of_clock(weather: Weather) -> None:
    """Warn if irradiance is early or late relative to the solar position."""
    for problem in _clock_problems(weather):
        warnings.warn(f"{weather.source}: {problem}", ClerestoryWarning, stacklevel=2)


def _clock_problems(weather: Weather) -> Iterator[str]:
    shift = clock_shift(weather)
    if shift is None:
        return
    if not _SUMMER_LATE <= shift.summer_less_winter <= _SUMMER_EARLY:
        yield (
            f"irradiance in summer is {_hours(shift.summer_less_winter)} relative to"
            " winter: are the times in daylight saving time?"
        )
    elif abs(shift.whole) > _LARGEST_SHIFT:
        yield (
            f"irradiance is {_hours(shift.whole)} relative to the solar position: are"
            " time zone, longitude and the meaning of the times (start, centre or end"
            " of a step) right?"
        )


def _hours(shift: float) -> str:
    return f"{abs(shift):.1f} h {'early' if shift > 0 else 'late'}"


def _height(weather: Weather, hours: float) -> Series:
    # Sine of the solar altitude, clipped at 0, at times shifted by `hours`
    later = weather.times + np.timedelta64(round(hours * 3600), "s")
    sun = sun_at(weather.site, later, formula="radiance")
    return np.asarray(np.maximum(np.sin(sun.altitude), 0))


def _best_shift(light: Series, heights: Float[np.ndarray, "shift time"]) -> float:
    # Vertex [h] of the parabola through the largest correlation and its two neighbours
    correlation = np.array([np.corrcoef(height, light)[0, 1] for height in heights])
    best = int(np.clip(np.argmax(correlation), 1, len(_SHIFTS) - 2))
    left, top, right = correlation[best - 1 : best + 2]
    bend = left - 2 * top + right
    offset = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return float(_SHIFTS[best] + 0.25 * offset)


def describe_weather(weather: Weather) -> list[tuple[str, str]]:
    """Return a summary table of weather data, as rows of label and text.

    The rows are site, times, irradiation [kWh/m²], corrections and problems.
    Irradiation is summed over the time steps in the file; missing ones are left out.
    """
    level = weather.direct_normal * np.sin(np.maximum(sun_over(weather).altitude, 0))
    first, last = weather.times[[0, -1]].astype("datetime64[m]")

    def energy(irradiance: Series) -> str:
        return f"{irradiance.sum() * weather.step_minutes / 60_000:.0f} kWh/m²"

    lit = weather.direct_normal + weather.diffuse_horizontal > 0
    length = f"{len(weather)} of {weather.step_minutes:g} min"
    rows = [
        ("place", weather.place),
        ("latitude", f"{weather.latitude_deg:.3f}° north"),
        ("longitude", f"{weather.longitude_deg:.3f}° east"),
        ("elevation", f"{weather.elevation:g} m"),
        ("time zone", f"UTC{weather.utc_offset_hours:+g} h"),
        ("time steps", f"{length}, {first} to {last}"),
        ("with light", f"{np.count_nonzero(lit)}"),
        ("direct normal", energy(weather.direct_normal)),
        ("direct horizontal", energy(level)),
        ("diffuse horizontal", energy(weather.diffuse_horizontal)),
        ("global horizontal", energy(level + weather.diffuse_horizontal)),
        ("dew point", _dew_point_text(weather)),
    ]
    if weather.illuminance is not None:
        rows.append(("illuminance", "of sun and sky, from the file"))
    rows += [("repaired", note) for note in weather.notes]
    rows += [("doubtful", problem) for problem in quality_problems(weather)]
    return rows


def _dew_point_text(weather: Weather) -> str:
    known = np.array([])
    if weather.dew_point_c is not None:
        known = weather.dew_point_c[np.isfinite(weather.dew_point_c)]
    if len(known) == 0:
        return "none; 11 °C is taken"
    text = f"{known.min():.1f} to {known.max():.1f} °C"
    missing = len(weather) - len(known)
    return text + (f", {missing} missing" if missing else "")
