"""Sky matrices against what they must integrate to."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.bands import unnamed_bands
from clerestory.constants import SUN_DIAMETER
from clerestory.errors import ClerestoryWarning, InputError, MatrixError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sky_state import sky_state, visible_irradiance
from clerestory.sky.solar_radiance import sun_radiance
from clerestory.sky.weather import Weather

GREY = {"sky_colour": (1.0, 1.0, 1.0), "spectrum": "solar"}


@pytest.mark.parametrize("subdivision", [1, 2, 3, 4])
def test_the_sky_sends_the_diffuse_irradiance_of_the_weather(spring_day, subdivision):
    sky = sky_matrix(spring_day, subdivision=subdivision, include="sky", **GREY)
    projected = sky.partition.dome.projected_solid_angles()
    received = projected @ sky.values[1, 1:]
    np.testing.assert_allclose(received, spring_day.diffuse_horizontal, rtol=1e-5)


@pytest.mark.parametrize("placement", ["spread", "patch"])
@pytest.mark.parametrize("subdivision", [1, 4])
def test_the_sun_sends_the_direct_irradiance_of_the_weather(
    spring_day, subdivision, placement
):
    sky = sky_matrix(
        spring_day, subdivision=subdivision, include="sun", sun=placement, **GREY
    )
    received = sky.partition.solid_angles() @ sky.values[0]
    np.testing.assert_allclose(received, spring_day.direct_normal, rtol=1e-5)


def test_a_disc_has_the_radiance_of_the_sun(spring_day):
    sky = sky_matrix(spring_day, include="sun", sun="disc", **GREY)
    disc = np.pi * (SUN_DIAMETER / 2) ** 2
    brightest = sky.values[0].max(axis=0)
    np.testing.assert_allclose(brightest * disc, spring_day.direct_normal, rtol=1e-5)


def test_the_ground_reflects_sky_and_sun(spring_day):
    """Radiance ρ (DHI + DNI sin h) / π."""
    sky = sky_matrix(
        spring_day, subdivision=1, ground_reflectance=(0.1, 0.2, 0.4), **GREY
    )
    altitude = sky_conditions(spring_day).sun.altitude
    level = spring_day.direct_normal * np.maximum(np.sin(altitude), 0)
    level += spring_day.diffuse_horizontal
    for channel, reflectance in enumerate((0.1, 0.2, 0.4)):
        expected = reflectance * level / np.pi
        np.testing.assert_allclose(sky.values[channel, 0], expected, rtol=1e-5)


def test_a_sky_of_nine_bands_is_nine_grey_skies(spring_day):
    """Each band is the grey sky times its own colour, and its own ground."""
    nine = unnamed_bands(9)
    colour = np.linspace(0.5, 1.5, 9)
    ground = np.linspace(0.1, 0.9, 9)
    sky = sky_matrix(
        spring_day,
        subdivision=1,
        sky_colour=colour,
        ground_reflectance=ground,
        bands=nine,
    )
    assert sky.values.shape == (9, 146, len(spring_day.times))
    assert sky.to_transfer_matrix().bands == nine
    for band in range(9):
        grey = sky_matrix(
            spring_day,
            subdivision=1,
            sky_colour=(colour[band],) * 3,
            ground_reflectance=ground[band],
        )
        np.testing.assert_allclose(sky.values[band], grey.values[1], rtol=1e-6)
    white = sky_matrix(spring_day, subdivision=1, bands=nine)
    assert (white.colour[:, 1:] == 1).all()


def test_illuminance_is_179_times_visible_irradiance(spring_day):
    """Perez 1990, eq. 7, worked by hand for a clear noon: Δ and W from eqs. 2 and 3."""
    state = sky_state(
        np.array([600.0]), np.array([100.0]), altitude=np.array([np.pi / 4]),
        day_of_year=np.array([80]),
    )  # fmt: skip
    zenith = np.pi / 4
    epsilon = (700 / 100 + 1.041 * zenith**3) / (1 + 1.041 * zenith**3)
    assert state.clearness[0] == pytest.approx(epsilon)
    assert state.category[0] == 6
    _, diffuse = visible_irradiance(
        np.array([600.0]), np.array([100.0]), state=state, dew_point_c=np.array([11.0])
    )
    water = np.exp(0.07 * 11 - 0.075)
    efficacy = 141.88 + 1.90 * water - 53.24 * np.cos(zenith)
    efficacy += -14.03 * np.log(state.brightness[0])
    assert 179 * diffuse[0] == pytest.approx(100 * efficacy)


def test_the_sun_is_where_its_patch_is():
    partition = reinhart(4)
    direction = partition.centres()[[700]]
    sun = sun_radiance(
        np.array([500.0]), direction, partition=partition, placement="patch"
    )
    assert sun.tocoo().coords[0].tolist() == [700]


def test_four_patches_share_the_sun(spring_day):
    sky = sky_matrix(spring_day, include="sun", subdivision=2, **GREY)
    lit = spring_day.direct_normal > 100
    assert set(np.diff(sky.sun.indptr)[lit]) == {4}


def test_rotation_turns_the_sky_counter_clockwise(spring_day):
    """60° is a whole number of patches in every row of Tregenza's sky but the cap."""
    plain = sky_matrix(spring_day, subdivision=1).values[1, 1:]
    turned = sky_matrix(spring_day, subdivision=1, rotation_deg=60).values[1, 1:]
    dome = reinhart(1).dome
    for first, count in zip(dome.first[:-1], dome.count[:-1], strict=True):
        row = slice(first, first + count)
        expected = np.roll(plain[row], -count // 6, axis=0)
        np.testing.assert_allclose(turned[row], expected, rtol=1e-3, atol=1e-3)


def test_a_dry_sky_takes_the_dew_point_of_the_weather(spring_day):
    dry = replace(spring_day, dew_point_c=np.full(len(spring_day), -10.0))
    unknown = replace(spring_day, dew_point_c=np.full(len(spring_day), np.nan))
    fixed = sky_matrix(spring_day, subdivision=1, dew_point_c=-10)
    np.testing.assert_array_equal(sky_matrix(dry, subdivision=1).diffuse, fixed.diffuse)
    np.testing.assert_array_equal(
        sky_matrix(unknown, subdivision=1).diffuse,
        sky_matrix(spring_day, subdivision=1).diffuse,
    )


def test_blocks_selections_and_the_whole_agree(spring_day):
    sky = sky_matrix(spring_day, subdivision=2)
    part = slice(40, 60, 3)
    np.testing.assert_array_equal(sky.block(part), sky.values[:, :, part])
    chosen = sky.select(part)
    np.testing.assert_array_equal(chosen.values, sky.values[:, :, part])
    np.testing.assert_array_equal(chosen.times, sky.times[part])
    mask = spring_day.direct_normal > 100
    np.testing.assert_array_equal(sky.select(mask).values, sky.values[:, :, mask])
    np.testing.assert_array_equal(sky.to_transfer_matrix().values, sky.values)
    rows = np.concatenate(list(sky.row_blocks()))
    np.testing.assert_array_equal(np.moveaxis(rows, -1, 0), sky.values)


def test_luminance_is_the_weighted_sum_of_the_channels(spring_day):
    """179 lm/W times Radiance's weights."""
    sky = sky_matrix(spring_day, subdivision=1)
    red, green, blue = sky.values
    expected = 179 * (0.265 * red + 0.670 * green + 0.065 * blue)
    np.testing.assert_allclose(sky.luminance().values[0], expected, rtol=1e-5)


def test_sun_at_night_is_doubted(spring_day):
    """Eight hours of a wrong time zone bring the noon sun below the horizon."""
    wrong = replace(spring_day, utc_offset_hours=9.0)
    with pytest.warns(ClerestoryWarning, match="are time zone and longitude right"):
        sky_matrix(wrong, subdivision=1)


def test_the_mean_is_that_of_all_steps(spring_day):
    sky = sky_matrix(spring_day, subdivision=1)
    expected = sky.values.mean(axis=2, keepdims=True, dtype=float)
    np.testing.assert_allclose(sky.mean().values, expected, rtol=1e-5, atol=1e-6)


def test_a_night_is_black(spring_day):
    dark = replace(
        spring_day,
        direct_normal=np.zeros(len(spring_day)),
        diffuse_horizontal=np.zeros(len(spring_day)),
    )
    assert not sky_matrix(dark, subdivision=1).values.any()


irradiance = st.one_of(
    st.just(0.0), st.floats(0, 1e-3), st.floats(0, 1500), st.floats(0, 1e5)
)


@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
@settings(max_examples=60, deadline=None)
@given(
    rows=st.lists(
        st.tuples(irradiance, irradiance, st.floats(-1e3, 1e3)), min_size=1, max_size=24
    ),
    latitude=st.floats(-90, 90),
    longitude=st.floats(-180, 180),
    start=st.integers(0, 8000),
    formula=st.sampled_from(["spa", "radiance"]),
)
def test_no_weather_gives_negative_or_undefined_radiance(
    rows, latitude, longitude, start, formula
):
    direct, diffuse, dew_point = np.array(rows, dtype=float).T
    times = np.datetime64("2023-01-01T00:30", "s") + 3600 * (
        start + np.arange(len(rows))
    )
    weather = Weather(
        place="anywhere",
        latitude_deg=latitude,
        longitude_deg=longitude,
        elevation=0.0,
        utc_offset_hours=float(round(longitude / 15)),
        times=times,
        step_minutes=60.0,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        dew_point_c=dew_point,
    )
    sky = sky_matrix(weather, subdivision=1, sun_formula=formula, **GREY)
    values = sky.values
    assert np.all(np.isfinite(values))
    assert np.all(values >= 0)
    weight = sky.partition.dome.projected_solid_angles()
    if formula == "spa":
        bright = direct + diffuse > 1e-3
        without_sun = sky.diffuse[1:].astype(float)
        received = (weight @ without_sun)[bright]
        np.testing.assert_allclose(received, diffuse[bright], rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"subdivision": 7}, "from 1 to 6"),
        ({"include": "moon"}, "one of all, sky, sun"),
        ({"sun": "smeared"}, "one of spread, patch, disc"),
        ({"sun": "disc", "sun_diameter_deg": 0.0}, "above 0 and up to 30°"),
        ({"ground_reflectance": 1.5}, "0 to 1 expected"),
        (
            {"ground_reflectance": (0.1, 0.2)},
            "one number, or one for each of the bands",
        ),
        ({"sky_colour": (1, 1, -1)}, "0 to 100"),
        ({"sky_colour": float("nan")}, "0 to 100"),
        ({"rotation_deg": float("inf")}, "finite"),
        ({"sun_formula": "newton"}, "one of spa, radiance"),
        ({"quadrature": "simpson"}, "one of exact, centres"),
        ({"dew_point_c": 80.0}, "dew point"),
        ({"spectrum": "x-ray"}, "one of visible, solar"),
    ],
)
def test_arguments_outside_their_range_are_refused(spring_day, arguments, message):
    with pytest.raises(InputError, match=message):
        sky_matrix(spring_day, **{"subdivision": 1, **arguments})


def test_a_sky_of_the_wrong_shape_is_refused(spring_day):
    sky = sky_matrix(spring_day, subdivision=1)
    with pytest.raises(MatrixError, match=r"sky is \(145, 96\), .* \(146, 96\)"):
        replace(sky, diffuse=sky.diffuse[:-1])
    with pytest.raises(MatrixError, match="not finite"):
        replace(sky, colour=sky.colour * np.nan)
    with pytest.raises(MatrixError, match="colour has shape"):
        replace(sky, colour=sky.colour[:, :-1])


WEATHER_FAULTS = [
    ({"latitude_deg": 91.0}, "latitude"),
    ({"longitude_deg": float("nan")}, "longitude"),
    ({"elevation": 1e5}, "elevation"),
    (
        {"direct_normal": np.full(96, -1.0)},
        "direct normal irradiance is -1 W/m²; 0 or more",
    ),
    ({"diffuse_horizontal": np.full(96, np.nan)}, "diffuse horizontal irradiance"),
    ({"diffuse_horizontal": np.zeros(95)}, "95 values"),
    ({"dew_point_c": np.zeros(95)}, "95 dew points"),
    ({"step_minutes": 0.0}, "length of a time step is 0 minutes; a positive"),
]


@pytest.mark.parametrize(("changes", "message"), WEATHER_FAULTS)
def test_weather_checks_itself(spring_day, changes, message):
    with pytest.raises(InputError, match=message):
        replace(spring_day, **changes)


def test_weather_that_goes_back_in_time_is_refused(spring_day):
    with pytest.raises(InputError, match="times do not increase"):
        replace(spring_day, times=spring_day.times[::-1])
    with pytest.raises(InputError, match="without time steps"):
        spring_day.select(slice(0, 0))
