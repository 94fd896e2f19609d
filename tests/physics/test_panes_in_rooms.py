"""Panes between a window and what it lights pass direct light in both direct terms."""

import numpy as np
import pytest
from physics_scenes import box, quad

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.sun_coefficients import picture_sun_coefficients
from clerestory.scene.model import Glass

SUN = np.array([[0.1, -0.8, 0.6]]) / np.linalg.norm([0.1, -0.8, 0.6])
EYE = cl.parse_view("-vtv -vp 2 4.5 1.5 -vd 0 -0.9 -0.5 -vu 0 0 1 -vh 60 -vv 40")
CAMERA = Camera(EYE, 6, 4)


def rooms():
    """A grey room, and the same with a clear pane of no reflection across it."""
    room, south = box(4, 5, 3, 0.5)
    corners = (0, 1, 0), (0, 1, 3), (4, 1, 3), (4, 1, 0)
    pane = quad(*corners, material="clear")
    clear = {"clear": Glass("clear", np.ones(3), 1.0)}
    divided = type(room)({**room.materials, **clear}, (*room.surfaces, pane))
    return room, divided, south


def diffuser():
    patches = klems("quarter")
    even = np.full((len(patches), len(patches)), 0.5 / np.pi)
    found = ScatteringMatrix(even, patches, patches)
    return Bsdf({("visible", "transmission_front"): found})


def test_direct_light_of_pictures_passes_a_pane(device):
    """Both terms that the five-phase method exchanges: V_d and C_ds."""
    room, divided, south = rooms()
    sums = [
        [
            picture_view_matrices(
                scene, [south], CAMERA, direct=True, samples=1024, device=device
            )["south"].values.sum(),
            picture_sun_coefficients(
                scene, [south], "south", diffuser(), CAMERA, suns=SUN, samples=256,
                device=device,
            ).values.sum(),
        ]
        for scene in (room, divided)
    ]  # fmt: skip
    assert sums[1] == pytest.approx(sums[0], rel=0.02)
