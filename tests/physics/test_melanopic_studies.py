"""Melanopic light of whole studies: against fine bands, and a closed form of the room.

In a room of greys, indoor light has the spectrum of the sky, and the melanopic EDI is
the same in two bands as in twenty.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.control.bright_period import bright_states
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import band_means, band_set, light_in_bands
from clerestory.spectral.colour_temperature import colour_temperature, tristimulus
from clerestory.spectral.functions import spectral_function
from clerestory.spectral.spectrum_file import format_spectrum, read_spectrum
from clerestory.study.config import read_study
from clerestory.study.study_run import run_study

ROOM = Path(__file__).parents[1] / "cli" / "room"

# Absorbs blue: varnished wood
WOOD = "nm reflectance\n380 .15\n450 .2\n500 .3\n550 .5\n600 .65\n780 .7\n"


@pytest.fixture
def study(tmp_path):
    """Run the test room in given bands, and return its results."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    (folder / "wood.txt").write_text(WOOD)
    file = folder / "study.toml"
    text = file.read_text()

    def run(
        bands,
        *,
        spectrum="",
        method="3-phase",
        sky="",
        window="",
        again="",
        output="",
        layer='bsdf = "diffuser.xml"\n',
    ):
        keys = f'[scene]\nbands = "{bands}"\n'
        changed = text.replace("[scene]\n", keys).replace("3-phase", method)
        changed = changed.replace("[[window]]", f"{spectrum}\n[[window]]", 1)
        changed = changed.replace('bsdf = "diffuser.xml"\n', layer)
        file.write_text(changed.replace("[sky]\n", f"[sky]\n{sky}\n"))
        changed = file.read_text().replace("[[window]]\n", f"[[window]]\n{window}\n")
        changed = changed.replace("[output]\n", f"[output]\n{output}\n")
        file.write_text(changed)
        name = f"{bands}-{method}-{len(spectrum)}-{len(sky)}-{len(window)}{again}"
        return run_study(read_study(file), out=tmp_path / name).data

    return run


def spectral_layer(folder, bands):
    """Diffusers of wood at three wavelengths, in the place of the diffuser."""
    parts = {"450 nm": 0.2, "550 nm": 0.5, "650 nm": 0.67, "visible": 0.5}
    layers = {c: lambertian(share, klems("quarter")) for c, share in parts.items()}
    functions = {
        (c, name): layer.function(name)
        for c, layer in layers.items()
        for name in FUNCTIONS
    }
    write_bsdf(folder / "diffuser.xml", Bsdf(functions))
    means = Spectrum(np.array([450.0, 550.0, 650.0]), np.array([0.2, 0.5, 0.67]))
    return band_means(means, band_set(bands))


@pytest.mark.parametrize("method", ["3-phase", "5-phase", "2-phase"])
def test_spectral_layers_colour_all_light_of_a_white_sky(study, tmp_path, method):
    """Under D65 in a grey room, light has the transmittance of the layer as spectrum.

    Illuminance and EDI are those of a grey layer, times the weighted transmittance.
    """
    sky = 'daylight = {sky = "d65", sun = "d65"}'
    grey = study("melanopic+photopic", method=method, sky=sky)
    melanopic, photopic = spectral_layer(tmp_path / "study", "melanopic+photopic")
    data = study("melanopic+photopic", method=method, sky=sky, again="spectral")
    lux = grey["illuminance"].values
    reflected = 0.02 * lux.max()
    np.testing.assert_allclose(
        data["illuminance"], lux * photopic / 0.5, rtol=0.02, atol=reflected
    )
    np.testing.assert_allclose(
        data["melanopic_edi"].sum() / data["illuminance"].sum(),
        melanopic / photopic,
        rtol=2e-3,
    )


def test_a_spectrum_beside_a_photopic_layer_tints_it(study, tmp_path):
    """The wood's spectrum as transmittance, at the same photopic transmittance."""
    sky = 'daylight = {sky = "d65", sun = "d65"}'
    plain = study("melanopic+photopic", sky=sky)
    data = study("melanopic+photopic", sky=sky, window='spectrum = "wood.txt"')
    wood = read_spectrum(tmp_path / "study" / "wood.txt")
    melanopic, photopic = band_means(wood, band_set("melanopic+photopic"))
    np.testing.assert_allclose(data["illuminance"], plain["illuminance"], rtol=1e-6)
    np.testing.assert_allclose(
        data["melanopic_edi"],
        plain["melanopic_edi"] * melanopic / photopic,
        rtol=1e-5,
    )


def of_material(name):
    return f'[[scene.spectrum]]\nmaterial = "{name}"\nfile = "wood.txt"\n'


@pytest.mark.parametrize("method", ["3-phase", "5-phase"])
def test_rooms_of_greys_keep_the_spectrum_of_the_sky(study, method):
    """Two bands and twenty agree; illuminance is that of RGB."""
    two, many = (study(name, method=method) for name in ("melanopic+photopic", "20"))
    rgb = study("RGB", method=method)
    assert "melanopic_edi" not in rgb
    lux = two["illuminance"].values
    np.testing.assert_allclose(many["illuminance"], lux, rtol=1e-3, atol=0.5)
    np.testing.assert_allclose(rgb["illuminance"], lux, rtol=5e-3, atol=0.5)
    edi = two["melanopic_edi"].values
    np.testing.assert_allclose(many["melanopic_edi"], edi, rtol=4e-3, atol=0.5)
    ratio = (edi.sum() / lux.sum()).item()
    assert 0.9 < ratio < 1.25
    assert two["melanopic_autonomy"].shape == (4,)


def test_light_of_d65_has_equal_illuminances_in_a_grey_room(study):
    """By definition of the equivalent daylight illuminance."""
    sky = 'daylight = {sky = "d65", sun = "d65"}'
    data = study("melanopic+photopic", sky=sky)
    np.testing.assert_allclose(data["melanopic_edi"], data["illuminance"], rtol=2e-3)


def test_wood_takes_melanopic_light(study):
    """All walls of wood, the worst case for two bands: within 6 % of twenty."""
    wood = of_material("grey")
    two = study("melanopic+photopic", spectrum=wood)
    many = study("20", spectrum=wood)
    grey = study("20")
    ratios = [
        float(d["melanopic_edi"].sum() / d["illuminance"].sum())
        for d in (two, many, grey)
    ]
    assert ratios[1] < 0.92 * ratios[2]
    assert ratios[0] == pytest.approx(ratios[1], rel=0.06)
    np.testing.assert_allclose(two["illuminance"], many["illuminance"], rtol=0.06)


def test_built_in_spectra_are_those_of_files(study, tmp_path):
    """Walls of pine by name, and by a file of the same values."""
    by_name = of_material("grey").replace("wood.txt", "library:pine")
    named = study("melanopic+photopic", spectrum=by_name)
    pine = read_spectrum("library:pine")
    (tmp_path / "study" / "wood.txt").write_text(format_spectrum(pine, "reflectance"))
    filed = study("melanopic+photopic", spectrum=of_material("grey"))
    for name in ("illuminance", "melanopic_edi"):
        np.testing.assert_allclose(named[name], filed[name], rtol=1e-5)


@pytest.mark.parametrize(
    ("bands", "spectrum", "words"),
    [
        ("purple", "", "set of bands"),
        ("melanopic", "", "photopic"),
        ("RGB", of_material("grey"), "bands RGB"),
        ("20", of_material("grey") * 2, "two spectra"),
        ("20", of_material("gold"), 'no material "gold"'),
        (
            "20",
            of_material("grey").replace("wood.txt", "library:pin"),
            "such as pine",
        ),
    ],
)
def test_impossible_bands_are_errors(study, bands, spectrum, words):
    with pytest.raises(InputError, match=words):
        study(bands, spectrum=spectrum)


SPECTRAL = 'spectral = ["GRID"]'


def test_light_of_d65_has_its_colour_and_renders_all_colours(study, tmp_path):
    """D65 in a grey room: 6504 K, Ra 100, five illuminances equal to the photopic."""
    grid = next(iter(read_study(tmp_path / "study" / "study.toml").sensors)).label
    sky = 'daylight = {sky = "d65", sun = "d65"}'
    data = study("81", sky=sky, output=SPECTRAL.replace("GRID", grid))
    lit = data["eye_illuminance"].values > 0
    assert data["colour_temperature"].values[lit] == pytest.approx(6504, abs=12)
    assert data["duv"].values[lit] == pytest.approx(0.0032, abs=2e-4)
    assert data["colour_rendering"].values[lit] == pytest.approx(100, abs=0.1)
    assert data["colour_rendering_red"].values[lit] == pytest.approx(100, abs=0.3)
    lux = data["eye_illuminance"].values[lit]
    for edi in data["edi"].values:
        np.testing.assert_allclose(edi[lit], lux, rtol=5e-3)
    assert np.isnan(data["colour_temperature"].values[~lit]).all()
    # Light of one colour has an error of intensity, and none of colour
    assert np.nanmax(data["colour_temperature_error"].values) < 5
    names = data["eye"].values
    error = data["melanopic_edi_error"].sel(sensor=names).values
    own = data["edi_error"].sel(photoreceptor="melanopic").values
    np.testing.assert_allclose(own, error, rtol=1e-3, atol=1e-4)
    out = next(tmp_path.glob("81-*"))
    head, first, *_ = (out / "spectral.csv").read_text().splitlines()
    assert head.startswith("eye,time,illuminance [lux],melanopic EDI [lux]")
    assert len(first.split(",")) == len(head.split(","))
    assert "within" in data.attrs["band_errors"]


def test_two_weightings_have_one_photoreceptor_and_no_colour(study, tmp_path):
    grid = next(iter(read_study(tmp_path / "study" / "study.toml").sensors)).label
    output = SPECTRAL.replace("GRID", grid)
    data = study("melanopic+photopic", output=output)
    assert data["photoreceptor"].values.tolist() == ["melanopic"]
    assert "colour_temperature" not in data


LAMP = """
void light lamp 0 0 3 20 30 25
lamp polygon panel 0 0 12 1 2 2.9 1 3 2.9 3 3 2.9 3 2 2.9
"""
LIT = """
[[luminaire]]
file = "lamp.rad"
power = 100
spectrum = "lamp.csv"

[[lighting]]
control = "none"
grid = "desk"
"""


def illuminant(kelvin):
    """Lines of the spectrum of a black body."""
    nm = np.arange(380, 781, 5.0)
    power = (nm / 560) ** -5 / np.expm1(1.4388e7 / (nm * kelvin))
    return "".join(f"{w:g},{p:.6g}\n" for w, p in zip(nm, power, strict=True))


@pytest.mark.parametrize("bands", ["melanopic+photopic", "20"])
def test_electric_light_has_the_spectrum_of_its_lamps(study, tmp_path, bands):
    """Illuminant A in a grey room: a melanopic efficacy ratio of 0.496 (CIE S 026).

    Days with both lights are no fewer than those with daylight alone.
    """
    folder = tmp_path / "study"
    (folder / "lamp.rad").write_text(LAMP)
    (folder / "lamp.csv").write_text(illuminant(2856.0))
    data = study(bands, spectrum=LIT)
    lux, edi = data["electric_illuminance"], data["electric_melanopic_edi"]
    assert lux.max() > 100
    lit = lux.values > 1
    ratio = edi.values[lit] / lux.values[lit]
    np.testing.assert_allclose(ratio, 0.496, rtol=0.01)
    for name in ("melanopic_days", "low_melanopic_days"):
        assert (data[f"total_{name}"] >= data[name]).all()
        assert f"total_{name}_error" in data
    page = next(tmp_path.glob(f"{bands}-*"))
    assert "with electric light" in (page / "metrics.csv").read_text()


def test_the_spectrum_at_eyes_has_the_light_of_lamps(study, tmp_path):
    """Illuminant A and daylight in a grey room, each hour; nights have lamps alone."""
    folder = tmp_path / "study"
    (folder / "lamp.rad").write_text(LAMP)
    (folder / "lamp.csv").write_text(illuminant(2856.0))
    output = SPECTRAL.replace("GRID", "desk")
    data = study("20", spectrum=LIT, output=output)
    names = data["eye"].values
    own, total = (data[n].sel(photoreceptor="melanopic") for n in ("edi", "total_edi"))
    added = data["electric_melanopic_edi"].sel(sensor=names).values
    np.testing.assert_allclose(total - own, added, rtol=1e-4, atol=1e-2)
    lamps = data["electric_illuminance"].sel(sensor=names).values > 1
    alone = lamps & (data["eye_illuminance"].values == 0)
    both = lamps & (data["eye_illuminance"].values > 1)
    assert both.any()
    kelvin = data["total_colour_temperature"].values
    assert kelvin[alone] == pytest.approx(2856, rel=0.01)
    assert (kelvin[both] < data["colour_temperature"].values[both]).all()
    assert (kelvin[both] > 2856 * 0.99).all()
    head, first, *_ = next(tmp_path.glob("20-*/spectral.csv")).read_text().splitlines()
    assert "melanopic EDI with electric light [lux]" in head
    assert len(first.split(",")) == len(head.split(","))


def test_lamps_without_spectrum_give_illuminance_only(study, tmp_path):
    """White ones, whose light is the same in all bands."""
    white = LAMP.replace("20 30 25", "25 25 25")
    (tmp_path / "study" / "lamp.rad").write_text(white)
    without = LIT.replace('spectrum = "lamp.csv"\n', "")
    data = study("melanopic+photopic", spectrum=without)
    assert data["electric_illuminance"].max() > 100
    assert "electric_melanopic_edi" not in data


@pytest.mark.parametrize(
    ("text", "words"),
    [("400,0\n700,0\n", "no visible light"), ("400,1\n700,-1\n", "0 or more")],
)
def test_lamps_without_light_are_errors(study, tmp_path, text, words):
    folder = tmp_path / "study"
    (folder / "lamp.rad").write_text(LAMP)
    (folder / "lamp.csv").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        study("melanopic+photopic", spectrum=LIT)
    assert "lamp.csv" in str(caught.value)


CONTROLLED = """
[[window.state]]
name = "open"
bsdf = "diffuser.xml"
spectrum = "wood.txt"

[[window.state]]
name = "half"
bsdf = "half.xml"
spectrum = "wood.txt"

[window.control]
rule = "melanopic"
grid = "eye"
state = "half"
target_lux = TARGET
"""


def test_the_rule_melanopic_acts_in_whole_studies(study, tmp_path):
    """States and light are those that follow from a study of each state alone."""
    write_bsdf(tmp_path / "study" / "half.xml", lambertian(0.25, klems("quarter")))
    walls = of_material("grey")
    fixed = [
        study(
            "melanopic+photopic",
            spectrum=walls,
            layer=f'bsdf = "{name}.xml"\nspectrum = "wood.txt"\n',
            again=name,
        )["melanopic_edi"].sel(sensor="eye.1")
        for name in ("diffuser", "half")
    ]
    edi = np.stack([one.values for one in fixed])
    target = float(np.quantile(edi[1][edi[1] > 0], 0.5))
    layer = CONTROLLED.replace("TARGET", f"{target:.6f}")
    data = study("melanopic+photopic", spectrum=walls, layer=layer)
    times = data["time"].values
    expected = bright_states(
        edi, times, target=target, afterwards=np.ones(len(times), int)
    )
    assert set(expected) == {0, 1}
    np.testing.assert_array_equal(data["state"].values[0], expected)
    found = data["melanopic_edi"].sel(sensor="eye.1").values
    np.testing.assert_allclose(found, edi[expected, np.arange(len(times))], rtol=1e-5)


def test_the_spectrum_at_eyes_of_a_coloured_room(study):
    """Walls of wood behind tinted glass under D65, and grey walls behind the same.

    In the grey room the light is D65 times the transmittance, whose colour follows from
    the means over the bands. Wood makes the light warmer. EDI and illuminance are those
    of the other results of the same study.
    """
    common = {
        "sky": 'daylight = {sky = "d65", sun = "d65"}',
        "window": 'spectrum = "wood.txt"',
        "output": SPECTRAL.replace("GRID", "eye"),
    }
    grey = study("20", **common)
    wooden = study("20", spectrum=of_material("grey"), **common)
    bands = band_set("20")
    wood = Spectrum(*np.loadtxt(WOOD.splitlines()[1:]).T)
    tinted = light_in_bands(spectral_function("d65"), bands) * band_means(wood, bands)
    expected = colour_temperature(tristimulus(tinted, bands))
    lit = grey["eye_illuminance"].values > 0
    kelvin = grey["colour_temperature"].values[lit]
    np.testing.assert_allclose(kelvin, expected.kelvin, rtol=2e-3)
    np.testing.assert_allclose(grey["duv"].values[lit], expected.duv, atol=2e-4)
    warmer = wooden["colour_temperature"].values[lit]
    assert (warmer < kelvin - 100).all()
    for data in (grey, wooden):
        names = data["eye"].values
        own = data["edi"].sel(photoreceptor="melanopic").values
        other = data["melanopic_edi"].sel(sensor=names).values
        np.testing.assert_allclose(own, other, rtol=1e-4, atol=1e-3)
        lux = data["illuminance"].sel(sensor=names).values
        np.testing.assert_allclose(data["eye_illuminance"], lux, rtol=1e-5)


@pytest.mark.parametrize(
    ("bands", "grid", "words"),
    [("RGB", "", "spectral"), ("20", "roof", 'no grid|"roof"')],
)
def test_spectra_of_unknown_eyes_are_errors(study, bands, grid, words):
    with pytest.raises(InputError, match=words):
        study(bands, output=f'spectral = ["{grid or "x"}"]')
