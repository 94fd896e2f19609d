"""Included files stand where Radiance's own xform puts them."""

import os
import random
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Cone, Polygon, Ring, Sphere

pyradiance = pytest.importorskip("pyradiance")
ROOT = Path(pyradiance.__file__).parent

MATERIALS = """\
void plastic grey 0 0 5 .5 .5 .5 0 0
void plastic black 0 0 5 0 0 0 0 0
void glow shine 0 0 4 1 1 1 3
"""
SURFACES = """\
void glow warm 0 0 4 2 2 2 0.5
grey polygon wall 0 0 12 0 0 0  1 0 0  1 0.5 2  0 0.5 2
warm sphere ball 0 0 4 1 2 3 0.25
grey bubble hollow 0 0 4 -1 2 3 0.75
grey cone tip 0 0 8 0 0 1  1 1 1  0.5 0
grey cup bell 0 0 8 0 0 1  1 -1 1  0.5 1
grey cylinder post 0 0 7 2 0 0  2 0 3  0.1
grey tube pipe 0 0 7 2 1 0  2 0 3  0.2
shine ring lid 0 0 8 1 1 1  0 0.6 0.8  0 2
shine source sun 0 0 4 0 0.6 0.8 0.5
"""


def run_xform(words, folder):
    environment = {**os.environ, "RAYPATH": f".:{ROOT / 'lib'}"}
    environment["PATH"] = f"{ROOT / 'bin'}:{environment['PATH']}"
    made = subprocess.run(
        ["xform", *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return made.stdout


def random_options(rng):
    """Options in the order xform takes them: naming and turning, then moving."""
    words = []
    for option in rng.sample(["-n", "-m", "-I", "-e"], rng.randrange(3)):
        words += {"-n": ["-n", "copy"], "-m": ["-m", "shine"]}.get(option, [option])
    for _ in range(rng.randrange(1, 6)):
        words += rng.choice(
            [
                ["-t", *(f"{rng.uniform(-3, 3):.4f}" for _ in range(3))],
                [f"-r{rng.choice('xyz')}", f"{rng.uniform(-180, 180):.3f}"],
                ["-s", f"{rng.choice([-2, 0.5, 1.7])}"],
                [f"-m{rng.choice('xyz')}"],
                ["-i", str(rng.randrange(1, 4))],
                ["-a", str(rng.randrange(1, 4))],
            ]
        )
    return words


def values(surface):
    match surface:
        case Polygon():
            return surface.vertices.ravel()
        case Sphere():
            return np.array([*surface.centre, surface.radius, surface.inward])
        case Cone():
            radii = surface.base_radius, surface.top_radius, surface.inward
            return np.array([*surface.base, *surface.top, *radii])
        case Ring():
            radii = surface.inner_radius, surface.outer_radius
            return np.array([*surface.centre, *surface.normal, *radii])


def assert_same(ours, theirs):
    assert [type(s) for s in ours.surfaces] == [type(s) for s in theirs.surfaces]
    for one, other in zip(ours.surfaces, theirs.surfaces, strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(values(one), values(other), rtol=1e-9, atol=1e-9)
        made = ours.materials[one.material], theirs.materials[other.material]
        assert type(made[0]) is type(made[1])
        if hasattr(made[0], "radius"):
            assert made[0].radius == pytest.approx(made[1].radius)
    for one, other in zip(ours.distant, theirs.distant, strict=True):
        np.testing.assert_allclose(one.direction, other.direction, atol=1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_random_options_place_surfaces_as_xform_does(tmp_path, seed):
    words = random_options(random.Random(seed))
    (tmp_path / "part.rad").write_text(SURFACES)
    command = shlex.join([*words, "part.rad"])
    (tmp_path / "ours.rad").write_text(f"{MATERIALS}!xform {command}\n")
    printed = run_xform([*words, "part.rad"], tmp_path)
    (tmp_path / "theirs.rad").write_text(MATERIALS + printed)
    assert_same(read_rad(tmp_path / "ours.rad"), read_rad(tmp_path / "theirs.rad"))


@pytest.mark.parametrize("seed", range(40, 52))
def test_nested_commands_and_pipes_compose_as_in_xform(tmp_path, seed):
    rng = random.Random(seed)
    first, second, third = (random_options(rng) for _ in range(3))
    (tmp_path / "leaf.rad").write_text(SURFACES)
    (tmp_path / "twig.rad").write_text(
        f"!xform {shlex.join(first)} leaf.rad\n{SURFACES}"
    )
    pipe = f"xform {shlex.join(second)} twig.rad | xform {shlex.join(third)}"
    (tmp_path / "ours.rad").write_text(f"{MATERIALS}!{pipe}\n")
    (tmp_path / "pipe.rad").write_text(f"!{pipe}\n")
    printed = run_xform(["pipe.rad"], tmp_path)
    (tmp_path / "theirs.rad").write_text(MATERIALS + printed)
    assert_same(read_rad(tmp_path / "ours.rad"), read_rad(tmp_path / "theirs.rad"))


OPTION_FILES = [
    "-t 1 0 0\n# a comment\n-t 0 2 0 -rz 30\n",
    "!xform -n east -rz 90\nxform -n west -rz -90 -a 2 -t 0 0 1\n",
    "-n one -I -s 2\n\n-m shine -my\n",
]


@pytest.mark.parametrize("lines", OPTION_FILES)
@pytest.mark.parametrize("words", ["-f options", "-n all -f options -t 0 0 5 -a 2"])
def test_option_files_expand_as_in_xform(tmp_path, lines, words):
    (tmp_path / "options").write_text(lines)
    (tmp_path / "part.rad").write_text(SURFACES)
    (tmp_path / "ours.rad").write_text(f"{MATERIALS}!xform {words} part.rad part.rad\n")
    printed = run_xform([*words.split(), "part.rad", "part.rad"], tmp_path)
    (tmp_path / "theirs.rad").write_text(MATERIALS + printed)
    assert_same(read_rad(tmp_path / "ours.rad"), read_rad(tmp_path / "theirs.rad"))


def test_cat_and_redirection_read_the_file_itself(tmp_path):
    (tmp_path / "part.rad").write_text(SURFACES)
    (tmp_path / "cat.rad").write_text(
        f"{MATERIALS}!cat part.rad part.rad|xform -t 1 0 0"
    )
    (tmp_path / "less.rad").write_text(
        f"{MATERIALS}!xform -t 1 0 0 < part.rad\n!xform -t 1 0 \\\n 0 part.rad"
    )
    assert_same(read_rad(tmp_path / "cat.rad"), read_rad(tmp_path / "less.rad"))
