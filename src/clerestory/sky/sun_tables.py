"""Tables of solar positions, as CSV."""

import numpy as np

from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.sky.weather import Weather


def sun_path_table(
    weather: Weather, *, sun_formula: SunFormula = "spa", rotation_deg: float = 0.0
) -> str:
    """Return a line per time step: time, solar altitude and azimuth [°], DNI [W/m²]."""
    position = sun_over(weather, rotation_deg=rotation_deg, sun_formula=sun_formula)
    return _table(
        "time,altitude,azimuth clockwise from north,direct normal [W/m²]",
        "{},{:.3f},{:.3f},{:g}",
        np.char.replace(np.datetime_as_string(weather.times, unit="m"), "T", " "),
        np.degrees(position.altitude),
        np.degrees(position.azimuth) % 360,
        weather.direct_normal,
    )


def suns_table(suns: SunMatrix, *, step_minutes: float) -> str:
    """Return a line per solar position: angles [°], step count, irradiation [kWh/m²].

    >>> from scipy.sparse import csc_array
    >>> noon = np.array([[0.0, -0.6, 0.8]])
    >>> hour = np.array(["2023-06-21T12:00"], "datetime64[s]")
    >>> matrix = SunMatrix(noon, hour, csc_array([[500.0]]), {})
    >>> print(suns_table(matrix, step_minutes=60).splitlines()[1])
    53.1301,180.0000,0.000000,-0.600000,0.800000,1,0.500
    """
    x, y, z = suns.directions.T
    azimuth = np.degrees(np.arctan2(x, y)) % 360
    altitude = np.degrees(np.arcsin(np.clip(z, -1, 1)))
    steps = np.diff(suns.direct_normal.tocsr().indptr)
    total = np.asarray(suns.direct_normal.sum(axis=1), dtype=float).ravel()
    return _table(
        "altitude,azimuth clockwise from north,x,y,z,time steps,"
        "visible direct normal [kWh/m²]",
        "{:.4f},{:.4f},{:.6f},{:.6f},{:.6f},{},{:.3f}",
        *(altitude, azimuth, x, y, z, steps, total * step_minutes / 60_000),
    )


def _table(header: str, row_format: str, *columns: np.ndarray) -> str:
    rows = (row_format.format(*row) for row in zip(*columns, strict=True))
    return "\n".join([header, *rows]) + "\n"
