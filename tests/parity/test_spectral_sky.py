"""Spectra of clear sky and sun against `gensdaymtx`, a simulation of the atmosphere.

It solves multiple scattering for molecules, ozone and continental aerosol in 20 bands,
where this package has CIE daylight by luminance, and SPECTRL2 for the sun. They are
different models: the bounds are differences found, rounded up, not errors.
"""

import numpy as np
import pytest
from radiance import run

import clerestory as cl
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.sky.spectral_light import sun_colours
from clerestory.spectral.colour_temperature import colour_temperature, tristimulus

BANDS = cl.band_set("20")
PLACE = """place Greensboro
latitude 36.10
longitude 79.95
time_zone 75
site_elevation 0
weather_data_file_units {}
"""

# Clear hours of 21 June: hour, direct normal and diffuse horizontal irradiance; the sun
# is at 15°, 39°, 63° and 77°
HOURS = ((6.5, 400, 60), (8.5, 700, 90), (10.5, 850, 105), (12.5, 900, 110))
MODEL = cl.DaylightSpectra(aerosol_optical_depth=0.1)


@pytest.fixture(scope="module")
def weather(tmp_path_factory):
    """The hours, of which Radiance reads illuminance, aerosol and cloud cover."""
    folder = tmp_path_factory.mktemp("sky")
    ours = "".join(f"6 21 {hour} {sun} {sky}\n" for hour, sun, sky in HOURS)
    theirs = "".join(
        f"6 21 {hour} {100 * sun} {120 * sky} 0.1 0\n" for hour, sun, sky in HOURS
    )
    (folder / "ours.wea").write_text(PLACE.format(1) + ours)
    (folder / "theirs.wea").write_text(PLACE.format(3) + theirs)
    return folder


@pytest.fixture(scope="module")
def read(weather):
    """The hours as this package reads them."""
    return cl.read_weather(weather / "ours.wea")


def of_radiance(folder, option):
    """Radiance in each band, patch and hour, with wavelengths increasing."""
    text = run(f"gensdaymtx {option} -m 1 theirs.wea", folder=folder)
    numbers = np.array(text.split("FORMAT=ascii")[1].split(), dtype=float)
    table = numbers.reshape(146, len(HOURS), len(BANDS))[..., ::-1]
    return np.moveaxis(table, 2, 0)


def melanopic_ratio(light):
    """Melanopic EDI per lux."""
    edi = cl.equivalent_daylight_illuminance(light, BANDS)
    return edi / BANDS.photometric(light, axis=0)


def reciprocal(light):
    """Reciprocal colour temperature [1/MK]."""
    return 1e6 / colour_temperature(tristimulus(light, BANDS)).kelvin


@pytest.mark.slow
def test_colours_of_clear_skies_are_near_those_of_gensdaymtx(weather, read):
    """Horizontal skylight and single patches, with the sun at 15° or higher."""
    sky = cl.sky_matrix(read, subdivision=1, bands=BANDS, daylight=MODEL)
    ours = sky.diffuse * sky.colour[:, :, None]
    for part in sky.chromatic:
        ours = ours + part.diffuse * part.colour[:, :, None]
    ours, theirs = ours[:, 1:], of_radiance(weather, "-s")[:, 1:]
    area = sky.partition.dome.projected_solid_angles()
    horizontal = [np.einsum("p,bpt->bt", area, each) for each in (ours, theirs)]

    # 3 % more to 6 % less melanopic light per lux
    ratio = melanopic_ratio(horizontal[0]) / melanopic_ratio(horizontal[1])
    assert (np.abs(ratio - 1) < 0.06).all()
    assert (np.abs(reciprocal(horizontal[0]) - reciprocal(horizontal[1])) < 15).all()

    # Patches: 19 to 21 per megakelvin, of a range of 80 to 160
    off = reciprocal(ours) - reciprocal(theirs)
    assert (np.sqrt(np.mean(off**2, axis=0)) < 22).all()
    for hour in range(len(HOURS)):
        both = reciprocal(ours[..., hour]), reciprocal(theirs[..., hour])
        assert np.corrcoef(*both)[0, 1] > 0.8


@pytest.mark.slow
def test_sunlight_is_near_that_of_gensdaymtx(weather, read):
    """SPECTRL2 has bands of water vapour and oxygen above 680 nm, gensdaymtx none."""
    theirs = of_radiance(weather, "-d")[:, 1:].sum(axis=1)
    ours = sun_colours(read, sky_conditions(read), MODEL, BANDS).values()
    ratio = ours / (BANDS.weights @ ours) / (theirs / (BANDS.weights @ theirs))
    assert (np.abs(ratio[:15] - 1) < 0.07).all()
    assert (np.abs(ratio[15:] - 1) < 0.20).all()
    melanopic = melanopic_ratio(ours) / melanopic_ratio(theirs)
    assert (np.abs(melanopic - 1) < 0.015).all()
