"""Summary of a weather file as text."""

import numpy as np
from jaxtyping import Float

from clerestory.sky.quality_checks import quality_problems
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.weather import Weather


def describe_weather(weather: Weather) -> list[tuple[str, str]]:
    """Return names and values: site, times, annual irradiation, corrections, problems.

    Sums are over the steps of the file; missing steps are not replaced.
    """
    level = weather.direct_normal * np.sin(np.maximum(sun_over(weather).altitude, 0))
    first, last = weather.times[[0, -1]].astype("datetime64[m]")

    def energy(irradiance: Float[np.ndarray, " time"]) -> str:
        return f"{irradiance.sum() * weather.step_minutes / 60_000:.0f} kWh/m²"

    lit = weather.direct_normal + weather.diffuse_horizontal > 0
    rows = [
        ("place", weather.place),
        ("latitude", f"{weather.latitude_deg:.3f}° north"),
        ("longitude", f"{weather.longitude_deg:.3f}° east"),
        ("elevation", f"{weather.elevation:g} m"),
        ("time zone", f"UTC{weather.utc_offset_hours:+g} h"),
        (
            "time steps",
            f"{len(weather)} of {weather.step_minutes:g} min, {first} to {last}",
        ),
        ("with light", f"{np.count_nonzero(lit)}"),
        ("direct normal", energy(weather.direct_normal)),
        ("direct horizontal", energy(level)),
        ("diffuse horizontal", energy(weather.diffuse_horizontal)),
        ("global horizontal", energy(level + weather.diffuse_horizontal)),
        ("dew point", _dew_point(weather)),
    ]
    if weather.illuminance is not None:
        rows.append(("illuminance", "of sun and sky, from the file"))
    rows += [("repaired", note) for note in weather.notes]
    rows += [("doubtful", problem) for problem in quality_problems(weather)]
    return rows


def _dew_point(weather: Weather) -> str:
    known = np.array([])
    if weather.dew_point_c is not None:
        known = weather.dew_point_c[np.isfinite(weather.dew_point_c)]
    if len(known) == 0:
        return "none; 11 °C is taken"
    text = f"{known.min():.1f} to {known.max():.1f} °C"
    missing = len(weather) - len(known)
    return text + (f", {missing} missing" if missing else "")
