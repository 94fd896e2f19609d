"""Cells of a room list all images that any of their points may see.

The lines from random points of a cell to random points of a source's image, and where
they meet the surfaces, are computed here one by one.
"""

import numpy as np
import pytest

from clerestory.engine.device import load
from clerestory.engine.smooth_faces import SmoothFaces
from clerestory.scene.model import Mirror, Polygon, Scene
from clerestory.scene.tessellate import meshes

COUNT = 40


def random_panes(rng):
    """Rectangles of all sizes and orientations around the origin."""
    panes = []
    for _ in range(COUNT):
        u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
        corner = rng.uniform(-8, 8, 3)
        u, v = u * rng.uniform(0.1, 3), v * rng.uniform(0.1, 3)
        panes.append(
            Polygon(np.array([corner, corner + u, corner + u + v, corner + v]), "m")
        )
    return panes


def meets(start, image, pane, *, distant):
    """Whether lines from points to images, or in their directions, meet a rectangle."""
    corner, u, v = pane[0], pane[1] - pane[0], pane[3] - pane[0]
    towards = image if distant else image - start
    normal = np.cross(u, v)
    distance = ((corner - start) @ normal) / np.sum(towards * normal, axis=1)
    place = start + distance[:, None] * towards - corner
    inside = (
        (place @ u > 0) & (place @ u < u @ u) & (place @ v > 0) & (place @ v < v @ v)
    )
    return inside & (distance > 0) & (distant | (distance < 1))


@pytest.mark.parametrize("distant", [True, False])
@pytest.mark.parametrize("radius", [0.005, 0.3])
def test_no_image_is_left_out(distant, radius):
    module, images = (load("cpu", name) for name in ("image_cells", "mirror_images"))
    rng = np.random.default_rng(1)
    panes = random_panes(rng)
    scene = Scene({"m": Mirror("m", np.ones(3))}, tuple(panes))
    (mesh,) = meshes(scene)
    faces = SmoothFaces.of(len(mesh.faces), [(0, mesh)], np.zeros(3))
    reach = images.MirrorImages.of(faces, distant=distant).reach
    centre = np.array([[0.3, -0.5, 0.8], [-0.6, 0.1, 0.5]])
    if distant:
        centre /= np.linalg.norm(centre, axis=1, keepdims=True)
    sources = module.Sources(centre, np.full(2, radius))
    cells = module.ImageCells.around(rng.uniform(-4, 4, (50, 3)), 60)
    seen = reach.seen(cells, sources)[:-1]
    size = np.array(cells.size).ravel()

    # Images by one reflection, in the order of the planes
    of_plane = faces.planes(distant=distant).of_face[mesh.surface.argsort()]
    missed, listed = 0, 0
    for number, pane in enumerate(panes):
        state = int(of_plane[2 * number])
        for index, middle in enumerate(cells.centre):
            start = middle + size * rng.uniform(-0.5, 0.5, (400, 3))
            away = rng.normal(size=(400, 3))
            away *= (
                radius
                * rng.uniform(0, 1, (400, 1))
                / np.linalg.norm(away, axis=1, keepdims=True)
            )
            point = centre[rng.integers(2, size=400)] + away
            image = point @ reach.linear[state].T + reach.shift[state]
            some = meets(start, image, pane.vertices, distant=distant).any()
            listed += seen[index, state] > 0
            missed += some and not seen[index, state] > 0
    assert missed == 0
    assert listed < 0.8 * COUNT * len(cells.centre)
