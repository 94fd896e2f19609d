"""Built-in products as layers of glazing systems: same layers, same numbers."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.klems import klems
from clerestory.library.bsdf_source import read_bsdf
from clerestory.library.layer_source import read_layer, read_layers
from clerestory.library.system_file import read_system

NAME = "library:double-clear-6+polyester-55"


@pytest.fixture
def system(tmp_path):
    """Write layers in TOML and read them."""

    def read(*layers):
        path = tmp_path / "system.toml"
        path.write_text("".join(f"[[layer]]\n{layer}\n" for layer in layers))
        return read_system(path)

    return read


def test_a_system_of_built_in_products_is_the_built_in_stack(system):
    """Panes and film in one name, or as layers of a file: equal transmittances."""
    given = system('file = "library:double-clear-6"', 'file = "library:polyester-55"')
    stacked = stack_layers(given.layers, method="bands", partition=klems("full")).bsdf
    expected = read_bsdf(NAME)
    np.testing.assert_allclose(
        stacked.direct_hemispherical(), expected.direct_hemispherical(), rtol=1e-9
    )


def test_a_flipped_product_of_several_layers_is_reversed(system):
    plain = read_layers("library:double-lowe-6")
    turned = system('file = "library:double-lowe-6"\nflipped = true').layers
    emissivities = [layer.emissivities for layer in plain]
    assert emissivities[0] != emissivities[1]
    assert [layer.emissivities for layer in turned] == [
        pair[::-1] for pair in reversed(emissivities)
    ]


def test_a_product_of_several_layers_is_not_one_layer():
    with pytest.raises(InputError, match="has 2 layers; one expected"):
        read_layer("library:double-clear-6")


def test_an_unknown_product_is_named_with_its_layer(system):
    with pytest.raises(InputError, match=r"layer 1: no built-in BSDF is named"):
        system('file = "library:none"')
