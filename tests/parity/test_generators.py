"""Commands of scene files make what Radiance's generators make."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from radiance import run

from clerestory.errors import ClerestoryWarning
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.statements import parse_statements
from clerestory.scene.primitive import Primitive

GREY = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"

SHAPES = [
    "genbox grey box 1 2 3",
    "genbox grey box 1 2 3 -i",
    "genbox grey box 1 2 3 -b .2",
    "genbox grey box 1 2 3 -b .2 -i",
    "genbox grey box 1 2 3 -r .2",
    "genbox grey box 1 2 3 | xform -n desk -rz 30 -t 1 0 0 -a 2 -t 0 0 4",
    "genprism grey p 4 0 0 2 0 2 1 .5 2",
    "genprism grey p 5 0 0 2 0 1 1 2 2 0 2 -l 0 0 -1.5 -c",
    "genprism grey p 4 0 0 2 0 2 1 .5 2 -l .3 .2 1 -e",
    "genprism grey p 4 0 0 0 1 2 2 2 0 -l 0 0 1 -r .1",
    "genprism grey p 5 0 0 0 2 2 2 1 1 2 0 -l .4 0 1 -r .1",
    "genprism grey p 5 0 0 2 0 1 1 2 2 0 2 -l 0 .2 -1 -r .1 -c",
    "genblinds grey b .05 1 1.5 20 45",
    "genrev grey r 'sin(2*PI*t)' '2+cos(2*PI*t)' 16",
    "genrev grey r 'hermite(0,1,2,-1,t)' 'if(t-.5,1,2*t+.1)' 9",
    "genworm grey w 0 '5*sin(t)' '5*cos(t)' '.4-(.5-t)*(.5-t)' 8",
    "genworm grey w 'bezier(0,1,2,0,t)' t 'bspline(0,1,0,2,t)' .1 5",
    "gensurf grey s 's' 't' 'sin(PI*s)*t' 4 7",
    "gensurf grey s 's' 't*w' '.3' 3 2 -e 'w=2'",
    "gensurf grey s 's' 't' 's*t*t' 5 6 -e 'valid(s,t)=.8-s*t'",
    "genblinds grey b .05 1 1.5 7 -30 -r .06",
    "genblinds grey b .05 1 1.5 7 20 +r .1",
]


def numbers(surface):
    """All numbers of a surface."""
    names = "vertices centre radius inward base top base_radius top_radius normal"
    names = f"{names} inner_radius outer_radius".split()
    return np.concatenate(
        [
            np.ravel(getattr(surface, n)).astype(float)
            for n in names
            if hasattr(surface, n)
        ]
    )


@pytest.mark.parametrize("command", SHAPES)
def test_shapes_are_those_of_radiance(command, tmp_path):
    """Names, order and every coordinate."""
    (tmp_path / "ours.rad").write_text(f"{GREY}!{command}\n")
    (tmp_path / "theirs.rad").write_text(GREY + run(command, folder=tmp_path))
    ours = read_rad(tmp_path / "ours.rad").surfaces
    theirs = read_rad(tmp_path / "theirs.rad").surfaces
    assert [s.name for s in sorted(ours, key=lambda s: s.name)] == sorted(
        s.name for s in theirs
    )
    other = {s.name: s for s in theirs}
    for surface in ours:
        assert type(surface) is type(other[surface.name])
        np.testing.assert_allclose(
            numbers(surface), numbers(other[surface.name]), atol=2e-12
        )


def test_shapes_are_those_of_the_reference_data(shared_data, tmp_path):
    """Outputs that come with Radiance's own tests, whose first line is the command."""
    folder = shared_data / "radiance" / "gen" / "ref"
    for name in ("genbox", "genprism", "genblinds"):
        text = (folder / f"{name}.rad").read_text()
        command = text.splitlines()[0].removeprefix("#").strip()
        modifier = command.split()[1]
        material = GREY.replace("grey", modifier)
        (tmp_path / "ours.rad").write_text(f"{material}!{command}\n")
        (tmp_path / "theirs.rad").write_text(material + text)
        ours = read_rad(tmp_path / "ours.rad").surfaces
        theirs = {s.name: s for s in read_rad(tmp_path / "theirs.rad").surfaces}
        assert {s.name for s in ours} == set(theirs)
        for surface in ours:
            np.testing.assert_allclose(
                numbers(surface), numbers(theirs[surface.name]), atol=2e-12
            )


SITE = "-a 47.27 -o -11.39 -m -15"
SKIES = [
    f"gensky 9 21 9:00 {SITE} +s",
    f"gensky 12 21 9:00 {SITE} -s -g .4 -t 3",
    f"gensky 3 1 +14 {SITE} -c",
    f"gensky 3 1 14.25 {SITE} -u -b 20",
    f"gensky 6 21 15 {SITE} +i",
    f"gensky 6 21 15 {SITE} -i -B 120",
    f"gensky 6 21 11:30CEST {SITE} +s -r 5e6",
    "gensky 6 21 11:30EDT -a 40 -o 75 +s -R 300",
    f"gensky 9 21 9:00 {SITE} +s -y 2015",
    f"gensky 2 29 +9:00 {SITE} +s -y 2016",
    "gensky -ang 40 30 +s",
    "gensky -ang -5 30 -c",
    "gensky 6 1 8",
    f"gendaylit 9 21 9 {SITE} -W 600 100",
    f"gendaylit 9 21 9 {SITE} -W 2 80 -g .4",
    f"gendaylit 6 21 12 {SITE} -G 500 150 -O 1",
    f"gendaylit 6 21 12 {SITE} -L 60000 20000",
    f"gendaylit 6 21 12 {SITE} -L 60000 20000 -O 2",
    f"gendaylit 6 21 12 {SITE} -P 3.2 .12",
    f"gendaylit 3 21 16 {SITE} -E 300",
    f"gendaylit 3 21 16 {SITE} -W 300 100 -s -d 5 -y 2012",
    "gendaylit -ang 60 10 -W 800 100",
]


def reals_of(items):
    """Name to reals of primitives."""
    return {i.name: np.array(i.reals) for i in items if isinstance(i, Primitive)}


@pytest.mark.parametrize("command", SKIES)
def test_skies_are_those_of_radiance(command, tmp_path):
    """Radiance prints three or four digits of a level and six of a direction.

    The Perez skies have the sun's diameter and the efficacy of the same papers.
    """
    from clerestory.radiance.generators.catalogue import GENERATORS

    text = run(command, folder=tmp_path)
    theirs = reals_of(parse_statements(text, file="sky.rad"))
    program, *words = command.split()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ClerestoryWarning)
        made = reals_of(GENERATORS[program](WordReader(words, program), Path))
    digits = 5.1e-3 if program == "gensky" else 6e-4
    if theirs.get("solar", np.ones(1))[0] == 0:
        theirs = {"skyfunc": theirs["skyfunc"]}
    assert set(made) == set(theirs)
    for name, reals in theirs.items():
        np.testing.assert_allclose(made[name], reals, rtol=digits, atol=1.1e-6)


def shown():
    """One sky of each kind always, the others with the slow tests."""
    always = {SKIES[i] for i in (0, 2, 5, 13, 14)}
    for command in SKIES:
        marks = () if command in always else pytest.mark.slow
        if "-ang -5" not in command:
            yield pytest.param(command, marks=marks)


@pytest.mark.parametrize("command", list(shown()))
def test_skies_look_like_radiances(command, tmp_path):
    """Radiance in 200 directions against rtrace, by the numbers Radiance prints."""
    rng = np.random.default_rng(3)
    rays = rng.normal(size=(200, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    glow = "skyfunc glow sky 0 0 4 1 1 1 0 sky source dome 0 0 4 0 0 1 360\n"
    text = "\n".join(
        line for line in run(command, folder=tmp_path).splitlines() if line[:1] != "#"
    )
    (tmp_path / "sky.rad").write_text(
        f"{text[text.index('void brightfunc') :]}\n{glow}"
    )
    lines = "\n".join(" ".join(f"{x:.9g}" for x in (0, 0, 0, *ray)) for ray in rays)
    done = run(
        "oconv sky.rad > sky.oct && rtrace -h -ab 0 sky.oct",
        folder=tmp_path,
        stdin=lines,
    )
    theirs = np.array([line.split() for line in done.splitlines()], dtype=float)
    pattern = read_rad(tmp_path / "sky.rad").materials["sky"].pattern
    assert not pattern.needs_normal
    assert not pattern.needs_point
    np.testing.assert_allclose(pattern.value(rays), theirs, rtol=2e-6)
