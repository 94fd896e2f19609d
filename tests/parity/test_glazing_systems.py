"""Stacks against what LBNL's WinCalc expects, and why its wheel differs from that.

Bound: 0.5 % absolute, in the light passed on, thrown back and kept.
"""

import numpy as np
import pytest
from wincalc_systems import CLEAR, FOUR_LAYERS, SCATTERING

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.glazing import angular_dependence
from clerestory.glazing.interreflection import stack_properties
from clerestory.glazing.layer import Diffuser
from clerestory.glazing.layer_files import read_layer, read_pane
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.stack import stack_layers
from clerestory.glazing.standard import CHANNELS, nfrc
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

pytestmark = pytest.mark.filterwarnings(
    "ignore::clerestory.errors.ClerestoryWarning", "ignore::DeprecationWarning"
)

BOUND = 0.005
QUARTER = klems("quarter")
FULL = {"tinted and clear", "clear and BSDF", "two clear and BSDF"}
SLOW = {"clear and BSDF", "two clear and BSDF"}


@pytest.fixture(scope="module")
def products(shared_data):
    """Folder of LBNL's products."""
    return shared_data / "glazing" / "wincalc" / "products"


def layers_of(name, products, shared_data):
    """The layers of one of WinCalc's examples, as its tests build them."""

    def layer(file):
        return read_layer(products / file)

    clear = layer("CLEAR_3.json")
    white = read_pane(products / "pella_white_venetian_blind_slat.json")
    slats = {"spacing": 0.07, "tilt": np.radians(45)}
    match name:
        case "laminate and clear":
            return [layer("nfrc_18000.json"), clear]
        case "clear and even cloth":
            return [clear, Diffuser(white)]
        case "screen and clear":
            holes = (0.02, 0.03), (0.002, 0.003)
            return [PerforatedScreen(white, "rectangular", *holes), clear]
        case "woven and clear":
            return [WovenShade(white, 0.002, 0.003), clear]
        case "blind of a file and clear":
            return [layer("cgdb_3001.json"), clear]
        case "blind and clear":
            return [VenetianBlind(white, SlatGeometry(width=0.05, **slats)), clear]
        case "upright curved blind and clear":
            # WinCalc leaves these slats level: its directional blinds ignore `vertical`
            curved = SlatGeometry(
                width=0.03, spacing=0.08, tilt=np.radians(45), curvature_radius=0.03
            )
            return [VenetianBlind(white, curved), clear]
        case "tinted and clear":
            return [layer("igsdb_product_10693.json"), layer("igsdb_product_364.json")]
    panes = [clear] * (2 if name == "two clear and BSDF" else 1)
    return [*panes, read_layer(shared_data / "bsdf" / "frads" / "2011-SA1.xml")]


NAMES = [
    pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else [])
    for name in dict.fromkeys(name for name, _ in SCATTERING)
]


@pytest.mark.parametrize("name", NAMES)
def test_stacks_are_what_wincalc_expects(products, shared_data, name):
    """Along the normal and in diffuse light, in both bands, and layer by layer."""
    partition = klems("full") if name in FULL else QUARTER
    stacked = stack_layers(layers_of(name, products, shared_data), partition=partition)
    for channel in CHANNELS:
        normal, diffuse, kept = SCATTERING[name, channel]
        for function, along, even in zip(FUNCTIONS, normal, diffuse, strict=True):
            shares = stacked.direct_hemispherical(function, channel=channel)
            assert shares[0] == pytest.approx(along, abs=BOUND)
            in_all = stacked.diffuse(function, channel=channel)
            assert in_all == pytest.approx(even, abs=BOUND)
        for side, theirs in zip(("front", "back"), kept, strict=True):
            ours = stacked.absorptance[channel, side][:, 0]
            assert ours == pytest.approx(theirs, abs=BOUND)


@pytest.mark.parametrize("case", CLEAR)
def test_panes_are_what_wincalc_expects_at_their_own_angle(products, case):
    name, channel, angle = case
    first = "nfrc_2191.json" if name.startswith("low-e") else "CLEAR_3.json"
    panes = [read_layer(products / file).material for file in (first, "CLEAR_3.json")]
    wavelength = np.unique(np.concatenate([p.wavelength_nm for p in panes]))
    cosine = np.cos(np.radians([angle]))
    passed = stack_properties(
        [
            pane.angular(wavelength, cosine).map(lambda share: share[..., None])
            for pane in panes
        ]
    )
    weights = nfrc().band(channel).weights(wavelength)
    shares, kept = CLEAR[case]
    for function, theirs in zip(FUNCTIONS, shares, strict=True):
        ours = weights @ passed.system.of(function)[:, 0, 0]
        assert ours == pytest.approx(theirs, abs=BOUND)
    # WinCalc counts clear layers from the side that the light comes from
    for part, theirs in (
        (passed.absorbed[0], kept[0]),
        (passed.absorbed[1], kept[1][::-1]),
    ):
        assert part.reshape(2, -1) @ weights == pytest.approx(theirs, abs=BOUND)


COATED = ["nfrc_21467", "nfrc_2191", "nfrc_11561", "igsdb_product_10693"]


@pytest.mark.parametrize("name", COATED)
def test_the_wheel_takes_every_coated_pane_for_bronze_glass(
    products, monkeypatch, name
):
    """Why pywincalc 3.3.1 is up to 0.086 off WinCalc's own results for coated panes.

    Where light is oblique, the course of clear glass is for panes that pass more than
    0.645, that of bronze glass for others. WinCalc's expected results, and ours, choose
    by the transmittance at each wavelength, as Windows-CalcEngine does since commit
    d06f2ea (21 August 2025). The wheel is of October 2024 and takes bronze even for a
    pane that passes 0.858 of the sun's light. With bronze for all we meet the wheel.
    """
    engine = pytest.importorskip("pywincalc")
    file = products / f"{name}.json"
    pane = read_layer(file).material
    weights = nfrc().band("solar").weights(pane.wavelength_nm)
    theirs = (
        engine.GlazingSystem(
            [engine.convert_to_solid_layer(engine.parse_json_file(str(file)))]
        )
        .optical_method_results("SOLAR", 60, 0)
        .system_results.front.transmittance.direct_hemispherical
    )

    def ours():
        oblique = pane.angular(pane.wavelength_nm, np.array([0.5]))
        return weights @ oblique.transmission_front[:, 0]

    assert ours() > theirs + 0.002

    # Nor does it choose once for a pane, by what it passes of the sun: two of these
    # would then be taken for clear glass
    along = weights @ pane.at(pane.wavelength_nm).transmission_front
    assert (along > 0.645) == (name in ("nfrc_21467", "nfrc_2191"))
    always, never = -1.0, 2.0
    monkeypatch.setattr(angular_dependence, "_CLEAR_ABOVE", always)
    assert ours() > theirs + 0.002
    monkeypatch.setattr(angular_dependence, "_CLEAR_ABOVE", never)
    assert ours() == pytest.approx(theirs, abs=BOUND)
    assert ours() == pytest.approx(theirs, rel=1e-3)


@pytest.mark.parametrize("case", SCATTERING)
def test_shares_of_two_and_three_layers_of_wincalc_add_up(case):
    """Why its layers can be held against ours: no light is lost or made, to a digit."""
    (t_front, t_back, r_front, r_back), _, (front, back) = SCATTERING[case]
    assert t_front + r_front + sum(front) == pytest.approx(1, abs=3e-6)
    assert t_back + r_back + sum(back) == pytest.approx(1, abs=3e-6)


def test_shares_of_four_layers_of_wincalc_do_not_add_up():
    """Why its panes before a shade are not held against ours, whose shares add up."""
    total = {
        case: passed + thrown + sum(kept)
        for case, (passed, thrown, kept) in FOUR_LAYERS.items()
    }
    assert total["solar", "front"] == pytest.approx(1.0022, abs=1e-4)
    assert total["solar", "back"] == pytest.approx(1.0068, abs=1e-4)
    assert total["visible", "front"] == pytest.approx(0.9965, abs=1e-4)
    assert total["visible", "back"] == pytest.approx(1.0057, abs=1e-4)


def test_absorptance_is_what_single_bounces_leave(products, shared_data):
    """Light followed bounce by bounce through four layers, without solving for it."""
    names = "nfrc_9962.json", "CLEAR_3.json", "nfrc_11561.json"
    layers = [read_layer(products / name) for name in names]
    layers.append(read_layer(shared_data / "bsdf" / "frads" / "2011-SA1.xml"))
    measure = QUARTER.projected_solid_angles()[:, None]
    wave = np.array([450.0, 550.0, 1500.0])
    flux = [
        layer.matrices(wave, QUARTER).map(lambda f: measure * f) for layer in layers
    ]
    passed = stack_properties(flux)
    for side in ("front", "back"):
        kept, out = bounced(flux, side)
        ours = passed.absorbed[("front", "back").index(side)]
        assert ours == pytest.approx(kept, abs=1e-9)
        assert kept.sum(axis=0) + out == pytest.approx(1, abs=1e-9)


def bounced(flux, side):
    """What layers keep of light from one side, and what leaves, bounce by bounce."""
    count, shape = len(flux), flux[0].transmission_front.shape
    down, up = np.zeros((2, count + 1, *shape))
    if side == "front":
        down[0] = np.eye(shape[-1])
    else:
        up[count] = np.eye(shape[-1])
    kept, out = np.zeros((count, shape[0], shape[-1])), 0.0
    for _ in range(400):
        next_down, next_up = np.zeros_like(down), np.zeros_like(up)
        for k, layer in enumerate(flux):
            one, other = down[k], up[k + 1]
            next_down[k + 1] += layer.transmission_front @ one
            next_down[k + 1] += layer.reflection_back @ other
            next_up[k] += layer.transmission_back @ other
            next_up[k] += layer.reflection_front @ one
            kept[k] += (one + other - next_down[k + 1] - next_up[k]).sum(axis=-2)
        out = out + (next_down[count] + next_up[0]).sum(axis=-2)
        next_down[count], next_up[0] = 0, 0
        down, up = next_down, next_up
    return kept, out


@pytest.mark.parametrize(("part", "share"), [("T", 0.7), ("R", 0.1)])
def test_homogeneous_layers_of_wce_make_light(shared_data, part, share):
    """The reason for deliberate differences of up to 0.0185.

    They send share / (π - Λ) to *every* patch, with Λ of the incident one, as if the
    light that goes on straight were taken out; but it is not. In all,
    share · π / (π - Λ) leaves: 2.3 to 2.6 % more than the material passes on. Ours, and
    their own "perfectly diffusing" layers, send share / π.
    """
    measure = QUARTER.projected_solid_angles()
    name = f"TestHomogeneousDiffuseMatrix{part}f_T=0.7_R=0.1.csv"
    lines = (shared_data / "glazing" / "wce" / name).read_text().splitlines()
    rows = [line.strip().strip(",").split(",") for line in lines]
    theirs = np.array([[float(v) for v in row] for row in rows if len(row) > 1])
    assert np.abs(theirs - share / (np.pi - measure)).max() < 1e-8
    in_all = measure @ theirs
    assert in_all == pytest.approx(share * np.pi / (np.pi - measure), rel=1e-7)
    assert in_all.min() > 1.02 * share
    layer = Diffuser(grey_pane(0.7, 0.1))
    kind = "transmission" if part == "T" else "reflection"
    ours = layer.matrices(np.array([550.0]), QUARTER).of(f"{kind}_front")[0]
    assert measure @ ours == pytest.approx(share, rel=1e-12)
    assert np.abs(measure @ (theirs - ours)).max() == pytest.approx(
        share * 0.02644, rel=1e-3
    )
