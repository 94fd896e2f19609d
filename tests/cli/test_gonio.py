"""`clerestory gonio`: from files to BSDFs, exit statuses, one-line errors."""

import pytest

from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.gonio.fit_storage import read_fits
from goniometer import Goniophotometer, pane, rings, write_pabopto


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    """Four files of a rough pane."""
    folder = tmp_path_factory.mktemp("scans")
    directions = rings(azimuths_deg=[0.0], step_deg=25.0, most_deg=75.0)
    measurement = Goniophotometer(points=300).measure(pane, directions)
    return [str(path) for path in write_pabopto(measurement, folder)]


@pytest.fixture
def fitted(room, call, scans):
    assert call("gonio", "fit", *scans, "-o", "pane.nc", "--quiet").status == 0
    return "pane.nc"


def test_info_reports_the_measured_directions(call, scans):
    outcome = call("gonio", "info", *scans)
    assert "visible transmission front" in outcome.out
    assert "4 incident directions, symmetry isotropic" in outcome.out
    assert outcome.status in (0, 1)


def test_a_fit_is_exported_as_matrix_and_as_tree(call, fitted):
    (fit,) = read_fits(fitted)
    assert fit.interpolant.symmetry == "isotropic"
    outcome = call("gonio", "export", fitted, "--to", "quarter", "-o", "matrix.xml")
    assert outcome.status == 0
    share = read_bsdf("matrix.xml").diffuse("transmission_front")
    assert 0.7 < share < 0.85
    words = ("--to", "tree", "--halvings", "4", "--conserve", "-o", "tree.xml")
    outcome = call("gonio", "export", fitted, *words)
    assert outcome.status == 0
    assert "0 directions scaled down" in outcome.out
    tree = read_bsdf("tree.xml").scattering("transmission_front")
    assert isinstance(tree, ScatteringTree)
    assert tree.rank == 3


def test_a_check_writes_a_table_and_a_map(call, room, scans):
    outcome = call(
        "gonio", "check", *scans, "--smoothing", "1.2", "-o", "errors.png", "--quiet"
    )
    assert outcome.status == 0
    assert "smoothing 1.2" in outcome.out
    assert "median of 3 among the others" in outcome.out
    assert "median of 1 beyond the others" in outcome.out
    assert (room / "errors.png").stat().st_size > 5000


def test_a_check_names_directions_that_need_a_scan(call, room, scans):
    outcome = call("gonio", "check", *scans, "--next", "2", "--quiet")
    assert outcome.status == 0
    rows = outcome.out.split(
        "directions recommended for scans, the most useful first:"
    )[1].split()[4:]
    assert len(rows) == 4
    assert all(0 <= float(word) < 360 for word in rows)


def test_scans_and_what_lies_between_are_drawn(call, room, scans):
    for name, words in (
        ("scan.png", ("--scan", "2")),
        ("between.svg", ("--between", "25,0", "--between", "50,0")),
    ):
        outcome = call("gonio", "plot", *scans, *words, "-o", name, "--quiet")
        assert outcome.status == 0
        assert (room / name).stat().st_size > 5000


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("info", "missing.txt"), "missing.txt: cannot be read"),
        (("info", "room.rad"), "not a goniophotometer file"),
        (("export", "room.rad", "-o", "a.xml"), "damaged"),
        (("plot", "SCAN", "-o", "a.gif"), ".png, .svg, .pdf"),
        (("plot", "SCAN", "--scan", "9", "-o", "a.png"), "0 to 0 expected"),
        (("fit", "SCAN", "-o", "a.nc", "--quiet"), "two or more expected"),
        (
            ("fit", "SCAN", "--lobes", "1", "-o", "a.nc"),
            "number of lobes is 1; 4 or more",
        ),
        (("fit", "SCAN", "SCAN", "-o", "a.nc"), "also measured in"),
        (("check", "SCAN", "--quiet"), "3 or more expected"),
    ],
)
def test_bad_input_is_one_line(call, room, scans, words, message):
    words = [scans[0] if word == "SCAN" else word for word in words]
    outcome = call("gonio", *words)
    assert outcome.status == 2
    (line,) = outcome.err.strip().splitlines()
    assert message in line
