"""An integrating cube with spectral walls, against its radiosity solution.

Five walls of a cube reflect diffusely, the sixth is a window of uniform radiance. The
reference solves the series of reflections between patches of the walls, with exact
form factors from points to patches (Lambert), and extrapolates to small patches.
"""

import numpy as np
import pytest
from physics_scenes import box, sensor

import clerestory as cl
from clerestory.scene.model import Plastic, Scene
from clerestory.spectral.band_sets import band_set

NINE = band_set("9")
REFLECTANCE = np.array([0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.85, 0.9, 0.95])
CENTRE, UP = np.full(3, 0.5), np.array([0.0, 0.0, 1.0])


def patches(count):
    """Centres, inward normals and corners of the patches of a unit cube, window first.

    The window is the face y = 0.
    """
    at = np.arange(count) / count
    u, v = (part.ravel() for part in np.meshgrid(at, at))
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) / count
    corners, normals = [], []
    for axis, side in ((1, 0), (1, 1), (0, 0), (0, 1), (2, 0), (2, 1)):
        face = np.full((len(u), 4, 3), float(side))
        face[..., (axis + 1) % 3] = u[:, None] + square[:, 0]
        face[..., (axis + 2) % 3] = v[:, None] + square[:, 1]
        corners.append(face)
        normals.append(np.tile((1 - 2 * side) * np.eye(3)[axis], (len(u), 1)))
    corners, normals = np.concatenate(corners), np.concatenate(normals)
    return corners.mean(axis=1), normals, corners


def form_factors(point, normal, corners):
    """Form factors from points to polygons that lie above the points' horizons."""
    rays = corners[None] - point[:, None, None]
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    following = np.roll(rays, -1, axis=2)
    across = np.cross(rays, following)
    size = np.linalg.norm(across, axis=-1)
    angle = np.arctan2(size, (rays * following).sum(axis=-1))
    along = np.einsum("ijkc,ic->ijk", across, normal)
    share = np.divide(angle * along, size, out=np.zeros_like(size), where=size > 0)
    return np.abs(share.sum(axis=-1)) / (2 * np.pi)


def irradiance_at_centre(count):
    """Irradiance of a horizontal sensor in the middle, per radiance of the window."""
    centre, normal, corners = patches(count)
    window = count**2
    walls = slice(window, None)
    between = form_factors(centre[walls], normal[walls], corners)
    own = normal[walls] @ normal.T > 0.5
    between[own] = 0
    above = centre[:, 2] > CENTRE[2]
    seen = np.where(above, form_factors(CENTRE[None], UP[None], corners)[0], 0)
    direct = np.pi * between[:, :window].sum(axis=1)
    found = []
    for rho in REFLECTANCE:
        system = np.eye(len(direct)) - rho * between[:, walls]
        irradiance = np.linalg.solve(system, direct)
        received = np.pi * seen[:window].sum() + rho * seen[walls] @ irradiance
        found.append(received)
    return np.array(found)


def cube(reflectance, bands):
    """The walls and the window of a unit cube."""
    scene, south = box(1, 1, 1, 0.5)
    walls = {"wall": Plastic("wall", np.array(reflectance))}
    return Scene(walls, scene.surfaces, bands=bands), south


@pytest.mark.slow
def test_every_band_of_an_integrating_cube_is_its_series(device):
    """Reflectances of 5 to 95 %, each band within 0.3 %."""
    coarse, fine = (irradiance_at_centre(count) for count in (4, 10))
    exact = fine + (fine - coarse) / (2.5**2 - 1)
    assert np.abs(fine / exact - 1).max() < 0.01
    scene, south = cube(REFLECTANCE, NINE)
    view = cl.view_matrix(
        scene, south, sensors=sensor(CENTRE, UP), samples=1 << 18, device=device
    )
    found = view.values[:, 0].sum(axis=-1)
    np.testing.assert_allclose(found, exact, rtol=3e-3)


def test_bands_with_white_walls_are_a_furnace(device):
    """All light that a sensor sees in these bands comes from the window: E = π.

    The other bands of the same paths are darker.
    """
    reflectance = (0.3, 1.0, 0.6, 1.0, 1.0)
    scene, south = cube(reflectance, band_set("5"))
    view = cl.view_matrix(
        scene, south, sensors=sensor(CENTRE, UP), samples=1 << 15, device=device
    )
    found = view.values[:, 0].sum(axis=-1)
    white = np.array(reflectance) == 1
    np.testing.assert_allclose(found[white], np.pi, rtol=3e-3)
    assert (found[~white] < 1.2).all()
