"""Decomposition of measured irradiance into direct and diffuse components.

With the solar altitude h, GHI = DHI + DNI sin h, so any two of these irradiances
determine the third. The division by sin h amplifies errors near the horizon; therefore:

1. DNI is computed with sin h of at least sin 3°.
2. DNI is limited to the extraterrestrial irradiance; an excess of computed DNI is added
   to DHI.
3. DHI is limited to GHI.
4. Irradiance is zero with the sun more than 6° below the horizon (civil twilight).
5. If only GHI is measured, it is decomposed by the Erbs or the DIRINT model.
"""

import importlib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from clerestory.array_types import Series
from clerestory.checks import one_of
from clerestory.errors import InputError
from clerestory.sky.sky_state import SOLAR_CONSTANT, orbit_factor
from clerestory.sky.solar_position import SunPosition, day_of_year

Component = Literal["global_horizontal", "diffuse_horizontal", "direct_normal"]
Decomposition = Literal["erbs", "dirint"]

_LOWEST_SINE = np.sin(np.radians(3.0))
_TWILIGHT = np.radians(-6.0)

# Largest excess over a limit that is corrected without a note [W/m²]
_TOLERANCE = 5.0


@dataclass(frozen=True, eq=False)
class Irradiance:
    """Direct normal and diffuse horizontal irradiance [W/m²], and correction notes."""

    direct_normal: Series
    diffuse_horizontal: Series
    notes: tuple[str, ...] = ()


def split_irradiance(
    times: np.ndarray,
    sun: SunPosition,
    series: Mapping[Component, Series],
    *,
    decomposition: Decomposition = "erbs",
) -> Irradiance:
    """Return direct and diffuse irradiance from measured components [W/m²].

    Global irradiance is ignored if `series` has both direct and diffuse irradiance, and
    decomposed by the model `decomposition` if `series` has global irradiance alone.
    """
    direct, diffuse = series.get("direct_normal"), series.get("diffuse_horizontal")
    notes: tuple[str, ...] = ()
    if direct is not None:
        direct, notes = limit_to_extraterrestrial(direct, times)
    if direct is not None and diffuse is not None:
        split = Irradiance(direct, diffuse)
    elif "global_horizontal" not in series:
        raise InputError(
            "too few irradiances; global, or any two of global, diffuse and direct"
            " expected"
        )
    elif diffuse is not None:
        split = _from_diffuse(series["global_horizontal"], diffuse, times, sun)
    else:
        if direct is None:
            one_of(decomposition, "decomposition", choices=("erbs", "dirint"))
            model = _erbs if decomposition == "erbs" else _dirint
            direct = model(series["global_horizontal"], times, sun)
        rest = _without_direct(series["global_horizontal"], direct, sun)
        split = Irradiance(direct, np.maximum(rest, 0))

    # Set irradiance to zero with the sun more than 6° below the horizon
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
    direct_normal: Series, times: np.ndarray
) -> tuple[Series, tuple[str, ...]]:
    """Return DNI [W/m²] limited to the extraterrestrial irradiance, and notes."""
    note = "direct values above the extraterrestrial irradiance limited to it"
    return _limited(direct_normal, _extraterrestrial(times), note)


def _limited(
    values: Series, limit: Series, note: str
) -> tuple[Series, tuple[str, ...]]:
    above = np.count_nonzero(values > limit + _TOLERANCE)
    return np.minimum(values, limit), (f"{above} {note}",) if above else ()


def _extraterrestrial(times: np.ndarray) -> Series:
    return np.asarray(SOLAR_CONSTANT * orbit_factor(day_of_year(times)))


def _without_direct(level: Series, direct: Series, sun: SunPosition) -> Series:
    # Global minus direct horizontal irradiance
    return np.asarray(level - direct * np.maximum(np.sin(sun.altitude), 0))


def _from_diffuse(
    level: Series, diffuse: Series, times: np.ndarray, sun: SunPosition
) -> Irradiance:
    note = "diffuse values above global limited to global"
    diffuse, notes = _limited(diffuse, level, note)
    sine = np.maximum(np.sin(sun.altitude), _LOWEST_SINE)
    direct = np.where(sun.altitude > 0, (level - diffuse) / sine, 0)
    direct = np.minimum(direct, _extraterrestrial(times))
    rest = _without_direct(level, direct, sun)
    return Irradiance(direct, np.maximum(rest, diffuse), notes)


# pvlib and pandas take a second to import, so they are imported only here
def _erbs(level: Series, times: np.ndarray, sun: SunPosition) -> Series:
    models = importlib.import_module("pvlib.irradiance")
    parts = models.erbs(level, _zenith_deg(sun), day_of_year(times))
    return np.asarray(np.maximum(np.nan_to_num(parts["dni"]), 0))


def _dirint(level: Series, times: np.ndarray, sun: SunPosition) -> Series:
    models = importlib.import_module("pvlib.irradiance")
    pd = importlib.import_module("pandas")
    index = pd.DatetimeIndex(times)
    zenith = pd.Series(_zenith_deg(sun), index)
    with warnings.catch_warnings():
        # pvlib 0.16 uses a name that pandas 4 will remove
        warnings.simplefilter("ignore", DeprecationWarning)
        direct = models.dirint(pd.Series(level, index), zenith, index)
    return np.asarray(np.maximum(np.nan_to_num(direct.to_numpy()), 0))


def _zenith_deg(sun: SunPosition) -> Series:
    return np.asarray(np.degrees(np.pi / 2 - sun.altitude))
