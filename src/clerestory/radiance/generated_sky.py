"""Skies from the commands gensky and gendaylit."""

import tempfile
from datetime import datetime
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Scene
from clerestory.sky.weather import Weather

# The usual sources of a generated sky: one hemisphere above the horizon, one below
_DOMES = """
skyfunc glow sky_glow
0
0
4 1 1 1 0
sky_glow source sky
0
0
4 0 0 1 180
skyfunc glow ground_glow
0
0
4 1 1 1 0
ground_glow source ground
0
0
4 0 0 -1 180
"""

_COMMANDS = ("gensky", "gendaylit")


def sky_scene(command: str) -> Scene:
    """Return the sky, ground and sun of a command `gensky …` or `gendaylit …`.

    Raises
    ------
    InputError : another command, or unknown options

    Examples
    --------
    >>> clear = sky_scene("gensky 9 21 9:00 -a 47.27 -o -11.39 -m -15 +s")
    >>> sorted(source.name for source in clear.distant)
    ['ground', 'sky', 'sun']
    """
    if (command.split()[:1] and command.split()[0] not in _COMMANDS) or "\n" in command:
        raise InputError(
            f'sky "{command}"; a command that begins with {" or ".join(_COMMANDS)}'
            " expected"
        )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "sky.rad")
        file.write_text(f"!{command}\n{_DOMES}", encoding="utf-8")
        return read_rad(file)


def sky_at(weather: Weather, moment: datetime) -> Scene:
    """Return the Perez sky, ground and sun of weather data at one moment.

    Parameters
    ----------
    moment : local standard time; irradiances are those of the time step around it

    Raises
    ------
    InputError : the moment is outside the data, or at night
    """
    asked = np.datetime64(moment.replace(tzinfo=None), "s")
    half = np.timedelta64(round(weather.step_minutes * 30), "s")
    times = weather.times.astype("datetime64[s]")
    if len(times) and not np.any(np.abs(times - asked) <= half):
        # The months of a typical year are from different years
        within = asked - asked.astype("datetime64[Y]")
        distance = np.abs(times - (times.astype("datetime64[Y]") + within))
    else:
        distance = np.abs(times - asked)
    if not len(times) or distance.min() > half:
        raise InputError(
            f"the weather has no time step at {moment}; a moment within it expected"
        )
    step = int(np.argmin(distance))
    normal, diffuse = weather.direct_normal[step], weather.diffuse_horizontal[step]
    if diffuse <= 0:
        raise InputError(f"no light from the sky at {moment}; daytime expected")
    hour = moment.hour + moment.minute / 60 + moment.second / 3600
    return sky_scene(
        f"gendaylit {moment.month} {moment.day} {hour:.5f} -W {normal:g} {diffuse:g}"
        f" -a {weather.latitude_deg:g} -o {-weather.longitude_deg:g}"
        f" -m {-15 * weather.utc_offset_hours:g}"
    )
