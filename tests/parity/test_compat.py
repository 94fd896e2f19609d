"""Shell scripts of Radiance's matrix methods, with its programs and with `compat`'s.

The commands are those of LBNL's tutorial for two, three and five phases, which run
unchanged: only PATH differs. Radiance runs each script twice, with other directions
(-ad): the difference is its noise. The results of `compat` must be as close to the mean
of both runs as these are to each other.
"""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from radiance import ENVIRONMENT

import clerestory
from clerestory.compat.programs import PROGRAMS, install_programs
from clerestory.hemisphere.reinhart import reinhart
from clerestory.image.picture_files import read_picture
from clerestory.matrix.radiance_format import read_matrix

TWO_PHASES = """
oconv materials.rad room.rad objects/Glazing.rad > dc.oct
rfluxmtx -I+ -y 100 -lw 0.0001 -ab 5 -ad {ad} -n 2 - skyDomes/skyglow.rad \
    -i dc.oct < points.txt > dc.mtx
gendaymtx -m 1 assets/NYC.wea > NYC.smx
dctimestep dc.mtx NYC.smx | rmtxop -fa -t -c 47.4 119.9 11.6 - > dc.ill
oconv materialBlack.rad roomBlack.rad materials.rad objects/Glazing.rad > black.oct
rfluxmtx -I+ -y 100 -lw 0.0001 -ab 1 -ad {ad} -n 2 - skyDomes/skyglow.rad \
    -i black.oct < points.txt > dcd.mtx
gendaymtx -m 1 -d assets/NYC.wea > NYCd.smx
dctimestep dcd.mtx NYCd.smx | rmtxop -fa -t -c 47.4 119.9 11.6 - > dcd.ill
echo "void light solar 0 0 3 1e6 1e6 1e6" > suns.rad
cnt 5165 | rcalc -e MF:6 -f reinsrc.cal -e Rbin=recno \
    -o 'solar source sun 0 0 4 ${{Dx}} ${{Dy}} ${{Dz}} 0.533' >> suns.rad
oconv -f materialBlack.rad roomBlack.rad suns.rad materials.rad objects/Glazing.rad \
    > suns.oct
rcontrib -I+ -ab 1 -y 100 -n 2 -ad 256 -lw 1.0e-3 -dc 1 -dt 0 -dj 0 -faf -e MF:6 \
    -f reinhart.cal -b rbin -bn Nrbins -m solar suns.oct < points.txt > cds.mtx
gendaymtx -5 0.533 -d -m 6 assets/NYC.wea > suns.smx
dctimestep cds.mtx suns.smx | rmtxop -fa -t -c 47.4 119.9 11.6 - > cds.ill
rmtxop dc.ill + -s -1 dcd.ill + cds.ill > annual.ill
"""

FIVE_PHASES = """
oconv -f materials.rad room.rad > room.oct
rfluxmtx -v -I+ -ab 4 -ad {ad} -lw 0.0002 -n 2 -y 100 - objects/GlazingVmtx.rad \
    -i room.oct < points.txt > v.mtx
rfluxmtx -v -ff -ab 4 -ad 100 -lw 0.001 -c {c} -n 2 objects/GlazingVmtx.rad \
    skyDomes/skyglow.rad -i room.oct > d.dmx
gendaymtx -m 1 assets/NYC.wea > NYC.smx
dctimestep v.mtx matrices/tmtx/blinds.xml d.dmx NYC.smx \
    | rmtxop -fa -t -c 47.4 119.9 11.6 - > 3ph.ill
oconv -f materialBlack.rad roomBlack.rad > black.oct
rfluxmtx -v -I+ -ab 1 -ad {ad} -lw 0.0002 -n 2 -y 100 - objects/GlazingVmtx.rad \
    -i black.oct < points.txt > vd.mtx
rfluxmtx -v -ff -ab 0 -ad 100 -lw 0.001 -c {c} -n 2 objects/GlazingVmtx.rad \
    skyDomes/skyglow.rad -i black.oct > dd.dmx
gendaymtx -m 1 -d assets/NYC.wea > NYCd.smx
dctimestep vd.mtx matrices/tmtx/blinds.xml dd.dmx NYCd.smx \
    | rmtxop -fa -t -c 47.4 119.9 11.6 - > 3phdir.ill
rmtxop 3ph.ill + -s -1 3phdir.ill > annual.ill
"""

PICTURES = """
oconv -f materials.rad room.rad > room.oct
vwrays -vf views/south.vf -x 24 -y 24 -pj 0.7 -c 9 -ff | rfluxmtx -ffc -c 9 -ab 3 \
    `vwrays -vf views/south.vf -x 24 -y 24 -d` -ad {ad} -lw 1e-4 -o south%03d.hdr \
    - objects/GlazingVmtx.rad -i room.oct
rfluxmtx -ff -ab 1 -c {c} objects/GlazingVmtx.rad skyDomes/skyglow.rad -i room.oct \
    > d.dmx
gendaymtx -m 1 assets/NYC.wea > NYC.smx
rmtxop -fa -t NYC.smx > steps.smx
dctimestep -o 3ph%04d.hdr south%03d.hdr matrices/tmtx/clear.xml d.dmx NYC.smx
oconv -f materialBlack.rad roomBlack.rad > black.oct
vwrays -vf views/south.vf -x 24 -y 24 -pj 0.7 -c 9 -ff | rfluxmtx -ffc -i -c 9 -ab 1 \
    `vwrays -vf views/south.vf -x 24 -y 24 -d` -ad {ad} -lw 1e-4 -o ill%03d.hdr \
    - objects/GlazingVmtx.rad -i black.oct
dctimestep -o 3phd%04d.hdr ill%03d.hdr matrices/tmtx/clear.xml d.dmx NYC.smx
"""


@pytest.fixture(scope="module")
def run(shared_data, tmp_path_factory):
    """Run a script in a copy of the tutorial's room; return the folder."""
    folder = tmp_path_factory.mktemp("compat")
    install_programs(folder / "bin", tuple(PROGRAMS))
    source = str(Path(clerestory.__file__).parents[1])

    def script(text, name, *, ours, **numbers):
        room = folder / name
        if not room.is_dir():
            shutil.copytree(shared_data / "tutorial_room", room)
            room.chmod(0o755)
        path = ENVIRONMENT["PATH"]
        environment = {
            **ENVIRONMENT,
            "PATH": f"{folder / 'bin'}:{path}" if ours else path,
            "PYTHONPATH": source,
        }
        done = subprocess.run(
            ["bash", "-e", "-c", text.format(**numbers)],
            cwd=room, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return room

    return script


@pytest.fixture(scope="module")
def three(run):
    """Folders of our run of a script, and of two runs of Radiance."""

    def folders(text, name, **numbers):
        other = {key: round(1.17 * value) for key, value in numbers.items()}
        return (
            run(text, f"{name}-ours", ours=True, **numbers),
            run(text, f"{name}-one", ours=False, **numbers),
            run(text, f"{name}-two", ours=False, **other),
        )

    return folders


def assert_within_noise(ours, one, two, *, mean=0.01):
    """Assert that our values differ from Radiance's like two of its runs."""
    theirs = (one + two) / 2
    assert ours.shape == theirs.shape
    assert abs(ours.sum() / theirs.sum() - 1) < mean
    noise = np.sqrt(np.mean(np.square(one - two)))
    assert np.sqrt(np.mean(np.square(ours - theirs))) < 1.25 * noise


@pytest.mark.slow
def test_the_two_phase_script_with_direct_suns_agrees(three):
    folders = three(TWO_PHASES, "two", ad=10000)
    for name in ("dc.ill", "dcd.ill", "annual.ill"):
        values = [read_matrix(folder / name).values for folder in folders]
        assert_within_noise(*values)
    # The sun's coefficients have no noise: sensors at edges of shadows differ
    ours, theirs, _ = (read_matrix(f / "cds.ill").values for f in folders)
    assert abs(ours.sum() / theirs.sum() - 1) < 0.005
    assert np.median(np.abs(ours - theirs)[theirs > 100] / theirs[theirs > 100]) < 0.005


@pytest.mark.slow
def test_the_five_phase_script_agrees(three):
    """V T D S - V_d T D_d S_d behind the blind, sensor by sensor and step by step."""
    folders = three(FIVE_PHASES, "five", ad=5000, c=1000)
    for name in ("3ph.ill", "3phdir.ill"):
        assert_within_noise(*(read_matrix(folder / name).values for folder in folders))


@pytest.mark.slow
def test_the_scripts_with_pictures_agree(three):
    """Radiance V T D S, and V_d of irradiance (-i): sums of steps of each pixel."""
    folders = three(PICTURES, "pictures", ad=400, c=1000)
    for name in ("3ph", "3phd"):
        sums = [
            np.sum(
                [read_picture(f / f"{name}{k:04d}.hdr").radiance for k in range(40)], 0
            )
            for f in folders
        ]
        assert_within_noise(*(np.sqrt(each) for each in sums), mean=0.015)


@pytest.mark.parametrize(
    "options",
    ["-m 1", "-m 2 -d", "-m 1 -s -g .1 .3 .2", "-5 .533 -d -m 6 -of", "-r 30 -u -A"],
)
def test_gendaymtx_gives_the_matrix_of_radiance(run, options):
    text = f"gendaymtx {options} assets/NYC.wea > S.smx"
    mark = options.replace(" ", "")
    ours, theirs = (
        read_matrix(run(text, f"sky{mark}{own}", ours=own) / "S.smx").values
        for own in (True, False)
    )
    assert np.abs(ours - theirs).max() <= 4e-3 * theirs.max()
    assert np.median(np.abs(ours - theirs)[theirs > 0] / theirs[theirs > 0]) < 2e-3


PRODUCTS = (
    "rmtxop -fa -t -c 47.4 119.9 11.6 a.mtx",
    "rmtxop -fd a.mtx",
    "rmtxop -s 2 a.mtx + -s -.5 a.mtx",
    "rmtxop -s 1 2 3 a.mtx '*' a.mtx",
    "rmtxop a.mtx b.mtx",
    "rmtxop -c 1 0 0 0 1 1 a.mtx . -c 1 2 1 .5 0 1 b.mtx",
    "rmtxop -fa - < a.mtx",
    "dctimestep -of a.mtx b.mtx",
    "dctimestep a.mtx < b.mtx",
    "dctimestep -h -n 1 a.mtx c.vec",
)


@pytest.fixture(scope="module")
def matrices(run):
    """A folder with sky matrices, and a sky vector without header."""
    make = (
        "gendaymtx -m 1 assets/NYC.wea > b.mtx && rmtxop -fd -t b.mtx > a.mtx"
        " && gendaymtx -h -A -m 1 assets/NYC.wea > c.vec"
    )
    return run(make, "products", ours=False)


@pytest.mark.parametrize("command", PRODUCTS)
def test_products_are_those_of_radiance(run, matrices, command):
    for own in (True, False):
        run(f"{command} > {own}.mtx", matrices.name, ours=own)
    data = [(matrices / f"{own}.mtx").read_bytes() for own in (True, False)]
    if "-h" in command:
        ours, theirs = (np.array(each.split(), float) for each in data)
    else:
        assert data[0].count(b"FORMAT=ascii") == data[1].count(b"FORMAT=ascii")
        ours, theirs = (
            read_matrix(matrices / f"{n}.mtx").values for n in (True, False)
        )
    np.testing.assert_allclose(
        ours, theirs, rtol=1e-4, atol=1e-4 * np.abs(theirs).max()
    )


def test_genskyvec_keeps_the_irradiance_of_a_sky(run):
    """On the ground as by rtrace under the same sky, but for the spread of the sun."""
    text = """
gendaylit 3 20 10:30EDT -m 75 -o 73.96 -a 40.78 -W {direct} 162 > sky.txt
genskyvec -m {mf} -c 1 1 1 < sky.txt > sky.vec
cat sky.txt > sky.rad
echo "skyfunc glow g 0 0 4 1 1 1 0 g source s 0 0 4 0 0 1 180" >> sky.rad
oconv sky.rad > sky.oct
echo 0 0 0 0 0 1 | rtrace -h -I -ab 1 -ad 60000 -lw 1e-7 -aa 0 sky.oct > up.txt
"""
    for direct, mf, bound in ((0, 1, 0.005), (706, 4, 0.01)):
        room = run(text, f"vector{mf}", ours=True, direct=direct, mf=mf)
        column = read_matrix(room / "sky.vec").values[:, 1:, 0]
        found = column @ reinhart(mf).dome.projected_solid_angles()
        expected = np.loadtxt(room / "up.txt")
        assert found == pytest.approx(expected, rel=bound)
