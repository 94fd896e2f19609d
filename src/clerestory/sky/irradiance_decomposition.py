"""Decomposition of measured irradiance into direct and diffuse components.

With the solar altitude h, GHI = DHI + DNI sin h, so two of the three determine the
third. The division by sin h amplifies errors near the horizon; therefore:

1. DNI is computed with sin h of at least sin 3°.
2. DNI is limited to the extraterrestrial irradiance; an excess of computed DNI is added
   to DHI.
3. DHI is limited to GHI.
4. Irradiance is zero with the sun more than 6° below the horizon (civil twilight).
5. If only GHI is measured, it is decomposed by the model of Erbs (hourly) or DIRINT.
"""

import importlib
import warnings
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.sky.sky_state import SOLAR_CONSTANT, orbit_factor
from clerestory.sky.solar_position import SunPosition, day_of_year

Decomposition = Literal["erbs", "dirint"]

_LOWEST_SINE = np.sin(np.radians(3.0))
_TWILIGHT = np.radians(-6.0)

# Largest violation of a limit that is not reported [W/m²]
_TOLERANCE = 5.0


@dataclass(frozen=True, eq=False)
class Irradiance:
    """Direct and diffuse irradiance, and notes on corrections.

    Attributes
    ----------
    direct_normal, diffuse_horizontal : direct normal and diffuse horizontal irradiance
        [W/m²]
    notes : corrections, with numbers of values
    """

    direct_normal: Float[np.ndarray, " time"]
    diffuse_horizontal: Float[np.ndarray, " time"]
    notes: tuple[str, ...] = ()


def split_irradiance(
    times: np.ndarray,
    sun: SunPosition,
    *,
    global_horizontal: Float[np.ndarray, " time"] | None = None,
    diffuse_horizontal: Float[np.ndarray, " time"] | None = None,
    direct_normal: Float[np.ndarray, " time"] | None = None,
    decomposition: Decomposition = "erbs",
) -> Irradiance:
    """Return direct normal and diffuse horizontal irradiance [W/m²].

    Parameters
    ----------
    times : centres of the steps
    sun : solar position at the steps
    global_horizontal, diffuse_horizontal, direct_normal : measured irradiance
        [W/m²]: global alone, or any two; if all three are given, global is ignored
    decomposition : model that decomposes global irradiance if it alone is measured
    """
    notes: tuple[str, ...] = ()
    if direct_normal is not None:
        direct_normal, notes = limit_to_extraterrestrial(direct_normal, times)
    if direct_normal is not None and diffuse_horizontal is not None:
        split = Irradiance(direct_normal, diffuse_horizontal)
    elif global_horizontal is None:
        raise InputError(
            "too few irradiances; global, or any two of global, diffuse and direct"
            " expected"
        )
    elif diffuse_horizontal is not None:
        split = _from_diffuse(global_horizontal, diffuse_horizontal, times, sun)
    elif direct_normal is not None:
        level = direct_normal * np.maximum(np.sin(sun.altitude), 0)
        split = Irradiance(direct_normal, np.maximum(global_horizontal - level, 0))
    else:
        split = _decompose(global_horizontal, times, sun, decomposition)

    # Set irradiance to zero after civil twilight
    dark = sun.altitude < _TWILIGHT
    stray = dark & (split.direct_normal + split.diffuse_horizontal > _TOLERANCE)
    notes += split.notes
    if np.any(stray):
        notes += (
            f"{np.count_nonzero(stray)} steps with irradiance and the sun more than 6°"
            " below the horizon set to zero: is the time zone right?",
        )
    return Irradiance(
        np.where(dark, 0, split.direct_normal),
        np.where(dark, 0, split.diffuse_horizontal),
        notes,
    )


def limit_to_extraterrestrial(
    direct_normal: Float[np.ndarray, " time"], times: np.ndarray
) -> tuple[Float[np.ndarray, " time"], tuple[str, ...]]:
    """Return direct normal irradiance [W/m²] limited to extraterrestrial, and notes."""
    limit = SOLAR_CONSTANT * orbit_factor(day_of_year(times))
    above = direct_normal > limit + _TOLERANCE
    notes: tuple[str, ...] = ()
    if np.any(above):
        notes = (
            f"{np.count_nonzero(above)} direct values above the extraterrestrial"
            " irradiance limited to it",
        )
    return np.minimum(direct_normal, limit), notes


def _from_diffuse(
    level: Float[np.ndarray, " time"],
    diffuse: Float[np.ndarray, " time"],
    times: np.ndarray,
    sun: SunPosition,
) -> Irradiance:
    notes: tuple[str, ...] = ()
    above = diffuse > level + _TOLERANCE
    if np.any(above):
        notes = (
            f"{np.count_nonzero(above)} diffuse values above global limited to global",
        )
    diffuse = np.minimum(diffuse, level)
    sine = np.maximum(np.sin(sun.altitude), _LOWEST_SINE)
    direct = np.where(sun.altitude > 0, (level - diffuse) / sine, 0)
    direct = np.minimum(direct, SOLAR_CONSTANT * orbit_factor(day_of_year(times)))
    rest = level - direct * np.maximum(np.sin(sun.altitude), 0)
    return Irradiance(direct, np.maximum(rest, diffuse), notes)


def _decompose(
    level: Float[np.ndarray, " time"],
    times: np.ndarray,
    sun: SunPosition,
    decomposition: Decomposition,
) -> Irradiance:
    # pvlib and pandas take a second to import, so they are imported only here
    models = importlib.import_module("pvlib.irradiance")
    zenith = np.degrees(np.pi / 2 - sun.altitude)
    if decomposition == "erbs":
        parts = models.erbs(level, zenith, day_of_year(times))
        direct = np.nan_to_num(np.asarray(parts["dni"]))
    elif decomposition == "dirint":
        pd = importlib.import_module("pandas")
        index = pd.DatetimeIndex(times)
        series = pd.Series(level, index)
        with warnings.catch_warnings():
            # pvlib 0.16 uses a name that pandas 4 will remove
            warnings.simplefilter("ignore", DeprecationWarning)
            direct = models.dirint(series, pd.Series(zenith, index), index)
        direct = np.nan_to_num(direct.to_numpy())
    else:
        raise InputError(
            f"unknown decomposition {decomposition!r}; 'erbs' or 'dirint' expected"
        )
    direct = np.maximum(direct, 0)
    diffuse = level - direct * np.maximum(np.sin(sun.altitude), 0)
    return Irradiance(direct, np.maximum(diffuse, 0))
