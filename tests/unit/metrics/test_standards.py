"""Shares of rooms and standards, on cases that can be counted by hand."""

import json

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import InputError
from clerestory.metrics.breeam import factor_criterion, illuminance_criterion
from clerestory.metrics.climate_based_metrics import light_exposure
from clerestory.metrics.daylight_factor import daylight_factor, room_factors
from clerestory.metrics.en17037 import (
    daylight_hours,
    daylight_provision,
    glare_level,
    sunlight_level,
    target_factors,
)
from clerestory.metrics.leed import clear_sky_illuminance, simulated_daylight
from clerestory.metrics.lighting_energy import (
    LightingZone,
    lighting_saving,
    lighting_use,
)
from clerestory.metrics.lm83_conditions import departures
from clerestory.metrics.replicates import metric_error
from clerestory.metrics.spatial_metrics import spatial_autonomy, sunlight_exposure

ALL = np.ones(10, bool)


def sensors(*rows):
    return xr.DataArray(np.array(rows, dtype=float), dims=("sensor", "time"))


def test_half_of_the_hours_is_enough_for_sda():
    lux = sensors([300] * 5 + [0] * 5, [300] * 4 + [0] * 6)
    assert spatial_autonomy(lux, ALL).value == 0.5
    area = np.array([3.0, 1.0])
    assert spatial_autonomy(lux, ALL, area=area).value == 0.75


def test_the_error_of_sda_is_what_sensors_at_the_limit_may_do():
    lux = sensors([290] * 10, [310] * 10, [900] * 10, [10] * 10)
    error = xr.full_like(lux, 20.0)
    share = spatial_autonomy(lux, ALL, standard_error=error)
    assert share.value == 0.5
    assert share.error == pytest.approx(0.25)


def test_ase_counts_more_than_250_hours():
    hours = np.ones(300, bool)
    lux = sensors([1001] * 251 + [0] * 49, [1001] * 250 + [0] * 50, [1000] * 300)
    assert sunlight_exposure(lux, hours).value == pytest.approx(1 / 3)
    half_hours = sunlight_exposure(lux, hours, step_hours=0.5)
    assert half_hours.value == 0


def test_the_brightest_half_of_a_year_has_4380_hours():
    rng = np.random.default_rng(1)
    sky = np.maximum(rng.normal(0, 1, 8760), 0)
    hours = daylight_hours(sky)
    assert hours.sum() == 4380
    assert sky[hours].min() >= sky[~hours].max()


@pytest.mark.parametrize(
    ("near", "far", "target", "minimum"),
    [
        (800, 520, 3, 3),
        (800, 310, 2, 2),
        (520, 110, 1, 1),
        (310, 90, 1, 0),
        (90, 90, 0, 0),
    ],
)
def test_provision_asks_for_target_on_half_and_minimum_on_nearly_all(
    near, far, target, minimum
):
    """Ten sensors, four of them near the window, one in between."""
    middle = (near + far) / 2
    lux = sensors(*[[near] * 10] * 4, [middle] * 10, *[[far] * 10] * 5)
    found = daylight_provision(lux, ALL)
    reached = (near, near, near, near, middle)
    assert found.target_level == sum(min(reached) >= limit for limit in (300, 500, 750))
    assert found.minimum_level == minimum
    assert found.level == min(found.target_level, found.minimum_level)
    assert found.target_level <= target


def test_a_roof_light_has_to_reach_the_target_nearly_everywhere():
    lux = sensors(*[[800] * 10] * 6, *[[310] * 10] * 4)
    assert daylight_provision(lux, ALL).target_level == 3
    assert daylight_provision(lux, ALL, roof=True).target_level == 1


def test_daylight_factors_of_oslo():
    """EN 17037, table A.3: Oslo, 12,400 lux, asks for 2.4, 4.0 and 6.0 %."""
    target, minimum = target_factors(12_400.0)
    assert [round(100 * d, 1) for d in target] == [2.4, 4.0, 6.0]
    assert [round(100 * d, 1) for d in minimum] == [0.8, 2.4, 4.0]


def test_levels_of_sun_and_glare():
    assert [sunlight_level(h) for h in (1.4, 2.9, 3.0, 4.5)] == [0, 1, 2, 3]
    dgp = np.concatenate([np.full(6, 0.46), np.full(94, 0.2)])
    assert glare_level(dgp, np.ones(100, bool)) == 0
    assert glare_level(dgp, np.arange(100) >= 2) == 3
    with pytest.raises(InputError, match="no occupied"):
        glare_level(dgp, np.zeros(100, bool))


@pytest.mark.parametrize(
    ("version", "autonomy", "exposure", "points"),
    [
        ("v4", 0.54, 0.0, 0),
        ("v4", 0.55, 0.1, 2),
        ("v4", 0.80, 0.0, 3),
        ("v4", 0.80, 0.11, 0),
        ("v4.1", 0.39, 0.0, 0),
        ("v4.1", 0.40, 0.0, 1),
        ("v4.1", 0.56, 0.3, 2),
        ("v4.1", 0.75, 0.0, 3),
    ],
)
def test_points_of_leed_option_1(version, autonomy, exposure, points):
    credit = simulated_daylight(autonomy, exposure, version=version)
    assert credit.points == points
    assert bool(credit.note) == (exposure > 0.1)


def test_points_of_leed_option_2():
    morning = np.array([299.0] + [1000.0] * 18 + [3001.0])
    noon = np.full(20, 500.0)
    assert clear_sky_illuminance([morning, noon]).points == 3
    assert clear_sky_illuminance([morning, noon], version="v4").points == 2
    kept = clear_sky_illuminance([morning, noon], view_preserving_blinds=True)
    assert kept.share == 0.95
    with pytest.raises(InputError, match="v4"):
        clear_sky_illuminance([noon], version="v3")


def test_breeam_asks_for_the_mean_and_the_worst_point():
    hours = np.arange(3000)
    lux = sensors(np.where(hours < 2100, 600, 0), np.where(hours < 2000, 90, 0))
    found = illuminance_criterion(lux)
    assert (found.mean_hours, found.worst_hours, found.passed) == (2100, 2000, True)
    assert not illuminance_criterion(lux, worst_lux=91).passed


def test_daylight_factors_of_a_room():
    factor = daylight_factor(np.array([100.0, 200.0, 600.0]), outdoor_lux=1e4)
    room = room_factors(factor)
    assert room == pytest.approx((0.03, 0.02, 0.01, 1 / 3))
    assert factor_criterion(factor)
    assert not factor_criterion(factor, mean=0.05)
    with pytest.raises(InputError, match="a positive number"):
        daylight_factor(factor, outdoor_lux=0)


def test_light_exposure_counts_lux_hours():
    lux = sensors([100] * 10)
    assert float(light_exposure(lux, ALL, step_hours=0.25)[0]) == 250


def test_dimmed_light_reaches_the_setpoint_and_no_more():
    zone = LightingZone(power=80, full_lux=600, setpoint_lux=500)
    daylight = np.linspace(0, 1500, 31)
    use = lighting_use(zone, daylight, np.ones(31, bool))
    dim = use.output > zone.least_output + 1e-12
    assert np.allclose(use.illuminance[dim], 500)
    assert np.all(use.illuminance[~dim] >= 500)
    assert use.power.min() == pytest.approx(80 * 0.2)
    assert use.power[0] == pytest.approx(80 * (0.2 + 0.8 / 0.9 * (500 / 600 - 0.1)))


@pytest.mark.parametrize(
    ("control", "power"),
    [("none", [100, 100, 100, 2]), ("on-off", [100, 100, 2, 2])],
)
def test_switched_light_is_full_or_off(control, power):
    zone = LightingZone(power=100, full_lux=500, control=control, standby=2)
    daylight = np.array([0.0, 400.0, 600.0, 0.0])
    occupied = np.array([True, True, True, False])
    use = lighting_use(zone, daylight, occupied)
    assert use.power.tolist() == power


def test_savings_and_their_error():
    zone = LightingZone(power=100, full_lux=500, least_output=0, least_power=0)
    daylight = np.full(10, 250.0)
    use, more, less = (lighting_use(zone, daylight + x, ALL) for x in (0, 25, -25))
    always = lighting_use(
        LightingZone(power=100, full_lux=500, control="none"), daylight, ALL
    )
    assert lighting_saving(use, always) == pytest.approx(0.5)
    # 25 of 500 lux is 5 % of 1000 Wh
    assert metric_error([more.energy, less.energy]) == pytest.approx(50.0)


def test_areas_have_to_fit_the_sensors():
    with pytest.raises(InputError, match="2 areas for 1 sensors"):
        spatial_autonomy(sensors([1] * 10), ALL, area=np.array([1.0, 2.0]))


def lm83_results(*, spacing=(0.5, 0.5), turn=0.3, days=365, rule="LM-83", **control):
    """A year of a rotated grid of 3 × 4 sensors in a room with one shaded window."""
    hours = np.arange(24 * days)
    x, y = np.meshgrid(np.arange(3) * spacing[0], np.arange(4) * spacing[1])
    cos, sin = np.cos(turn), np.sin(turn)
    place = np.stack([cos * x - sin * y, sin * x + cos * y, 0 * x + 0.8], axis=-1)
    table = {"control": {"rule": rule, "sun_lux": 1000.0, **control}}
    return xr.Dataset(
        {
            "position": (("sensor", "xyz"), place.reshape(-1, 3)),
            "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (12, 1))),
            "direct_open": (("sensor", "time"), np.zeros((12, len(hours)))),
            "occupied": ("time", (hours % 24 >= 8) & (hours % 24 < 18)),
            "control": ("window", [rule]),
            "state_name": (("window", "state_number"), [["open", "closed"]]),
        },
        coords={
            "time": np.datetime64("2023-01-01T00:30", "ns")
            + hours * np.timedelta64(1, "h"),
            "window": ["south"],
        },
        attrs={"step_minutes": 60.0, "study": json.dumps({"window": [table]})},
    )


def test_a_simulation_by_lm83_has_no_departures():
    """2 ft apart at most, in both directions of the grid."""
    assert departures(lm83_results()) == ()
    assert departures(lm83_results(spacing=(0.6096, 0.6096))) == ()
    assert departures(lm83_results(when_empty=1)) == ()


@pytest.mark.parametrize(
    ("data", "hours", "phrase"),
    [
        (lm83_results(spacing=(0.5, 0.62)), (8, 18), "a spacing of 0.62 m; a grid of"),
        (lm83_results(spacing=(1.5, 0.5)), (8, 18), "a spacing of 1.50 m"),
        (lm83_results(spacing=(0.0, 0.0)), (8, 18), "one sensor; a grid of at most"),
        (lm83_results(rule="glare"), (8, 18), 'window "south" by rule "glare"'),
        (lm83_results(sun_lux=2000.0), (8, 18), "0.02 of the sensors above 2000 lux"),
        (lm83_results(most_sensors=0.1), (8, 18), "0.1 of the sensors above 1000 lux"),
        (lm83_results(), (9, 17), "hours from 9 to 17; 8 to 18 expected"),
        (lm83_results(days=180), (8, 18), "180 days; a whole year expected"),
    ],
)
def test_a_departure_from_lm83_is_named(data, hours, phrase):
    (found,) = departures(data, from_hour=hours[0], to_hour=hours[1])
    assert phrase in found
    credit = simulated_daylight(0.8, 0.05, departures=[found])
    assert (credit.points, credit.note) == (3, f"not by LM-83: {found}")


@pytest.mark.parametrize("sunny", [0, 1])
def test_windows_without_shades_are_as_lm83_while_the_sun_stays_out(sunny):
    """One of twelve sensors, 8 %, in direct sunlight at noon of some days."""
    data = lm83_results(rule="").drop_vars(["control", "state_name"])
    data["direct_open"][0, 12 : 12 + 24 * 5 : 24] = 1200.0 * sunny
    expected = "no shades in 5 hours with more than 2 % of the sensors" if sunny else ""
    assert "".join(departures(data)).startswith(expected)
    assert bool(departures(data)) == bool(sunny)
