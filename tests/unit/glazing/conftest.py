"""Small products, written by the tests so that every fault can be put into them."""

import copy
import json

import numpy as np
import pytest

from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from sample_files import PRODUCT


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
