"""Every material has a colour for drawings, and is opaque or not."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.hemisphere.klems import klems
from clerestory.scene.appearance import colour, is_opaque
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    Glass,
    Glow,
    Illum,
    Interface,
    Light,
    Metal,
    Metal2,
    Mirror,
    Mixture,
    Plastic,
    Plastic2,
    Spotlight,
    Trans,
    Trans2,
    Void,
)

RED = np.array([0.8, 0.2, 0.1])
WHITE = np.ones(3)
UP = np.array([0.0, 0, 1])
ROUGH = np.array([0.1, 0.2])
PLASTIC, GLASS = Plastic("", RED), Glass("", RED)

CASES = {
    "plastic": (PLASTIC, RED, True),
    "metal": (Metal("", RED), RED, True),
    "plastic2": (Plastic2("", RED, 0.1, ROUGH, UP), RED, True),
    "metal2": (Metal2("", RED, 0.1, ROUGH, UP), RED, True),
    "trans": (Trans("", RED, transmission=0.5), RED, False),
    "trans that passes nothing": (Trans("", RED), RED, True),
    "trans2": (Trans2("", RED, 0.1, ROUGH, 0.5, 0.5, UP), RED, False),
    "glass": (GLASS, RED, False),
    "dielectric": (Dielectric("", RED, 1.5), RED, False),
    "interface": (Interface("", RED, 1.5, WHITE, 1.3), RED, False),
    "mirror": (Mirror("", RED), RED, True),
    "mirror with a pane": (Mirror("", WHITE, GLASS), RED, False),
    "void": (Void(), WHITE, False),
    "net": (Mixture("", PLASTIC, Void(), 0.5), (RED + 1) / 2, False),
    "two plastics": (Mixture("", PLASTIC, PLASTIC, 0.5), RED, True),
    "BSDF": (BsdfSurface("", lambertian(0.5, klems("full")), 0, UP), WHITE, False),
    "illum": (Illum("", RED), WHITE, False),
    "illum that looks like a wall": (Illum("", WHITE, PLASTIC), RED, True),
    "light": (Light("", RED), WHITE, True),
    "glow": (Glow("", RED), WHITE, True),
    "spotlight": (Spotlight("", RED, 30.0, UP, 0.1), WHITE, True),
}


@pytest.mark.parametrize("name", CASES)
def test_materials_have_a_colour_and_an_opacity(name):
    material, shown, opaque = CASES[name]
    assert colour(material) == pytest.approx(shown)
    assert is_opaque(material) is opaque


def test_colours_beyond_white_are_shown_white():
    assert colour(Plastic("", 2 * WHITE)).tolist() == [1, 1, 1]
