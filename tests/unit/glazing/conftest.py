"""Small products, written by the tests so that every fault can be put into them."""

import copy
import json

import numpy as np
import pytest

from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane

PRODUCT = {
    "name": "Test glass",
    "nfrc_id": 7,
    "type": "glazing",
    "subtype": "monolithic",
    "coated_side": "Neither",
    "manufacturer_name": "Nobody",
    "measured_data": {
        "thickness": 4.0,
        "conductivity": 1.0,
        "emissivity_front": 0.84,
        "emissivity_back": 0.2,
        "tir_front": 0.0,
    },
    "spectral_data": {
        "spectral_data": [
            {"T": 0.8, "Rf": 0.1, "Rb": 0.15, "wavelength": 0.3},
            {"T": 0.6, "Rf": 0.2, "Rb": 0.25, "wavelength": 2.5},
        ]
    },
}


@pytest.fixture
def product():
    """A product of version 1 of the IGSDB's JSON, to be changed at will."""
    return copy.deepcopy(PRODUCT)


@pytest.fixture
def write_json(tmp_path):
    """Write an object as JSON and return the path."""

    def to_file(content, name="glass.json"):
        path = tmp_path / name
        path.write_text(json.dumps(content))
        return path

    return to_file


@pytest.fixture(scope="session")
def clear():
    """Clear glass that passes 83 % and mirrors 7.5 %."""
    return flat_pane(0.83, 0.075, 0.075)


def flat_pane(t, rf, rb, **more):
    """A pane with the same shares at all wavelengths."""
    wavelength = np.array([300.0, 2500.0])
    shares = [np.full(2, share) for share in (t, t, rf, rb)]
    return Pane("flat", wavelength, Optics(*shares), **more)
