"""Matrix BSDFs: their integrals, their reciprocity and which way up they are."""

import numpy as np
import pytest

from clerestory.bands import Bands
from clerestory.bsdf.analytic import clear_air, lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

FULL = klems("full")


def single(values, *, function="transmission_front", partition=FULL):
    part = ScatteringMatrix(values, partition, partition)
    return Bsdf({("visible", function): part})


def random_table(seed=1):
    return np.random.default_rng(seed).random((145, 145)) * 0.2


def test_transmission_matrix_is_bsdf_times_projected_solid_angle_of_incident_patch():
    table = random_table()
    matrix = single(table).transmission_matrix(window="south")
    expected = table * FULL.projected_solid_angles()[None, :]
    np.testing.assert_allclose(matrix.values[0], expected, rtol=1e-14)
    assert (matrix.rows.kind, matrix.columns.kind) == ("interior", "exterior")
    assert matrix.rows.window == matrix.columns.window == "south"


def test_uniform_sky_sends_the_hemispherical_flux_through():
    """Exit flux Λo·T·1 equals the direct-hemispherical shares weighted with Λi."""
    bsdf = single(random_table())
    lam = FULL.projected_solid_angles()
    through = lam @ bsdf.transmission_matrix().values[0].sum(axis=1)
    assert through == pytest.approx(float(bsdf.direct_hemispherical() @ lam))


def test_the_missing_side_follows_from_reciprocity():
    """Light sent back along its way is attenuated alike: f(a→b) = f(b→a)."""
    bsdf = single(random_table())
    rng = np.random.default_rng(2)
    sky = rng.normal(size=(200, 3))
    room = rng.normal(size=(200, 3))
    sky[:, 2], room[:, 2] = -np.abs(sky[:, 2]), np.abs(room[:, 2])
    forth = bsdf.evaluate(sky, room)
    back = bsdf.evaluate(room, sky)
    np.testing.assert_allclose(back, forth)
    assert np.ptp(forth) > 0.1


def test_reciprocity_twice_is_the_same():
    part = single(random_table()).function("transmission_front")
    np.testing.assert_array_equal(part.reciprocal().reciprocal().values, part.values)


def test_light_goes_straight_on_through_equal_patch_numbers():
    """Air keeps the direction of travel: light leaves opposite to its source."""
    air = clear_air(FULL)
    travel = FULL.sample(np.arange(145), np.full((145, 2), 0.3))
    straight = air.evaluate(-travel, travel)
    np.testing.assert_allclose(straight, 1 / FULL.projected_solid_angles())
    mirrored = air.evaluate(-travel, travel * [1, -1, 1])
    assert np.all(mirrored[travel[:, 1] > 0.3] == 0)


def test_mirror_reflection_keeps_the_patch_number():
    table = np.diag(1 / FULL.projected_solid_angles())
    mirror = single(table, function="reflection_back")
    source = FULL.centres()
    reflected = source * [-1, -1, 1]
    assert np.all(mirror.evaluate(source, reflected) > 0)


def test_up_is_counted_from_the_right_like_polar_coordinates():
    """Klems patches 1…8 of the second ring: right first, then up (klems_full.cal)."""
    tilt = np.radians(10)
    right, up = [np.sin(tilt), 0, np.cos(tilt)], [0, np.sin(tilt), np.cos(tilt)]
    assert FULL.find(np.array([right, up])).tolist() == [1, 3]


def test_evaluation_is_zero_for_functions_that_are_missing():
    bsdf = single(random_table())
    assert bsdf.evaluate(np.array([0, 0, 1.0]), np.array([0, 0.1, 1.0])) == 0


def test_evaluation_broadcasts_one_source_over_many_directions():
    bsdf = lambertian(0.5, FULL)
    leaving = FULL.centres()
    values = bsdf.evaluate(np.array([0, 0, -1.0]), leaving)
    np.testing.assert_allclose(values, np.full(145, 0.5 / np.pi))


def test_missing_function_names_what_there_is():
    with pytest.raises(
        InputError, match=r"no visible reflection front; it has visible"
    ):
        single(random_table()).direct_hemispherical("reflection_front")


def test_bsdf_without_any_data_says_so():
    with pytest.raises(InputError, match="it has no data"):
        Bsdf({}).transmission_matrix()


def test_channels_are_listed_once():
    assert lambertian(0.5, FULL).channels == ("visible",)
    assert all(lambertian(0.5, FULL).has(name) for name in FUNCTIONS)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (np.zeros((3, 145)), "145 exit patches by 145 incident patches expected"),
        (np.full((145, 145), -1.0), "BSDF is -1 1/sr; 0 or more expected"),
        (np.full((145, 145), np.nan), "BSDF is nan 1/sr; 0 or more expected"),
    ],
)
def test_unphysical_tables_are_refused(table, message):
    with pytest.raises(InputError, match=message):
        ScatteringMatrix(table, FULL, FULL)


def test_different_partitions_on_both_sides_make_a_rectangular_matrix():
    half = klems("half")
    part = ScatteringMatrix(np.full((77, 145), 0.5 / np.pi), half, FULL)
    bsdf = Bsdf({("visible", "transmission_front"): part})
    matrix = bsdf.transmission_matrix()
    assert matrix.values.shape == (1, 77, 145)
    np.testing.assert_allclose(bsdf.direct_hemispherical(), 0.5)
    assert bsdf.function("transmission_back").values.shape == (145, 77)


def test_colour_of_white_data_is_grey():
    table = random_table()
    part = ScatteringMatrix(table, FULL, FULL)
    channels = ("visible", "cie-x", "cie-z")
    bsdf = Bsdf({(channel, "transmission_front"): part for channel in channels})
    matrix = bsdf.transmission_matrix()
    grey = part.flux_factors()
    np.testing.assert_allclose(matrix.values, np.stack([grey] * 3), rtol=1e-9)


def test_luminance_of_colour_data_is_the_visible_channel():
    """0.265 R + 0.670 G + 0.065 B (Radiance color.h) gives Y back, to its rounding."""
    rng = np.random.default_rng(3)
    y = rng.random((5, 5)) * 0.1
    five = RingPartition("five", np.array([1, 4]), np.radians([0, 30, 90]), "polar")
    tables = {"visible": y, "cie-x": 1.1 * y, "cie-z": 0.7 * y}
    bsdf = Bsdf(
        {
            (channel, "transmission_front"): ScatteringMatrix(table, five, five)
            for channel, table in tables.items()
        }
    )
    rgb = bsdf.transmission_matrix().values
    luminance = np.tensordot([0.265, 0.670, 0.065], rgb, axes=1)
    np.testing.assert_allclose(luminance, y * five.projected_solid_angles(), rtol=2e-3)
    assert rgb[0, 0, 0] > rgb[2, 0, 0]


def test_bands_are_the_channels_of_their_names():
    """A file with one block of data for each band; a band it lacks is refused."""
    bands = Bands(("450 nm", "550 nm", "650 nm", "visible"))
    tables = [random_table(seed) for seed in range(4)]
    bsdf = Bsdf(
        {
            (name, "transmission_front"): ScatteringMatrix(table, FULL, FULL)
            for name, table in zip(bands.names, tables, strict=True)
        }
    )
    matrix = bsdf.transmission_matrix(bands=bands, window="south")
    expected = np.stack(tables) * FULL.projected_solid_angles()
    np.testing.assert_allclose(matrix.values, expected, rtol=1e-14)
    assert (matrix.bands, matrix.rows.window) == (bands, "south")
    with pytest.raises(InputError, match="has no solar transmission"):
        bsdf.transmission_matrix(bands=Bands(("450 nm", "solar")))


def test_colours_outside_the_primaries_stay_positive():
    table = random_table()[:41, :41]
    quarter = klems("quarter")
    scales = {"visible": 1.0, "cie-x": 0.2, "cie-z": 0.1}  # a laser green
    bsdf = Bsdf(
        {
            (channel, "transmission_front"): ScatteringMatrix(
                scale * table, quarter, quarter
            )
            for channel, scale in scales.items()
        }
    )
    assert bsdf.transmission_matrix().values.min() >= 0
