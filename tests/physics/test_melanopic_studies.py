"""Melanopic light of whole studies: against fine bands, and a closed form of the room.

In a room of greys, indoor light has the spectrum of the sky, and the melanopic EDI is
the same in two bands as in twenty.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
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

    def run(bands, *, spectrum="", method="3-phase", sky=""):
        keys = f'[scene]\nbands = "{bands}"\n'
        changed = text.replace("[scene]\n", keys).replace("3-phase", method)
        changed = changed.replace("[[window]]", f"{spectrum}\n[[window]]", 1)
        file.write_text(changed.replace("[sky]\n", f"[sky]\n{sky}\n"))
        name = f"{bands}-{method}-{len(spectrum)}-{len(sky)}"
        return run_study(read_study(file), out=tmp_path / name).data

    return run


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


@pytest.mark.parametrize(
    ("bands", "spectrum", "words"),
    [
        ("purple", "", "set of bands"),
        ("melanopic", "", "photopic"),
        ("RGB", of_material("grey"), "bands RGB"),
        ("20", of_material("grey") * 2, "two spectra"),
        ("20", of_material("gold"), 'no material "gold"'),
    ],
)
def test_impossible_bands_are_errors(study, bands, spectrum, words):
    with pytest.raises(InputError, match=words):
        study(bands, spectrum=spectrum)
