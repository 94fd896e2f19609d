"""What is doubtful in weather that can be used: gaps in time, wrong clocks.

The clock is judged by the light: over many days, sun and sky are as bright in the
morning as in the afternoon. The time by which the file has to be shifted for its
light to follow the height of the sun best is known to a quarter of an hour in a
year of any climate but a few; mornings with fog or afternoons with storms move it.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.errors import ClerestoryWarning
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.solar_position import sun_position
from clerestory.sky.weather import Weather

# Shifts that are tried [h]
_SHIFTS = np.arange(-12, 13) / 4

# What the climates of the world hardly reach [h]; a clock that keeps daylight saving
# time makes the light of summer an hour late
_LARGEST_SHIFT = 0.5
_SUMMER_LATE, _SUMMER_EARLY = -0.45, 0.65

# Days with light that an estimate needs
_FEWEST_DAYS = 20

# Sun this far below the horizon sends no light [rad]; light that counts [W/m²]
_BELOW = np.radians(-6.0)
_LIGHT = 20.0

_NORTHERN_SUMMER, _NORTHERN_WINTER = (5, 6, 7, 8), (11, 12, 1, 2)


@dataclass(frozen=True)
class ClockShift:
    """How far the light is off the sun of the file's times.

    Attributes
    ----------
    whole : over all steps [h], positive where clocks are slow
    summer_less_winter : difference of the seasons [h]; 0 where one is missing
    """

    whole: float
    summer_less_winter: float


def clock_shift(weather: Weather) -> ClockShift | None:
    """Return by how many hours the times would have to be later to suit the light.

    None where fewer than twenty days have light.
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


def weather_doubts(weather: Weather) -> tuple[str, ...]:
    """Return what is doubtful, a sentence each, with the size of the doubt."""
    return (*_missing_steps(weather), *_light_at_night(weather), *_clock(weather))


def warn_of_clock(weather: Weather) -> None:
    """Warn where the light comes too early or too late for the times of a file.

    Warns
    -----
    ClerestoryWarning : with the shift
    """
    for doubt in _clock(weather):
        warnings.warn(f"{weather.source}: {doubt}", ClerestoryWarning, stacklevel=2)


def _missing_steps(weather: Weather) -> tuple[str, ...]:
    # A year of forty chosen hours has gaps too, but they outnumber the steps
    step = weather.step_minutes * 60
    gaps = np.diff(weather.times).astype(float) / step - 1
    missing = int(np.round(gaps[gaps > 0.5]).sum())
    if missing == 0:
        return ()
    first = weather.times[int(np.argmax(gaps > 0.5))]
    return (
        f"{missing} time steps are missing in {np.count_nonzero(gaps > 0.5)} gaps"
        f" (first: after {first}); nothing stands for them",
    )


def _light_at_night(weather: Weather) -> tuple[str, ...]:
    light = weather.direct_normal + weather.diffuse_horizontal > _LIGHT
    odd = light & (sun_over(weather).altitude < _BELOW)
    if not np.any(odd):
        return ()
    return (
        f"{np.count_nonzero(odd)} steps have more than {_LIGHT:g} W/m² with the sun"
        f" 6° and more below the horizon (first: {weather.times[np.argmax(odd)]}):"
        " are time zone and longitude right?",
    )


def _clock(weather: Weather) -> tuple[str, ...]:
    shift = clock_shift(weather)
    if shift is None:
        return ()
    doubts: tuple[str, ...] = ()
    if not _SUMMER_LATE <= shift.summer_less_winter <= _SUMMER_EARLY:
        doubts += (
            "the light of summer is"
            f" {abs(shift.summer_less_winter):.1f} h"
            f" {'early' if shift.summer_less_winter > 0 else 'late'} against that of"
            " winter: do the times keep daylight saving time?",
        )
    elif abs(shift.whole) > _LARGEST_SHIFT:
        doubts += (
            f"the light is {abs(shift.whole):.1f} h"
            f" {'early' if shift.whole > 0 else 'late'} against the sun: are time zone,"
            " longitude and the moment that times stand for right?",
        )
    return doubts


def _height(weather: Weather, hours: float) -> Float[np.ndarray, " time"]:
    # Sine of the sun's altitude some hours later
    sun = sun_position(
        weather.times + np.timedelta64(round(hours * 3600), "s"),
        latitude_deg=weather.latitude_deg,
        longitude_deg=weather.longitude_deg,
        utc_offset_hours=weather.utc_offset_hours,
        formula="radiance",
    )
    return np.asarray(np.maximum(np.sin(sun.altitude), 0))


def _best_shift(
    light: Float[np.ndarray, " time"], heights: Float[np.ndarray, "shift time"]
) -> float:
    # Top of the parabola through the largest correlation and its neighbours
    likeness = np.array([np.corrcoef(height, light)[0, 1] for height in heights])
    best = int(np.clip(np.argmax(likeness), 1, len(_SHIFTS) - 2))
    left, top, right = likeness[best - 1 : best + 2]
    bend = left - 2 * top + right
    offset = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return float(_SHIFTS[best] + 0.25 * offset)
