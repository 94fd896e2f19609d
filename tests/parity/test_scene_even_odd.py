"""Triangles stand exactly where Radiance's rtrace meets the polygon."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.proximity import first_hits
from clerestory.scene.tessellate import meshes

pyradiance = pytest.importorskip("pyradiance")
ROOT = Path(pyradiance.__file__).parent


def run(words, data=b""):
    environment = {**os.environ, "RAYPATH": f".:{ROOT / 'lib'}"}
    program = [str(ROOT / "bin" / words[0]), *words[1:]]
    return subprocess.run(
        program, input=data, env=environment, capture_output=True, check=True
    ).stdout


def polygon_text(name, vertices):
    numbers = " ".join(f"{v:.9f}" for v in vertices.ravel())
    return f"grey polygon {name} 0 0 {vertices.size} {numbers}\n"


def contours():
    rim = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], dtype=float)
    hole = np.array([[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]], dtype=float)
    yield "wound_alike", np.concatenate([rim, hole])
    yield "wound_against", np.concatenate([rim, hole[::-1]])
    rng = np.random.default_rng(4)
    for i in range(6):
        yield f"crossing_{i}", 4 * rng.random((5 + 2 * i, 2))


@pytest.mark.parametrize(("name", "contour"), list(contours()))
def test_rays_meet_triangles_where_they_meet_radiance_polygons(tmp_path, name, contour):
    vertices = np.column_stack([contour, np.zeros(len(contour))])
    file = tmp_path / "polygon.rad"
    text = "void plastic grey 0 0 5 .5 .5 .5 0 0\n" + polygon_text(name, vertices)
    file.write_text(text)
    octree = tmp_path / "polygon.oct"
    octree.write_bytes(run(["oconv", str(file)]))

    rng = np.random.default_rng(1)
    points = np.column_stack([4 * rng.random((500, 2)), np.ones(500)])
    rays = np.column_stack([points, np.tile([0.0, 0.0, -1.0], (500, 1))])
    lines = "".join(" ".join(f"{x:.9f}" for x in ray) + "\n" for ray in rays)
    out = run(["rtrace", "-h", "-ab", "0", "-oL", str(octree)], lines.encode())
    theirs = np.array(out.split(), dtype=float) < 1e5

    [mesh] = meshes(read_rad(file))
    corner = mesh.vertices[mesh.faces]
    ours = [first_hits(p, np.array([[0.0, 0, -1]]), corner)[0] < 1e5 for p in points]
    assert theirs.any()
    np.testing.assert_array_equal(ours, theirs)
