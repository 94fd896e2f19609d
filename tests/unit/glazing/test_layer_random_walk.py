"""The random walk between layers against matrices and closed forms."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import glass_properties
from clerestory.errors import InputError
from clerestory.glazing.layer import Diffuser, Glass
from clerestory.glazing.layer_random_walk import walk_layers
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane, grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.stack import stack_layers
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

FUNCTIONS = (
    "transmission_front",
    "transmission_back",
    "reflection_front",
    "reflection_back",
)


def test_two_panes_send_on_what_fresnel_says():
    """The exact integral over the hemisphere, which patches only approach."""
    t0, r0 = glass_properties(np.array(1.0), transmissivity=0.97, index=1.52)
    shares = [np.full(2, float(share)) for share in (t0, t0, r0, r0)]
    glass = Glass(Pane("glass", np.array([300.0, 2500.0]), Optics(*shares)))
    walked = walk_layers(
        [glass, glass], halvings=3, walkers=512, channels=["visible"], seed=2
    )
    cosine = np.sqrt((np.arange(4000) + 0.5) / 4000)
    expected = [
        share.mean()
        for share in glass_properties(cosine, transmissivity=0.97, index=1.52, panes=2)
    ]
    for name in FUNCTIONS:
        share, error = walked.diffuse["visible", name]
        truth = expected[name.startswith("reflection")]
        assert error < 0.004
        assert abs(share - truth) < 4 * error


def test_straight_light_stays_in_its_cell():
    walked = walk_layers(
        [Glass(grey_pane(1, 0))],
        halvings=3,
        walkers=64,
        channels=["visible"],
    )
    tree = walked.bsdf.functions["visible", "transmission_front"]
    towards = klems("quarter").centres()
    straight = tree.evaluate(-towards, towards)
    assert np.allclose(straight, 64 / np.pi)  # one cell of π/64 holds it all


def test_the_walk_agrees_with_matrices_where_nothing_is_specular():
    """Diffuse light through diffuser and blind; both count the same flux."""
    slats = SlatGeometry(width=0.05, spacing=0.04, tilt=0.6)
    layers = [
        Diffuser(grey_pane(0.6, 0.3)),
        VenetianBlind(grey_pane(0, 0.6), slats),
    ]
    walked = walk_layers(layers, halvings=2, walkers=1024, channels=["visible"], seed=5)
    stacked = stack_layers(layers, method="bands")
    for name in FUNCTIONS:
        share, error = walked.diffuse["visible", name]
        assert error < 0.013
        # Patches of Klems see the blind from their middles alone: 0.004
        assert abs(share - stacked.diffuse(name)) < 4 * error + 0.004


def test_errors_are_kept_and_shrink_with_walkers():
    layers = [Diffuser(grey_pane(0.5, 0.2))] * 2

    def mean_error(walkers):
        walked = walk_layers(
            layers, halvings=2, walkers=walkers, channels=["visible"], seed=1
        )
        tree = walked.bsdf.functions["visible", "transmission_front"].standard_error
        towards = klems("quarter").centres()
        return tree.evaluate(-towards, towards).mean()

    assert mean_error(16 * 64) == pytest.approx(mean_error(64) / 4, rel=0.2)


def test_the_same_seed_gives_the_same_tree():
    layers = [Diffuser(grey_pane(0.5, 0.2)), Glass(grey_pane(0.8, 0.1))]
    first, second = (
        walk_layers(layers, halvings=1, walkers=64, channels=["solar"], seed=9)
        for _ in range(2)
    )
    key = "solar", "reflection_back"
    assert np.array_equal(
        first.bsdf.functions[key].slots, second.bsdf.functions[key].slots
    )


@pytest.mark.parametrize("fault", [{"halvings": 7}, {"batches": 1}, {"walkers": 4}])
def test_requests_out_of_range_are_refused(fault):
    with pytest.raises(InputError, match="expected"):
        walk_layers([Diffuser(grey_pane(0.5, 0.2))], **fault)
