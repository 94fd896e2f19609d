"""Short files that describe very much are counted before they are expanded.

Each case runs in a process of its own, whose memory is limited to a gigabyte more than
the imports need.
"""

import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from expansion_cases import CASES

from clerestory.radiance.rad_reader import read_rad

SCRIPT = Path(__file__).with_name("expansion_cases.py")

# Large input that is read, or checked element by element: seconds of processor time
READ = {
    "obj_star_of_40000": 15,
    "obj_many_scribbles": 15,
    "legal_array": 4,
    "mgf_face_of_600000": 2,
    "gltf_triangles_used_300000_times": 12,
    "legal_array_of_boxes": 8,
    "legal_array_with_its_material": 4,
}
LINEAR = {
    "mgf_round_face_of_250000": 15,
    "toml_of_many_tables": 6,
    "json_names_taken": 6,
    "names_defined_again": 8,
}
REFUSED_S = 2


def _limited():
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))


@pytest.mark.parametrize("name", CASES)
def test_what_grows_exponentially_is_refused_at_once(name):
    done = subprocess.run(
        [sys.executable, SCRIPT, name],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        preexec_fn=_limited,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout)
    assert found["megabytes"] < 1000
    assert found["seconds"] < (READ | LINEAR).get(name, REFUSED_S), found
    assert found["outcome"].startswith("read: " if name in READ else "refused: "), found
    assert "\n" not in found["outcome"]


def test_copies_are_where_the_options_put_them(tmp_path):
    """Copy i of the first array and j of the second is at (2i, 3j), and named so."""
    (tmp_path / "a.rad").write_text(
        "void plastic m 0 0 5 .5 .5 .5 0 0\n"
        "!xform -n x -a 40 -t 2 0 0 -a 30 -t 0 3 0 b.rad\n"
    )
    (tmp_path / "b.rad").write_text("m polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n")
    surfaces = read_rad(tmp_path / "a.rad").surfaces
    corner = np.array([each.vertices[0] for each in surfaces]).reshape(40, 30, 3)
    i, j = np.meshgrid(np.arange(40), np.arange(30), indexing="ij")
    assert np.array_equal(corner, np.stack([2 * i, 3 * j, 0 * i], axis=-1))
    assert surfaces[31].name == "x.1.1.p"


def test_mirrored_copies_keep_their_front(tmp_path):
    """Every other copy of a mirrored array is turned over, so that +z stays +z."""
    (tmp_path / "a.rad").write_text(
        "void plastic m 0 0 5 .5 .5 .5 0 0\n!xform -a 4 -mx b.rad\n"
    )
    (tmp_path / "b.rad").write_text("m polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n")
    for surface in read_rad(tmp_path / "a.rad").surfaces:
        one, two = np.diff(surface.vertices, axis=0)
        assert np.cross(one, two)[2] == 1


def test_a_name_with_two_meanings_keeps_both_in_every_copy(tmp_path):
    """A file that defines a name twice is copied item by item."""
    grey = "void plastic m 0 0 5 {0} {0} {0} 0 0\nm polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"
    (tmp_path / "b.rad").write_text(grey.format(0.2) + grey.format(0.7))
    (tmp_path / "a.rad").write_text("!xform -a 3 -t 0 0 1 b.rad\n")
    scene = read_rad(tmp_path / "a.rad")
    values = [scene.materials[s.material].reflectance[0] for s in scene.surfaces]
    assert values == [0.2, 0.7] * 3
