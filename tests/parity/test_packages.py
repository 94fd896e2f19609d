"""pkgBSDF and mgf2rad in a scene stand for what Radiance's programs write."""

import shutil

import numpy as np
import pytest
from radiance import run

from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import BsdfSurface


@pytest.mark.parametrize("name", ["blindsT3.xml", "blinds30.xml"])
def test_packages_are_those_of_radiance(name, shared_data, tmp_path):
    """Names and extents of all surfaces; the program prints six digits."""
    [source] = list((shared_data / "bsdf").rglob(name))[:1]
    file = shutil.copy(source, tmp_path)
    transform = "xform -n w -rx 90 -t 0 0 1"
    (tmp_path / "ours.rad").write_text(f'!pkgBSDF -s "{file}" | {transform}\n')
    (tmp_path / "theirs.rad").write_text(
        run(f"pkgBSDF -s '{file}' | {transform}", folder=tmp_path)
    )
    ours, theirs = (read_rad(tmp_path / f"{who}.rad") for who in ("ours", "theirs"))
    assert len(ours.surfaces) == len(theirs.surfaces)
    np.testing.assert_allclose(ours.bounds(), theirs.bounds(), atol=2e-5)

    def layers(scene):
        found = [
            (s.name, scene.materials[s.material].thickness)
            for s in scene.surfaces
            if isinstance(scene.materials[s.material], BsdfSurface)
        ]
        return dict(sorted(found))

    assert set(layers(ours)) == set(layers(theirs))
    for key, thickness in layers(ours).items():
        assert thickness == pytest.approx(layers(theirs)[key], rel=1e-4)


MGF = """m wood =
\tsides 2
\trd 0.4
v a =
\tp 0 0 0
v b =
\tp 1 0 0
v c =
\tp 1 1 0
f a b c
"""


def test_mgf_is_read_in_place(tmp_path):
    (tmp_path / "a.mgf").write_text(MGF)
    (tmp_path / "ours.rad").write_text("!mgf2rad a.mgf | xform -n top -t 0 0 2\n")
    (tmp_path / "theirs.rad").write_text(
        run("mgf2rad a.mgf | xform -n top -t 0 0 2", folder=tmp_path)
    )
    ours, theirs = (read_rad(tmp_path / f"{who}.rad") for who in ("ours", "theirs"))
    np.testing.assert_allclose(ours.bounds(), theirs.bounds(), atol=1e-6)
    one, two = (s.materials[s.surfaces[0].material] for s in (ours, theirs))
    np.testing.assert_allclose(one.reflectance, two.reflectance, atol=1e-3)
    assert ours.surfaces[0].name.startswith("top.")


def test_xform_turns_and_remakes_what_is_in_place(tmp_path):
    (tmp_path / "a.mgf").write_text(MGF)
    text = "void plastic grey 0 0 5 .5 .5 .5 0 0\n!mgf2rad a.mgf | xform -I -m grey\n"
    (tmp_path / "a.rad").write_text(text)
    [face] = read_rad(tmp_path / "a.rad").surfaces
    a, b, c = face.vertices
    assert np.cross(b - a, c - b)[2] < 0
    assert face.material == "grey"


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("mgf2rad", "a.rad:2: mgf2rad: the command has no file"),
        ("mgf2rad -e 2 a.mgf", 'a.rad:2: mgf2rad: the option "-e"'),
        ("pkgBSDF gone.xml", 'a.rad:2: the file "gone.xml" is missing'),
        ("genbox grey b 1 2", "a.rad:2: genbox: the command ends where size along z"),
        ("genbox grey b 1 2 -3", "a.rad:2: genbox: size along z is -3"),
        ("genbox grey b 1 2 3 -n 4", 'a.rad:2: genbox: the option "-n"'),
        ("gensky 13 1 9", "a.rad:2: gensky: the month is 13"),
        ("gensky 3 1 9XYZ", 'a.rad:2: gensky: unknown time zone "XYZ"'),
        ("gendaylit 6 1 9 -W 500", "a.rad:2: gendaylit: the command ends"),
        ("gendaylit 6 1 9 -C", 'a.rad:2: gendaylit: the option "-C"'),
        ("ies2rad gone.ies", 'a.rad:2: the file "gone.ies" is missing'),
        ("genclock -t 12", 'a.rad:2: "genclock" in the command'),
        ("genworm grey w 0 0 t -1 5", "a.rad:2: genworm: the radius is -1"),
        ("genrev grey r 1/t 1 5", "a.rad:2: genrev: a formula is undefined"),
        ("gensurf grey s s t +* 5 5", 'a.rad:2: unexpected "*"; a value'),
        ("genblinds grey b 1 1 1 0 45", "a.rad:2: genblinds: number of slats is 0"),
        ("genprism grey p 3 0 0 1 0 1 1 -l 1 0 0", "a.rad:2: genprism: the vector"),
    ],
)
def test_what_generators_refuse_is_reported_with_its_line(command, message, tmp_path):
    (tmp_path / "a.mgf").write_text(MGF)
    text = f"void plastic grey 0 0 5 .5 .5 .5 0 0\n!{command}\n"
    (tmp_path / "a.rad").write_text(text)
    with pytest.raises(InputError) as caught:
        read_rad(tmp_path / "a.rad")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
