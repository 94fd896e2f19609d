"""Quality checks find deliberate faults, and report nothing for sound layers."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.analytic import clear_air, lambertian, thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.quality_checks import check
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.hemisphere.klems import from_rings, klems

FULL = klems("full")
OLD_HALF = ((0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90), (1, 8, 12, 16, 20, 12, 4))


def lobes():
    """Transmission that turns light from the front upwards, as tilted slats do."""
    x, y, _ = FULL.centres().T
    across, rise = x[:, None] - x, y[:, None] - y - 0.4
    table = np.exp(-8 * (across**2 + rise**2)) * (1.2 + y)
    return ScatteringMatrix(0.3 * table / np.pi, FULL, FULL)


def layer(front, **others):
    """A layer with a transmission and its reverse, unless another back is given."""
    functions = {
        ("visible", "transmission_front"): front,
        ("visible", "transmission_back"): others.pop("back", front.reciprocal()),
    }
    for name, part in others.items():
        functions["visible", name] = part
    return Bsdf(functions)


def names(bsdf):
    return {finding.name for finding in check(bsdf) if finding.matters}


def only(bsdf, name):
    return next(finding for finding in check(bsdf) if finding.name == name)


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
@pytest.mark.parametrize(
    "make", [clear_air, lambda p: lambertian(0.4, p), lambda p: thin_pane(0.96, p)]
)
def test_sound_layers_have_nothing_that_matters(make, basis):
    bsdf = make(klems(basis))
    assert names(bsdf) == set()


def test_a_reciprocal_layer_without_symmetry_is_sound():
    assert names(layer(lobes())) <= {"order"}


def test_more_light_out_than_in_is_measured():
    """Lambertian layer of 0.7 + 0.5: 20 % too much everywhere."""
    even = np.full((145, 145), 1 / np.pi)
    bsdf = lambertian(0.7, FULL)
    functions = dict(bsdf.functions)
    functions["visible", "reflection_front"] = ScatteringMatrix(0.5 * even, FULL, FULL)
    finding = only(replace(bsdf, functions=functions), "energy")
    assert finding.size == pytest.approx(0.2)
    assert finding.severity == "error"
    assert "visible front" in finding.where


def test_reflections_on_the_wrong_sides_are_recognised():
    """Front passes 0.1 and reflects 0.85, back passes 0.6 and reflects 0.3."""
    even = np.full((145, 145), 1 / np.pi)
    share = {
        "transmission_front": 0.1,
        "transmission_back": 0.6,
        "reflection_front": 0.3,
        "reflection_back": 0.85,
    }
    bsdf = Bsdf(
        {
            ("visible", n): ScatteringMatrix(s * even, FULL, FULL)
            for n, s in share.items()
        }
    )
    finding = only(bsdf, "order")
    assert finding.size == pytest.approx(0.45)
    assert "swapped" in finding.what


def test_one_side_stronger_than_the_other_breaks_reciprocity():
    front = lobes()
    back = front.reciprocal()
    weak = replace(back, values=0.7 * back.values)
    finding = only(layer(front, back=weak), "sides")
    assert finding.size == pytest.approx(0.3)
    # The same factor in every pair of patches
    assert only(layer(front, back=weak), "reciprocity").size == pytest.approx(0.3 / 1.7)


def test_incident_azimuths_half_a_turn_off_are_recognised():
    front = lobes()
    turned = FULL.find(FULL.centres() * [-1, -1, 1])
    broken = {
        name: replace(part, values=part.values[:, turned])
        for name, part in (("front", front), ("back", front.reciprocal()))
    }
    finding = only(layer(broken["front"], back=broken["back"]), "azimuth")
    assert "half a turn" in finding.what
    assert finding.severity == "error"


def test_a_back_that_copies_the_front_is_suspicious():
    front = lobes()
    assert "copy" in names(layer(front, back=front))


def test_a_symmetric_layer_may_copy_its_back():
    assert "copy" not in names(lambertian(0.5, FULL))


@pytest.mark.parametrize("weight", ["exit", "cosine"])
def test_values_with_a_weight_in_them_are_recognised(weight):
    """Half-reciprocal files: the weight breaks reciprocity, dividing mends it."""
    quarter = klems("quarter")
    by = {
        "exit": quarter.projected_solid_angles(),
        "cosine": quarter.centres()[:, 2],
    }[weight]
    sound = lambertian(0.8, quarter, reflectance=0.1)
    functions = {
        key: replace(part, values=part.values * by[:, None])
        for key, part in sound.functions.items()
    }
    finding = only(replace(sound, functions=functions), "scaling")
    expected = {"exit": "solid angle of exit", "cosine": "cosine of exit"}[weight]
    assert expected in finding.what


def test_flux_shares_of_a_clear_layer_are_too_dark():
    """Each ring of air keeps its solid angle: only the darkness gives it away."""
    air = clear_air(FULL)
    lam = FULL.projected_solid_angles()
    functions = {
        key: replace(part, values=part.values * lam[:, None])
        for key, part in air.functions.items()
    }
    finding = only(replace(air, functions=functions), "scaling")
    assert "sum to 1.000" in finding.what
    assert finding.matters


def test_values_of_a_coarse_basis_are_no_flux_shares():
    """Five patches of a Lambertian layer of 0.2 sum to 5 · 0.2/π = 0.32."""
    limits, count = np.array([0.0, 30, 90]), np.array([1, 4])
    coarse = from_rings("Coarse", limits_deg=limits, count=count)
    assert names(lambertian(0.2, coarse)) == set()


def test_half_with_73_patches_is_a_doubtful_label():
    rings = from_rings(
        "LBNL/Klems Half",
        limits_deg=np.array(OLD_HALF[0], dtype=float),
        count=np.array(OLD_HALF[1]),
    )
    finding = only(lambertian(0.5, rings), "label")
    assert "73 patches" in finding.what
    assert finding.size == -4


def test_quarter_with_moved_rings_is_a_doubtful_label():
    rings = from_rings(
        "LBNL/Klems Quarter",
        limits_deg=np.array([0, 9, 27, 46, 66, 90], dtype=float),
        count=np.array([1, 8, 12, 12, 8]),
    )
    assert "ring limits" in only(lambertian(0.5, rings), "label").what


def test_a_dark_back_of_a_clear_layer_is_an_error():
    front = lobes()
    dark = replace(front, values=np.zeros_like(front.values))
    finding = only(layer(front, back=dark), "empty")
    assert finding.severity == "error"
    assert "transmission back" in finding.where


def test_missing_transmission_matters_and_missing_reflection_is_reported():
    even = ScatteringMatrix(np.full((145, 145), 0.1), FULL, FULL)
    assert "missing" in names(Bsdf({("visible", "reflection_back"): even}))
    found = check(Bsdf({("visible", "transmission_front"): even}))
    missing = [f for f in found if f.name == "missing"]
    assert [f.severity for f in missing] == ["info", "info"]


def test_a_solar_file_has_no_daylight():
    even = ScatteringMatrix(np.full((145, 145), 0.1), FULL, FULL)
    found = only(Bsdf({("solar", "transmission_front"): even}), "missing")
    assert "no visible channel" in found.what
    assert found.matters


def test_isotropy_and_symmetry_are_reported():
    assert only(lambertian(0.5, FULL), "isotropy").size < 1e-12
    found = only(layer(lobes()), "symmetry")
    assert found.severity == "info"
    assert "symmetric left to right" in found.what


def test_a_copied_channel_is_reported():
    visible = lambertian(0.5, FULL)
    functions = dict(visible.functions)
    functions |= {("solar", n): part for (_, n), part in visible.functions.items()}
    found = [f.what for f in check(Bsdf(functions)) if f.name == "copy"]
    assert any("solar and visible are identical" in what for what in found)


def test_a_blind_upside_down_transmits_the_sun(shared_data):
    """Slats that shade let light from below pass; turned round they let in the sun."""
    blind = read_bsdf(shared_data / "bsdf" / "pyradiance_tutorial" / "ven45.xml")
    assert names(blind) == set()
    swap = {
        "transmission_front": "transmission_back",
        "transmission_back": "transmission_front",
        "reflection_front": "reflection_back",
        "reflection_back": "reflection_front",
    }
    swapped = {(c, swap[n]): part for (c, n), part in blind.functions.items()}
    finding = only(replace(blind, functions=swapped), "order")
    assert finding.size > 5
    assert "upside down" in finding.effect


REAL = {
    "afc_fabrics/E Screen 5% White-White.xml": {"copy", "reciprocity"},
    "frads/2011-SA1.xml": {"reciprocity", "sides"},
    "frads/blinds30.xml": set(),
    "honeybee/clear.xml": set(),
    "ignis/simple_klems_spot_refl.xml": {"azimuth", "empty"},
    "ignis/simple_klems_through_front_trans.xml": {"empty"},
    "pyradiance_tutorial/clear.xml": set(),
    "pyradiance_tutorial/DiffuseGlass.xml": {"energy"},
    "pyradiance_tutorial/ven0.xml": set(),
    "radiance_test/sawtooth.xml": {"missing"},
    "wincalc/SquareSlat_genBSDF.xml": {"reciprocity"},
    "wincalc/shade_full.xml": set(),
}


@pytest.mark.parametrize("file", REAL)
@pytest.mark.filterwarnings("ignore:.*times the incident flux")
def test_real_files_have_the_faults_of_the_docs(shared_data, file):
    assert names(read_bsdf(shared_data / "bsdf" / file)) == REAL[file]
