"""Octrees and compiled meshes hold what Radiance put into them."""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from radiance import run

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Cone, Polygon, Sphere
from clerestory.scene.tessellate import meshes

MATERIALS = """void plastic red 0 0 5 .6 .1 .1 0 0
void plastic blue 0 0 5 .1 .1 .6 0 0
"""
PARTS = """void plastic grey 0 0 5 .4 .4 .4 0 0
grey polygon p 0 0 12 0 0 0 1.1 0 0 1 1 0 0 1 0
void alias dull grey
dull sphere s 0 0 4 .3 .3 1 .333333
grey cylinder c 0 0 7 0 0 0 0 0 2 .1
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("instances")
    (place / "mats.rad").write_text(MATERIALS)
    (place / "parts.rad").write_text(PARTS)
    run("oconv -f parts.rad > frozen.oct && oconv parts.rad > plain.oct", folder=place)
    n = 30
    y, x = np.divmod(np.arange(n * n), n)
    z = np.sin(x / 4) * np.cos(y / 5)
    lines = [f"v {a:.4f} {b:.4f} {c:.4f}" for a, b, c in zip(x, y, z, strict=True)]
    for half, name in enumerate(("red", "blue")):
        lines.append(f"usemtl {name}")
        cells = [
            i for i in range(n * n - n) if i % n < n - 1 and (i < 400) == (half == 0)
        ]
        lines += [f"f {i + 1} {i + 2} {i + n + 2}" for i in cells]
        lines += [f"f {i + 1} {i + n + 2} {i + n + 1}" for i in cells]
    (place / "wave.obj").write_text("\n".join(lines) + "\n")
    run("obj2mesh -a mats.rad wave.obj wave.rtm", folder=place)
    return place


def scene(folder, text):
    (folder / "main.rad").write_text(MATERIALS + text)
    return read_rad(folder / "main.rad")


def triangles(made):
    """All triangles in order, each beginning with its lowest corner."""
    rows = []
    for mesh in meshes(made):
        for corners in mesh.vertices[mesh.faces].round(3).tolist():
            first = corners.index(min(corners))
            rows.append(corners[first:] + corners[:first])
    return np.array(sorted(rows))


@pytest.mark.parametrize("octree", ["frozen.oct", "plain.oct"])
def test_instances_of_octrees_are_what_they_were_made_from(folder, octree):
    """Radiance keeps 31 bits of a number in a frozen octree."""
    text = f"void instance i 9 {octree} -rz 90 -s 2 -t 1 2 3 0 0\n"
    direct = scene(folder, "!xform -rz 90 -s 2 -t 1 2 3 parts.rad\n")
    made = scene(folder, text)
    assert [type(s) for s in made.surfaces] == [Polygon, Sphere, Cone]
    np.testing.assert_allclose(made.bounds(), direct.bounds(), atol=1e-8)
    np.testing.assert_allclose(
        made.surfaces[0].vertices, direct.surfaces[0].vertices, atol=1e-8
    )
    grey = made.materials[made.surfaces[1].material]
    np.testing.assert_allclose(grey.reflectance, 0.4, atol=1e-8)


def test_names_inside_an_instance_stay_inside(folder):
    text = "void plastic grey 0 0 5 .9 .9 .9 0 0\nvoid instance i 1 frozen.oct 0 0\n"
    text += "grey sphere after 0 0 4 0 0 9 1\n"
    made = scene(folder, text)
    assert made.materials[made.surfaces[-1].material].reflectance[0] == 0.9
    assert made.materials[made.surfaces[0].material].reflectance[0] < 0.5


@pytest.mark.parametrize("file", ["frozen.oct", "plain.oct", "wave.rtm", "wave.obj"])
def test_a_modifier_outweighs_those_inside(folder, file):
    kind = "instance" if file.endswith(".oct") else "mesh"
    made = scene(folder, f"red {kind} m 1 {file} 0 0\n")
    assert {s.material for s in made.surfaces} == {"red"}


def test_compiled_meshes_hold_the_triangles_of_their_source(folder):
    """Vertices are fractions of 2⁻³² of the mesh; materials go with their triangles."""
    compiled = scene(folder, "void mesh m 3 wave.rtm -s 2 0 0\n")
    source = scene(folder, "void mesh m 3 wave.obj -s 2 0 0\n")
    np.testing.assert_allclose(triangles(compiled), triangles(source), atol=1.1e-3)

    def faces(made, colour):
        wanted = [
            s.faces
            for s in made.surfaces
            if made.materials[s.material].reflectance[0] == pytest.approx(colour)
        ]
        return sum(len(f) for f in wanted)

    for colour in (0.6, 0.1):
        assert faces(compiled, colour) == faces(source, colour) > 0


def test_what_is_not_compiled_is_refused(folder):
    (folder / "fake.oct").write_text("#?RADIANCE\nFORMAT=Radiance_tmesh\n\nxx")
    with pytest.raises(InputError, match=r"fake\.oct: the header has no FORMAT"):
        scene(folder, "void instance i 1 fake.oct 0 0\n")
    with pytest.raises(
        InputError, match=r'main.rad:3: instance "i": the file "no.oct"'
    ):
        scene(folder, "void instance i 1 no.oct 0 0\n")
    run("oconv '!cat parts.rad' > command.oct", folder=folder)
    with pytest.raises(InputError, match="frozen octree"):
        scene(folder, "void instance i 1 command.oct 0 0\n")


@settings(max_examples=60, suppress_health_check=list(HealthCheck), deadline=None)
@given(
    st.sampled_from(["frozen.oct", "wave.rtm"]),
    st.lists(st.tuples(st.integers(0, 20_000), st.integers(0, 255)), max_size=8),
    st.integers(0, 20_000),
)
def test_damaged_files_are_read_or_refused(folder, name, changes, end):
    data = bytearray((folder / name).read_bytes())
    for place, value in changes:
        data[place % len(data)] = value
    (folder / f"damaged{name[-4:]}").write_bytes(data[: max(end, 60)])
    kind = "instance" if name.endswith(".oct") else "mesh"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ClerestoryWarning)
            scene(folder, f"void {kind} m 1 damaged{name[-4:]} 0 0\n").bounds()
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
