"""Measured illuminance, and the irradiance that goes with it."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.sky.csv_measurements import Columns, read_measured
from clerestory.sky.sky_state import irradiance_of, sky_state, visible_irradiance
from clerestory.sky.solar_position import SunPosition, day_of_year
from clerestory.sky.weather import Illuminance, Site

SITE = Site(latitude_deg=50.0, longitude_deg=8.5, utc_offset_hours=1.0)


def test_the_efficacy_of_the_irradiance_found_gives_the_illuminance_back():
    random = np.random.default_rng(3)
    count = 2000
    times = np.datetime64("2023-01-01", "s") + random.integers(0, 365 * 86400, count)
    sun = SunPosition(np.radians(random.uniform(0, 85, count)), np.zeros(count))
    lux = Illuminance(
        random.choice([0.0, 10, 3000, 40_000, 100_000], count),
        random.uniform(0, 60_000, count),
    )
    direct, diffuse = irradiance_of(lux, times=times, sun=sun)
    assert np.all(np.isfinite(direct) & np.isfinite(diffuse))
    assert np.all(direct[lux.direct_normal == 0] == 0)
    state = sky_state(
        direct, diffuse, altitude=sun.altitude, day_of_year=day_of_year(times)
    )
    visible = visible_irradiance(
        direct, diffuse, state=state, dew_point_c=np.full(count, 11.0)
    )
    good = np.abs(179 * visible[1] / lux.diffuse_horizontal - 1) < 1e-6
    assert good.mean() > 0.95


def write(tmp_path, header, rows):
    path = tmp_path / "lux.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_illuminance_beside_irradiance_is_what_the_sky_sends(tmp_path):
    rows = [f"2022-06-21 1{hour}:00,700,120,80000,15000" for hour in range(5)]
    path = write(tmp_path, "time,GHI,DHI,EG,ED", rows)
    columns = Columns(
        "time", "GHI", "DHI", global_illuminance="EG", diffuse_illuminance="ED"
    )
    weather = read_measured(path, columns=columns, site=SITE)
    np.testing.assert_allclose(weather.diffuse_horizontal, 120)
    np.testing.assert_allclose(weather.illuminance.diffuse_horizontal, 15_000)
    plain = read_measured(path, columns=Columns("time", "GHI", "DHI"), site=SITE)
    np.testing.assert_array_equal(weather.direct_normal, plain.direct_normal)

    # E_direct sin h = 80,000 − 15,000 lux, as 700 − 120 W/m² is to the irradiance
    ratio = weather.illuminance.direct_normal / weather.direct_normal
    np.testing.assert_allclose(ratio, (80_000 - 15_000) / (700 - 120))


def test_illuminance_alone_is_noted_and_kept_by_selections(tmp_path):
    rows = [f"2022-06-21 1{hour}:00,70000,15000" for hour in range(5)]
    path = write(tmp_path, "time,EN,ED", rows)
    columns = Columns("time", direct_illuminance="EN", diffuse_illuminance="ED")
    weather = read_measured(path, columns=columns, site=SITE)
    assert "from illuminance by Perez" in weather.notes[-1]
    part = weather.select(slice(1, 3))
    assert part.illuminance.direct_normal.tolist() == [70_000.0] * 2


def test_one_kind_of_illuminance_is_refused(tmp_path):
    path = write(tmp_path, "time,EG", ["2022-06-21 10:00,70000"])
    columns = Columns("time", global_illuminance="EG")
    with pytest.raises(InputError, match="two of global, diffuse and direct"):
        read_measured(path, columns=columns, site=SITE)
