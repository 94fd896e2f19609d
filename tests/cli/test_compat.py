"""`clerestory compat`: options of Radiance's programs, and refusals in one line."""

import io
import os
import stat
import subprocess

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.compat.programs import PROGRAMS, install_programs, run_program
from clerestory.compat.streams import Streams
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.matrix.radiance_format import read_matrix

SKY = """#@rfluxmtx u=+Y h=u
void glow ground_glow 0 0 4 1 1 1 0
ground_glow source ground 0 0 4 0 0 -1 180
#@rfluxmtx u=+Y h=r1
void glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
"""
FIELD = "void plastic black 0 0 5 0 0 0 0 0\nblack sphere far 0 0 4 0 900 -50 .1\n"
SUN = "void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 0 0 1 0.533\n"
UP = "0 0 0 0 0 1\n"


@pytest.fixture
def field(tmp_path, monkeypatch):
    """A folder with an open field, a sky, a sensor and rays to zenith and nadir."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "field.rad").write_text(FIELD)
    (tmp_path / "sky.rad").write_text(SKY)
    (tmp_path / "sun.rad").write_text(FIELD + SUN)
    (tmp_path / "up.pts").write_text(UP)
    (tmp_path / "rays").write_text(UP + "0 0 0 0 0 -1\n")
    return tmp_path


@pytest.fixture
def program(field):
    """Run a program with a file as standard input; return its output as a matrix."""

    def run(name, *words, stdin="up.pts"):
        sink = io.BytesIO()
        run_program(name, [str(w) for w in words], Streams(field / stdin, sink))
        (field / "out.mtx").write_bytes(sink.getvalue())
        return read_matrix(field / "out.mtx").values

    return run


def test_an_open_sensor_receives_pi_from_sky_and_nothing_from_the_ground(program):
    """Irradiance per uniform radiance is π; columns are the ground, then patches."""
    found = program(
        "rfluxmtx", "-I+", "-ab", 1, "-ad", 4096, "-", "sky.rad", "field.rad"
    )
    assert found.shape == (3, 1, 146)
    assert found[:, 0, 0] == pytest.approx(0, abs=1e-6)
    assert found.sum(axis=2) == pytest.approx(np.pi, rel=1e-3)


def test_rays_see_the_patch_in_their_direction(program):
    """-c 1: the zenith is the last patch, nadir the ground."""
    words = ("-faa", "-ab", 1, "-y", 2, "-", "sky.rad", "field.rad")
    found = program("rfluxmtx", *words, stdin="rays")[0]
    assert found[0].argmax() == 145
    assert found[1].argmax() == 0
    assert found.sum(axis=1) == pytest.approx(1, rel=1e-6)


def test_rays_are_averaged_over_each_record(program):
    found = program("rfluxmtx", "-c", 2, "-", "sky.rad", "field.rad", stdin="rays")[0]
    assert found.shape == (1, 146)
    assert found[0, [0, 145]] == pytest.approx(0.5, rel=0.05)


def test_rays_without_a_direction_are_black(program, field):
    """As those of vwrays outside the circle of a fisheye view; -i is for the ground."""
    (field / "rays").write_text("0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 2 0 0 -1\n0 0 0 0 0 0\n")
    words = ("-c", 2, "-", "sky.rad", "field.rad")
    found = program("rfluxmtx", "-ab", 1, *words, stdin="rays")[0]
    assert found.sum(axis=1) == pytest.approx([0, 0.5], rel=1e-6)
    (field / "field.rad").write_text(FIELD + plane("black", 0, down=False))
    found = program("rfluxmtx", "-i", "-ab", 1, *words, stdin="rays")[0]
    assert found.sum(axis=1) == pytest.approx([0, np.pi / 2], rel=0.02)


def test_receivers_have_outputs_by_their_modifiers(field):
    """-o %s.mtx: a matrix for each modifier, here of 1 and 145 columns."""
    words = ["-I+", "-ad", "64", "-o", "%s.mtx", "-", "sky.rad", "field.rad"]
    run_program("rfluxmtx", words, Streams(field / "up.pts", io.BytesIO()))
    found = [read_matrix(field / f"{n}_glow.mtx").values for n in ("ground", "sky")]
    assert [each.shape for each in found] == [(3, 1, 1), (3, 1, 145)]


def test_the_overhead_sun_has_its_solid_angle_as_coefficient(program):
    """Irradiance per radiance is Ω, 2π (1 - cos .2665°); the bin is the zenith's."""
    words = ("-e", "MF:1", "-f", "reinhart.cal", "-b", "rbin", "-bn", "Nrbins")
    found = program("rcontrib", "-I+", "-ab", 1, *words, "-m", "sun", "sun.rad")[0]
    omega = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))
    assert found.shape == (1, 146)
    assert found[0, 145] == pytest.approx(omega, rel=1e-3)
    assert found.sum() == pytest.approx(omega, rel=1e-3)


SUN_OF_ZENITH = ["-e", "MF:1", "-f", "reinhart.cal", "-b", "rbin", "-m", "sun"]
OMEGA = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))


def plane(material, height, *, left=-50.0, down=True):
    """A horizontal polygon in the Radiance format, from x = left to 50."""
    corners = [(left, -50), (left, 50), (50, 50), (50, -50)][:: 1 if down else -1]
    points = " ".join(f"{x} {y} {height}" for x, y in corners)
    return f"{material} polygon at_{height} 0 0 12 {points}\n"


@pytest.mark.parametrize(("edge", "whole"), [(0.001, 1), (-0.001, 0)])
def test_without_jitter_the_sun_is_seen_whole_or_not(program, field, edge, whole):
    """The edge hides a part of the disc of radius 4.65 mm at its distance of 1 m."""
    (field / "sun.rad").write_text(FIELD + SUN + plane("black", 1, left=edge))
    words = ["-I+", "-ab", 0, *SUN_OF_ZENITH, "sun.rad"]
    found = program("rcontrib", "-dj", 0, *words)[0, 0, 145]
    assert found == pytest.approx(whole * OMEGA, rel=1e-3, abs=1e-9)
    found = program("rcontrib", "-dj", 0.9, *words)[0, 0, 145]
    assert 0.3 * OMEGA < found < 0.7 * OMEGA


@pytest.mark.parametrize(
    ("thickness", "down", "scattered"),
    [(0.1, True, 0.3), (-0.1, False, 0.3), (0.1, False, 0)],
)
@pytest.mark.parametrize("sheet", [True, False])
def test_rays_of_sensors_meet_the_bsdf_of_a_proxy(
    program, field, thickness, down, scattered, sheet
):
    """The sun shines through where there is no sheet; the BSDF scatters 0.3 of it.

    Geometry is behind the front of a positive thickness, before that of a negative one.
    Rays pass a BSDF whose geometry is not on its other side.
    """
    patches = klems("quarter")
    even = np.full((len(patches), len(patches)), 0.3 / np.pi)
    sides = "transmission_front", "transmission_back"
    matrix = ScatteringMatrix(even, patches, patches)
    write_bsdf("even.xml", Bsdf({("visible", side): matrix for side in sides}))
    layer = f"void BSDF layer 6 {thickness} even.xml 0 1 0 . 0 0\n"
    planes = plane("layer", 1, down=down) + sheet * plane("black", 1.05)
    (field / "sun.rad").write_text(FIELD + SUN + layer + planes)
    words = ["-I+", "-ab", 1, "-ad", 4096, *SUN_OF_ZENITH, "sun.rad"]
    found = program("rcontrib", *words)[0, 0, 145]
    expected = (0 if sheet else 1) + scattered
    assert found == pytest.approx(expected * OMEGA, rel=0.03, abs=1e-9)


def test_pictures_of_suns_are_columns_of_the_matrix(program, field):
    """One ray meets the sun, one does not; of 146 bins only the zenith has light."""
    words = ("-e", "MF:1", "-f", "reinhart.cal", "-b", "rbin", "-m", "sun")
    sizes = ("-x", 1, "-y", 2)
    table = program("rcontrib", "-ab", 1, *words, *sizes, "sun.rad", stdin="rays")
    assert table[0, :, 145] == pytest.approx([1, 0], abs=1e-6)
    shown = ["-fac", *map(str, sizes), "-o", "a%03d.hdr"]
    run_program(
        "rcontrib", ["-ab", "1", *words, *shown, "sun.rad"], Streams(field / "rays")
    )
    pictures = [read_picture(path) for path in sorted(field.glob("a*.hdr"))]
    found = np.stack([each.radiance.reshape(2, 3) for each in pictures], axis=-1)
    assert found == pytest.approx(np.moveaxis(table, 0, 1), abs=1e-2)


@pytest.mark.parametrize(
    ("name", "words", "message"),
    [
        ("rfluxmtx", "-zz 1 - sky.rad field.rad", "option is -zz"),
        ("rfluxmtx", "-I+ -ab two - sky.rad field.rad", "'two'"),
        ("rfluxmtx", "-I+ -", "1 of sender and receivers"),
        ("rfluxmtx", "-I+ - sky.rad", "no scene"),
        ("rfluxmtx", "-I+ -V+ - sky.rad field.rad", "-V+"),
        ("rfluxmtx", "-fx - sky.rad field.rad", "-fx"),
        ("rfluxmtx", "-c 3 - sky.rad field.rad", "multiple of 3"),
        (
            "rfluxmtx",
            "-x 3 -y 1 -ffc -o a%03d.hdr - sky.rad field.rad",
            "bytes of rays",
        ),
        ("rcontrib", "-I+ -ab 3 -m sun sun.rad", "-ab is 3"),
        ("rcontrib", "-I+ -m lamp sun.rad", "modifier 'lamp'"),
        ("rcontrib", "-I+ -m sun -f klems_full.cal sun.rad", "klems_full.cal"),
        ("dctimestep", "a b c d e", "5 matrices"),
        ("dctimestep", "-x", "-x has 0 arguments"),
        ("rmtxop", "", "no matrix"),
        ("rmtxop", "-C file.txt a", "option is -C"),
        ("gendaymtx", "-M mods year.wea", "option is -M"),
        ("gendaymtx", "-m none year.wea", "'none'"),
    ],
)
def test_what_is_not_supported_is_named_in_one_line(program, name, words, message):
    with pytest.raises(InputError) as raised:
        program(name, *words.split())
    assert message in str(raised.value)
    assert "expected" in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_command_line_passes_options_and_gives_the_exit_status(call):
    outcome = call("compat", "rmtxop", "-zz", "a.mtx")
    assert outcome.status == 2
    assert outcome.err.startswith("rmtxop: option is -zz")
    assert call("compat", "oconv", "a.rad").status == 2


def test_scripts_in_a_folder_run_the_programs(field):
    """A shell finds gendaymtx and rmtxop in the folder, and pipes between them."""
    paths = install_programs(field / "bin", (*PROGRAMS, "evalglare"))
    assert len(paths) == 7
    assert all(path.stat().st_mode & stat.S_IXUSR for path in paths)
    (field / "a.mtx").write_text("#?RADIANCE\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n")
    done = subprocess.run(
        ["sh", "-c", "rmtxop -t a.mtx | rmtxop -fa -s 3 - > out.mtx"],
        cwd=field,
        env={**os.environ, "PATH": f"{field / 'bin'}:{os.environ['PATH']}"},
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert read_matrix(field / "out.mtx").values.tolist() == [[[3.0], [6.0]]]


def test_evalglare_takes_its_options(call, tmp_path):
    """-q 1 is --background average; view options and the output are evalglare's."""
    radiance = np.ones((64, 64, 3), np.float32)
    radiance[20:24, 30:34] = 200
    write_picture(Picture(radiance), tmp_path / "eye.hdr")
    view = ("-vta", "-vh", 180, "-vv", 180)
    picture = tmp_path / "eye.hdr"
    found = call("compat", "evalglare", "-d", "-q", 1, *view, picture)
    words = ("--background", "average", "--view", " ".join(map(str, view)))
    assert found.status == 0, found.err
    assert found.out == call("glare", "-d", *words, picture).out
    assert "dgp" in found.out
    assert call("compat", "evalglare", "-R", picture).status == 2


def test_pictures_beyond_the_rows_of_the_next_factor_are_not_read(tmp_path):
    """Scripts make picture 145 from none, for the 145 patches 0 to 144."""
    for number, value in enumerate((1.0, 2.0)):
        picture = Picture(np.full((2, 3, 3), value, np.float32))
        write_picture(picture, tmp_path / f"v{number:03d}.hdr")
    (tmp_path / "v002.hdr").write_text("#?RADIANCE\n\n")
    text = "#?RADIANCE\nNROWS=2\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n1 1 1 10 10 10\n"
    (tmp_path / "sky.vec").write_text(text)
    sink = io.BytesIO()
    words = [str(tmp_path / "v%03d.hdr"), str(tmp_path / "sky.vec")]
    run_program("dctimestep", words, Streams(sink=sink))
    (tmp_path / "out.hdr").write_bytes(sink.getvalue())
    assert read_picture(tmp_path / "out.hdr").radiance == pytest.approx(21, rel=0.01)
