"""Stacks of layers: closed forms, energy, order, and the two ways to add up."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import clear_air, glass_properties, lambertian
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.layer import Diffuser, Glass
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane, grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.stack import stack_layers
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

QUARTER = klems("quarter")


def step_pane(below, above):
    """A pane that passes one share below 550 nm and another above."""
    wavelength = np.array([300.0, 549.0, 551.0, 2500.0])
    t = np.array([below, below, above, above])
    none = np.zeros(4)
    return Glass(Pane("step", wavelength, Optics(t, t, none, none), coated=True))


def blind(tilt_deg=30.0):
    slats = SlatGeometry(width=0.05, spacing=0.04, tilt=np.radians(tilt_deg))
    return VenetianBlind(grey_pane(0.1, 0.6), slats)


@pytest.mark.parametrize("panes", [1, 2, 3])
def test_clear_panes_equal_fresnel_and_its_series(clear, panes):
    """Radiance's glass, pane after pane, at the middle of each patch."""
    t0, r0 = glass_properties(np.array(1.0), transmissivity=0.97, index=1.52)
    shares = [np.full(2, float(share)) for share in (t0, t0, r0, r0)]
    glass = Glass(Pane("glass", np.array([300.0, 2500.0]), Optics(*shares)))
    stacked = stack_layers([glass] * panes, partition=QUARTER)
    t, r = glass_properties(
        QUARTER.centres()[:, 2], transmissivity=0.97, index=1.52, panes=panes
    )
    assert np.allclose(stacked.direct_hemispherical("transmission_front"), t, atol=1e-9)
    assert np.allclose(stacked.direct_hemispherical("reflection_back"), r, atol=1e-9)


def test_diffusers_follow_the_geometric_series():
    """Two sheets of T .5, R .2: T = .25/(1 - .04), R = .2 + .25·.2/(1 - .04)."""
    stacked = stack_layers([Diffuser(grey_pane(0.5, 0.2))] * 2, partition=QUARTER)
    for channel in ("visible", "solar"):
        t = stacked.diffuse("transmission_front", channel=channel)
        r = stacked.diffuse("reflection_back", channel=channel)
        assert t == pytest.approx(0.25 / 0.96, abs=1e-12)
        assert r == pytest.approx(0.2 + 0.25 * 0.2 / 0.96, abs=1e-12)


def test_absorption_in_a_pair_of_diffusers():
    """Outer keeps .3 (1 + .5·.2/.96), inner .3·.5/.96, of light from outside."""
    stacked = stack_layers([Diffuser(grey_pane(0.5, 0.2))] * 2, partition=QUARTER)
    kept = stacked.absorptance["visible", "front"][:, 0]
    assert kept == pytest.approx([0.3 * (1 + 0.1 / 0.96), 0.15 / 0.96], abs=1e-12)
    back = stacked.absorptance["visible", "back"][:, 0]
    assert back == pytest.approx(kept[::-1], abs=1e-12)


def test_air_changes_nothing(clear):
    air = BsdfLayer(with_solar(clear_air(QUARTER)))
    alone = stack_layers([blind()], partition=QUARTER)
    between = stack_layers([air, blind(), air], partition=QUARTER)
    for name in FUNCTIONS:
        assert np.allclose(
            between.bsdf.function(name).values, alone.bsdf.function(name).values
        )


def with_solar(bsdf):
    """The same layer in the solar channel too."""
    functions = dict(bsdf.functions)
    functions |= {("solar", n): part for (_, n), part in bsdf.functions.items()}
    return type(bsdf)(functions, bsdf.product)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_no_light_is_lost_or_made(clear, count):
    layers = [Glass(clear), blind(), Diffuser(grey_pane(0.4, 0.3)), Glass(clear)][
        :count
    ]
    stacked = stack_layers(layers, partition=QUARTER)
    for channel in ("visible", "solar"):
        for side in ("front", "back"):
            passed = sum(
                stacked.direct_hemispherical(f"{kind}_{side}", channel=channel)
                for kind in ("transmission", "reflection")
            )
            kept = stacked.absorptance[channel, side].sum(axis=0)
            assert np.allclose(passed + kept, 1, atol=1e-9)


def test_a_stack_of_reciprocal_layers_is_reciprocal(clear):
    """T of the front is the reverse of T of the back (Helmholtz)."""
    layers = [Glass(clear), Diffuser(grey_pane(0.4, 0.3)), Glass(clear)]
    bsdf = stack_layers(layers, partition=QUARTER).bsdf
    front = bsdf.functions["visible", "transmission_front"]
    back = bsdf.functions["visible", "transmission_back"]
    assert np.allclose(front.reciprocal().values, back.values, atol=1e-12)


def test_stacking_is_associative(clear):
    layers = [Glass(clear), blind(), Glass(clear)]
    whole = stack_layers(layers, partition=QUARTER, method="bands").bsdf
    pair = BsdfLayer(stack_layers(layers[:2], partition=QUARTER, method="bands").bsdf)
    again = stack_layers([pair, layers[2]], partition=QUARTER, method="bands").bsdf
    for name in FUNCTIONS:
        assert np.allclose(whole.function(name).values, again.function(name).values)


def test_a_flipped_stack_is_the_stack_from_behind(clear):
    """Turned about the vertical axis, right becomes left and outside inside."""
    layers = [Glass(clear), blind()]
    whole = BsdfLayer(stack_layers(layers, partition=QUARTER).bsdf).flipped()
    turned = stack_layers(
        [one.flipped() for one in reversed(layers)], partition=QUARTER
    )
    for name in FUNCTIONS:
        assert np.allclose(
            whole.bsdf.function(name).values,
            turned.bsdf.function(name).values,
            atol=1e-6,
        )


def test_complementary_panes_are_dark_only_wavelength_by_wavelength():
    """Bands multiply averages; wavelengths know that no light passes both."""
    layers = [step_pane(0.8, 0.0), step_pane(0.0, 0.8)]
    exact = stack_layers(layers, partition=QUARTER)
    rough = stack_layers(layers, partition=QUARTER, method="bands")
    assert exact.diffuse("transmission_front") < 0.01
    assert rough.diffuse("transmission_front") > 0.05


def test_a_single_file_keeps_its_own_averages():
    layer = lambertian(0.5, QUARTER, reflectance=0.2)
    functions = dict(layer.functions)
    darker = lambertian(0.2, QUARTER, reflectance=0.2)
    functions |= {("solar", n): part for (_, n), part in darker.functions.items()}
    both = BsdfLayer(type(layer)(functions))
    stacked = stack_layers([both], partition=QUARTER)
    assert stacked.diffuse("transmission_front") == pytest.approx(0.5)
    assert stacked.diffuse("transmission_front", channel="solar") == pytest.approx(0.2)


def test_a_file_without_solar_data_says_so():
    with pytest.warns(ClerestoryWarning, match="no solar data; its visible data"):
        BsdfLayer(lambertian(0.5, QUARTER))


def test_the_stack_is_written_and_read_back(tmp_path, clear):
    bsdf = stack_layers([Glass(clear), blind()], partition=klems("half")).bsdf
    write_bsdf(tmp_path / "system.xml", bsdf)
    back = read_bsdf(tmp_path / "system.xml")
    assert back.channels == ("visible", "solar")
    for key, part in bsdf.functions.items():
        assert np.array_equal(part.values, back.functions[key].values)


def test_nothing_is_not_a_stack():
    with pytest.raises(InputError, match="at least one"):
        stack_layers([])
