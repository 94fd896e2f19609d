"""Every material has a colour for drawings, and is opaque or not."""

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    Glass,
    Glow,
    Illum,
    Interface,
    Light,
    Metal,
    Mirror,
    Mixture,
    Plastic,
    Polygon,
    Scene,
    Spotlight,
    Trans,
    Void,
    display_colour,
)
from clerestory.study.drawing import room_drawing

RED = np.array([0.8, 0.2, 0.1])
WHITE = np.ones(3)
UP = np.array([0.0, 0, 1])
ROUGH = np.array([0.1, 0.2])
PLASTIC, GLASS = Plastic("", RED), Glass("", RED)

CASES = {
    "plastic": (PLASTIC, RED, True),
    "metal": (Metal("", RED), RED, True),
    "plastic2": (Plastic("", RED, 0.1, ROUGH, up=UP), RED, True),
    "metal2": (Metal("", RED, 0.1, ROUGH, up=UP), RED, True),
    "trans": (Trans("", RED, transmission=0.5), RED, False),
    "trans that passes nothing": (Trans("", RED), RED, True),
    "trans2": (Trans("", RED, 0.1, ROUGH, 0.5, 0.5, up=UP), RED, False),
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
    assert np.clip(display_colour(material), 0, 1) == pytest.approx(shown)
    assert material.opaque is opaque


def test_drawings_show_reflectances_beyond_one_as_white():
    floor = Polygon(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]), "bright", "floor")
    scene = Scene({"bright": Plastic("bright", 2 * WHITE)}, (floor,))
    assert room_drawing(scene)["triangle_colour"].values.tolist() == [[1, 1, 1]]
