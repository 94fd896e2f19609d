"""Exchanges that explain the difference between two layers without symmetry."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.layer_comparison import compare
from clerestory.bsdf.resample import to_trees
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems

FULL = klems("full")


def lobes(rise, across):
    """Light that is turned by an offset, and more of it from one side."""
    x, y, _ = FULL.centres().T
    dx, dy = x[:, None] - x - across, y[:, None] - y - rise
    values = 0.2 * (1.3 + x - 0.4 * y) * np.exp(-8 * (dx**2 + dy**2))
    return ScatteringMatrix(values, FULL, FULL)


FRONT, BACK = lobes(0.4, 0.15), lobes(-0.1, 0.3)
LAYER = Bsdf(
    {
        ("visible", "transmission_front"): FRONT,
        ("visible", "transmission_back"): BACK,
    }
)


def changed(front, back=BACK):
    values = {"transmission_front": front, "transmission_back": back}
    return Bsdf({("visible", name): part for name, part in values.items()})


def order(sign_x, sign_y):
    return FULL.find(FULL.centres() * [sign_x, sign_y, 1])


HALF, SIDE = order(-1, -1), order(-1, 1)
EXCHANGES = {
    "the sides look swapped": changed(BACK, FRONT),
    "the incident azimuths look turned by 180°": changed(
        replace(FRONT, values=FRONT.values[:, HALF])
    ),
    "the layer looks turned by 180°": changed(
        replace(FRONT, values=FRONT.values[np.ix_(HALF, HALF)])
    ),
    "the layer looks mirrored left to right": changed(
        replace(FRONT, values=FRONT.values[np.ix_(SIDE, SIDE)])
    ),
    "incident and exit directions look swapped": changed(
        replace(FRONT, values=FRONT.values.T)
    ),
}


@pytest.mark.parametrize("title", EXCHANGES)
def test_exchange_is_named(title):
    noise = np.random.default_rng(3).normal(1, 0.02, (145, 145))
    functions = {
        key: replace(part, values=part.values * noise)
        for key, part in EXCHANGES[title].functions.items()
    }
    result = compare(LAYER, Bsdf(functions))
    assert result.redistributed > 0.2
    named, rest = result.exchange
    # The noise of values moves 0.02/√(2π) of the flux
    assert (named, rest) == (title, pytest.approx(0.008, abs=0.002))


def test_layers_that_differ_otherwise_have_no_exchange():
    assert compare(LAYER, LAYER).exchange is None
    assert compare(LAYER, changed(lobes(0, -0.4))).exchange is None
    assert (
        compare(LAYER, changed(replace(FRONT, values=2 * FRONT.values))).exchange
        is None
    )


def test_swapped_sides_of_trees():
    trees = to_trees(changed(BACK, FRONT), halvings=4)
    assert compare(LAYER, trees).exchange[0] == "the sides look swapped"
