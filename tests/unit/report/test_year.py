"""The picture of the year: every step in its cell, whatever the steps."""

import base64
import gzip
import io

import numpy as np
import pytest
from matplotlib.image import imread

from clerestory.report.colour import illuminance_scale, value_colours
from clerestory.report.content_from_results import from_results
from clerestory.report.embedded_data import CODE_STEP, illuminance_codes, packed
from clerestory.report.heat_map import day_hour_grid
from clerestory.report.period import period_words
from clerestory.report.year_section import year_section


@pytest.mark.parametrize(("minutes", "bins"), [(60, 24), (30, 48), (10, 144), (5, 288)])
def test_each_step_of_a_year_fills_its_own_cell(room, minutes, bins):
    times = room.year(minutes)
    grid = day_hour_grid(times)
    assert (grid.days, grid.bins) == (365, bins)
    assert np.array_equal(grid.cell, np.arange(365 * bins))


def test_minutes_are_averaged_into_cells_of_five(room):
    grid = day_hour_grid(room.year(1, days=2))
    values = grid.fill(np.arange(2880.0))
    assert values.shape == (288, 2)
    assert values[0, 0] == pytest.approx(2.0)


def test_missing_hours_are_empty():
    times = np.array(["2023-03-01T10:30", "2023-03-01T11:30", "2023-03-04T10:30"])
    values = day_hour_grid(times.astype("datetime64[s]")).fill(
        np.array([1.0, 2.0, 3.0])
    )
    assert values.shape == (24, 4)
    assert np.nansum(values) == 6
    assert np.isfinite(values).sum() == 3
    assert values[10, 3] == 3


def test_days_far_apart_stand_side_by_side():
    """The equinoxes and solstices, as in LBNL's tutorial, fill the whole picture."""
    dates = np.array(["2023-03-21", "2023-06-21", "2023-09-21", "2023-12-22"])
    hours = 8.5 + np.arange(10)
    times = dates.astype("datetime64[s]")[:, None] + (3600 * hours).astype(int)
    grid = day_hour_grid(times.ravel())
    assert grid.dates.astype(str).tolist() == dates.tolist()
    values = grid.fill(np.arange(40.0))
    assert np.array_equal(values[8:18].T.ravel(), np.arange(40))
    assert period_words(times.ravel()) == (
        "4 days from 21 March to 22 December, 40 steps of 60 minutes"
    )


def test_several_years_lie_on_top_of_each_other(room):
    """Two years of noons, the second three times as bright, meet at twice the first."""
    noons = np.arange("2021-01-01", "2023-01-01", dtype="datetime64[D]")
    grid = day_hour_grid(noons + np.timedelta64(12 * 60 + 30, "m"))
    values = grid.fill(np.repeat([1.0, 3.0], 365))
    assert grid.days == 366
    assert np.nansum(values[12]) == 2 * 365
    assert np.isnan(values[12, 59])  # neither year has a 29 February


def test_leap_days_keep_their_place():
    times = np.array(["2016-02-28T12:00", "2020-02-29T12:00", "2021-03-01T12:00"])
    grid = day_hour_grid(times.astype("datetime64[s]"))
    assert grid.days == 3
    assert (grid.cell // grid.bins).tolist() == [0, 1, 2]


def test_the_period_is_reported_in_words(room):
    assert period_words(room.year(15, 7, "2023-06-18")) == (
        "18 June to 24 June, 672 steps of 15 minutes"
    )
    noon = np.array(["2023-06-21T12:00"], dtype="datetime64[s]")
    assert period_words(noon) == "21 June, 1 step of 60 minutes"


def test_quarter_hours_count_as_quarters(room):
    times = room.year(15, 2)
    counted = np.ones(len(times), dtype=bool)
    assert day_hour_grid(times).hours(counted) == pytest.approx(48)


def test_codes_keep_illuminance_to_two_parts_in_ten_thousand():
    lux = np.geomspace(1, 150_000, 999)
    decoded = np.expm1(illuminance_codes(lux) * CODE_STEP)
    assert np.max(np.abs(decoded / lux - 1)) < 3e-4
    assert illuminance_codes(np.zeros(1))[0] == 0


def test_packed_arrays_are_unpacked():
    values = np.arange(1000, dtype=np.uint16)
    raw = gzip.decompress(base64.b64decode(packed(values)))
    assert np.array_equal(np.frombuffer(raw, "<u2"), values)


def test_midnight_is_at_the_bottom_and_gaps_are_clear(room):
    """One hour of data at midnight, on the first and the last of three days."""
    times = np.array(["2023-03-01T00:30", "2023-03-03T00:30"], dtype="datetime64[s]")
    results = room.analytic_results(times=times, luminance=np.full(2, 5000.0))
    drawing = str(year_section(from_results(results)).body)
    address = drawing.split('<image href="')[1].split('"')[0]
    pixels = imread(io.BytesIO(base64.b64decode(address.split(",")[1])), format="png")
    assert pixels.shape == (24, 3, 4)
    assert pixels[-1, :, 3].tolist() == [1, 0, 1]
    assert np.all(pixels[:-1, :, 3] == 0)


def test_colours_grow_lighter_with_the_value():
    scale = illuminance_scale(np.array([50.0, 5000.0]))
    values = np.geomspace(scale.smallest, scale.largest, 20)
    red, green, blue = value_colours(scale, values).T.astype(float)
    assert np.all(np.diff(0.2126 * red + 0.7152 * green + 0.0722 * blue) > 0)


@pytest.mark.parametrize("lux", [np.zeros(5), np.array([7.0]), np.array([3e5, 4e5])])
def test_scales_of_odd_values_still_span_a_decade(lux):
    scale = illuminance_scale(lux)
    assert scale.largest >= 10 * scale.smallest > 0
    assert np.all(np.isfinite(scale.place(lux)))
    assert len(scale.levels) > 1
