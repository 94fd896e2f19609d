"""Studies of scenes in nine bands.

The scene is converted after it is read: only Python has the upsampling of colours.
"""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.scene.band_conversion import in_bands, step_spectrum
from clerestory.scene.material import with_colours
from clerestory.spectral.band_sets import wavelength_bands
from clerestory.study import method_run
from clerestory.study.config import read_study
from clerestory.study.study_run import run_study

ROOM = Path(__file__).parents[1] / "cli" / "room"
RED, GREEN, BLUE = 0.7, 0.5, 0.2

# Three bands in each step of a step spectrum
NINE = wavelength_bands((380, 420, 450, 480, 500, 550, 588, 600, 700, 780))


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    return folder / "study.toml"


def painted(scene, colour):
    """The scene with all its materials of one colour."""
    materials = {
        name: with_colours(material, lambda _: np.array(colour))
        for name, material in scene.materials.items()
    }
    return replace(scene, materials=materials)


SLOW = (pytest.param(name, marks=pytest.mark.slow) for name in ("2-phase", "5-phase"))


@pytest.mark.parametrize("method", ["3-phase", *SLOW])
def test_nine_bands_are_weighted_studies_in_grey(study, tmp_path, monkeypatch, method):
    """Walls of a step spectrum: E = Σ K E(ρ) over the three steps, over 179 lm/W."""
    text = study.read_text().replace("3-phase", method)
    study.write_text(text.replace("samples = 256", "samples = 32768"))
    read = method_run.read_inputs

    def lit(change):
        def changed(asked, **options):
            found = read(asked, **options)
            return replace(found, scene=change(found.scene))

        monkeypatch.setattr(method_run, "read_inputs", changed)
        return run_study(read_study(study), out=tmp_path / "out").data

    def spectral(scene):
        colour = painted(scene, (RED, GREEN, BLUE))
        return in_bands(colour, NINE, upsampling=step_spectrum)

    found = lit(spectral)
    expected, variance = 0.0, found["standard_error"] ** 2
    for first, reflectance in zip((0, 3, 6), (BLUE, GREEN, RED), strict=True):
        share = NINE.shares[first : first + 3].sum()
        grey = lit(lambda scene, rho=reflectance: painted(scene, (rho,) * 3))
        expected = expected + share * grey["illuminance"]
        variance = variance + (share * grey["standard_error"]) ** 2
    lit_steps = expected.values > 10
    error = np.sqrt(variance.values)[lit_steps]
    off = np.abs(found["illuminance"] - expected).values[lit_steps]
    assert lit_steps.any()
    assert (off < 4 * error + 1e-4 * expected.values[lit_steps]).all()
    assert np.median(error / expected.values[lit_steps]) < 0.05
