"""Glare against evalglare 3.06, picture by picture, and against Radiance's glarendx."""

from dataclasses import replace

import numpy as np
import pytest
from evalglare import INDICES, evalglare
from glare_pictures import KINDS, VIEWS, synthetic_picture
from radiance import run

from clerestory.glare.brs import brs_glare_index
from clerestory.glare.cgi import cgi
from clerestory.glare.detection_criteria import SourceRules, Zone
from clerestory.glare.dgi import dgi
from clerestory.glare.evaluate import SeenRows, evaluate_glare, eye_of
from clerestory.glare.glarendx import weighted_solid_angle
from clerestory.glare.imageless import position_of
from clerestory.glare.luminance_statistics import (
    band,
    field_luminances,
    region_statistics,
)
from clerestory.glare.pgsv import contrast_pgsv, pgsv, saturation_pgsv
from clerestory.glare.source_table import GlareSources
from clerestory.glare.ugr import ugr
from clerestory.glare.vcp import dgr, vcp
from clerestory.glare.zones import Zones
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.scene.view import View

# Small pictures have few pixels in the merging angle, for both programs
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*too coarse to tell glare sources:clerestory.errors.ClerestoryWarning"
)

# evalglare looks up the angle of a source in the pixel below its middle, which rounding
# may make the pixel beside it: veiling luminances differ by a pixel


def assert_equal(result, theirs, *, pixel=0.0):
    assert result.sources.count == theirs.count
    values = result.values()
    assert values["dgp"] == pytest.approx(theirs.summary["dgp"], abs=1e-3)
    for name, ours in INDICES.items():
        assert values[ours] == pytest.approx(
            theirs.summary[name], rel=0.01, abs=1e-3
        ), name
    assert_veils(result.sources, theirs, pixel)


def assert_veils(sources, theirs, pixel):
    near = np.maximum(np.degrees(sources.sigma) - pixel, 1e-9)
    far = np.degrees(sources.sigma) + pixel
    for name, lower, upper in (
        (
            "Lveil_cie",
            10 * sources.illuminance / far**2,
            10 * sources.illuminance / near**2,
        ),
        ("Lveil", 0.98 * veil(sources, far), 1.02 * veil(sources, near)),
    ):
        assert 0.99 * lower.sum() - 1e-5 <= theirs.summary[name]
        assert theirs.summary[name] <= 1.01 * upper.sum() + 1e-5


def veil(sources, degrees):
    flux = sources.luminance * sources.solid_angle
    return 5 * flux * np.cos(np.radians(degrees)) / degrees


@pytest.mark.parametrize(
    "name", ["evalglare_testimage_ISE2003.hdr", "raytools_desk_render.hdr"]
)
def test_photographs_and_renderings_have_the_same_glare(shared_data, name):
    path = shared_data / "hdr" / name
    assert_equal(evaluate_glare(read_picture(path)), evalglare(path), pixel=0.3)


@pytest.mark.parametrize("number", range(0, len(VIEWS) * len(KINDS), 3))
def test_synthetic_pictures_have_the_same_glare(tmp_path, number):
    compare_synthetic(tmp_path, number)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(200))
def test_two_hundred_synthetic_pictures_have_the_same_glare(tmp_path, number):
    compare_synthetic(tmp_path, number)


def compare_synthetic(folder, number):
    path = folder / "room.hdr"
    write_picture(synthetic_picture(number), path)
    picture = read_picture(path)
    result = evaluate_glare(picture, trust=True)
    eye = eye_of(picture, trust=True)
    # Two pixels in the middle of the picture, along its diagonal
    assert_equal(result, evalglare(path), pixel=2 * np.degrees(eye.pixel_angle() / 1.4))


OPTIONS = [
    ("-s", {"smooth": True}),
    ("-s -Y 10000 -r .3", {"smooth": True, "peak_luminance": 1e4, "merge_angle": 0.3}),
    ("-r 0.1", {"merge_angle": 0.1}),
    ("-x", {"peak_luminance": None}),
    ("-b 5", {"threshold": 5.0, "threshold_kind": "times_mean"}),
    ("-G 1", {"field_of_view": "total"}),
    ("-G 2", {"field_of_view": "binocular"}),
    (
        "-t 80 70 .6",
        {
            "threshold": 5.0,
            "threshold_kind": "times_task",
            "task": Zone(160 - 1 - 70, 80, 0.6),
        },
    ),
]


@pytest.mark.parametrize("number", [0, 33])
@pytest.mark.parametrize(("options", "rules"), OPTIONS)
def test_rules_mean_the_same(tmp_path, number, options, rules):
    path = tmp_path / "room.hdr"
    write_picture(synthetic_picture(number), path)
    ours = evaluate_glare(read_picture(path), rules=SourceRules(**rules), trust=True)
    assert_equal(ours, evalglare(path, *options.split()), pixel=3.0)


@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        ("-i 3000", {"given_illuminance": 3000.0}),
        ("-I 3000 120 30", {"given_illuminance": 3000.0, "seen": SeenRows(40, 128)}),
        ("-I 900 100 20", {"given_illuminance": 900.0, "seen": SeenRows(60, 138)}),
        ("-q 1", {"background": "average"}),
        ("-q 2", {"background": "illuminance"}),
        ("-C l+", {"low_light": True}),
        ("-P 1", {"position_model": "kim"}),
        ("-L 80 80 0.5 1.1", {"zones": Zones(Zone(79, 80, 0.5), 1.1)}),
    ],
)
def test_options_mean_the_same(tmp_path, options, arguments):
    path = tmp_path / "room.hdr"
    write_picture(synthetic_picture(25), path)
    ours = evaluate_glare(read_picture(path), trust=True, **arguments)
    assert_equal(ours, evalglare(path, *options.split()), pixel=3.0)


def test_a_band_is_that_of_radiances_own_test(shared_data):
    """Radiance's test of evalglare: -L 400 500 0.6 1.2 -B 0.4 -b 2500."""
    picture = read_picture(shared_data / "hdr" / "evalglare_testimage_ISE2003.hdr")
    eye = eye_of(picture)
    found = region_statistics(picture.luminance(), eye, band(eye, 0.4))
    expected = (2.423399, 2353.496003, 1339.703125, 2218.441248)
    expected += (3993.937463, 5750.375098, 68.348633, 37142.499489)
    ours = (found.solid_angle, found.average, found.median, found.deviation)
    ours += (found.percentile_75, found.percentile_95, found.least, found.most)
    assert ours == pytest.approx(expected, rel=1e-5)


def test_pgsv_of_a_window_equals_evalglare(tmp_path, shared_data):
    path = shared_data / "hdr" / "evalglare_testimage_ISE2003.hdr"
    picture = read_picture(path)
    marked = np.zeros(picture.radiance.shape, np.float32)
    marked[250:420, 60:200] = 1
    write_picture(replace(picture, radiance=marked), tmp_path / "mask.hdr")
    theirs = evalglare(path, "-A", tmp_path / "mask.hdr", "-t", "400", "200", "0.5")
    task = SourceRules(
        threshold=5,
        threshold_kind="times_task",
        task=Zone(picture.rows - 1 - 200, 400, 0.5),
    )
    result = evaluate_glare(picture, rules=task)
    window = region_statistics(
        picture.luminance(), eye_of(picture), marked[..., 0] > 0.5
    )
    seen = {
        "window": window.average,
        "window_solid_angle": window.solid_angle,
        "average": result.average,
    }
    level = result.illuminance
    ours = {
        "av_lum": window.average,
        "perc_95": window.percentile_95,
        "Ev_mask": window.illuminance,
        "pgsv_con": contrast_pgsv(**seen),
        "pgsv_sat": saturation_pgsv(level),
        "pgsv": pgsv(**seen, illuminance=level, task=result.reference),
    }
    for name, value in ours.items():
        assert value == pytest.approx(theirs.lines[name], rel=1e-3), name


def test_luminances_of_the_field_are_the_same(shared_data):
    path = shared_data / "hdr" / "evalglare_testimage_ISE2003.hdr"
    picture = read_picture(path)
    eye = eye_of(picture)
    theirs = evalglare(path).summary
    names = ("av_lum_pos", "med_lum", "med_lum_pos", "med_lum_pos2")
    ours = field_luminances(picture.luminance(), eye)
    assert (ours[0], *ours[2:]) == pytest.approx([theirs[n] for n in names], rel=1e-4)
    # evalglare divides by the solid angle twice
    assert ours[1] / eye.total_solid_angle == pytest.approx(
        theirs["av_lum_pos2"], rel=1e-4
    )


SKY = """
!gensky 3 21 12.5 +s -g .2
skyfunc glow sky 0 0 4 1 1 1 0
sky source dome 0 0 4 0 0 1 180
skyfunc glow ground 0 0 4 .6 .6 .6 0
ground source soil 0 0 4 0 0 -1 180
"""
RENDERED = [
    "-vta -vp 2 1 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vth -vp 2 1.5 1.2 -vd .4 -1 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vtv -vp 1.5 3 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 90 -vv 70",
    "-vts -vp 1.5 1.5 1.2 -vd -.3 -1 0 -vu 0 0 1 -vh 120 -vv 120",
]


@pytest.mark.slow
@pytest.mark.parametrize("view", RENDERED)
def test_renderings_of_four_kinds_of_view_have_the_same_glare(tmp_path, view):
    (tmp_path / "sky.rad").write_text(SKY)
    box = tmp_path / "room.rad"
    box.write_text(ROOM)
    run("oconv room.rad sky.rad > room.oct", folder=tmp_path)
    run(
        f"rpict {view} -x 300 -y 300 -ab 1 -ad 64 -as 0 -ps 1 room.oct > out.hdr",
        folder=tmp_path,
    )
    path = tmp_path / "out.hdr"
    ours = evaluate_glare(read_picture(path), trust=True)
    assert ours.sources.count > 0
    assert_equal(ours, evalglare(path), pixel=1.5)


# From the tutorial's place of work towards the window, and along the room
TUTORIAL = [
    "-vta -vp 3 3 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vth -vp 3 2 1.2 -vd -.3 -1 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vtv -vp 2.67625 5.50846 1.42293 -vd -0.0231 -0.99933 0.02832 -vu 0 0 1"
    " -vh 79.1044 -vv 49.2739",
    "-vts -vp 3 2.5 1.2 -vd .5 -1 0 -vu 0 0 1 -vh 130 -vv 130",
]


@pytest.mark.slow
@pytest.mark.parametrize("view", TUTORIAL)
def test_renderings_of_the_tutorial_have_the_same_glare(shared_data, tmp_path, view):
    """LBNL's room under a clear winter sky with sun, seen by Radiance's rpict."""
    folder = shared_data / "tutorial_room"
    (tmp_path / "sky.rad").write_text(SKY)
    run(
        f"oconv -f materials.rad room.rad objects/Glazing.rad {tmp_path}/sky.rad"
        f" > {tmp_path}/room.oct",
        folder=folder,
    )
    run(
        f"rpict {view} -x 500 -y 500 -ab 1 -ad 128 -as 0 -ps 1 room.oct > out.hdr",
        folder=tmp_path,
    )
    path = tmp_path / "out.hdr"
    ours = evaluate_glare(read_picture(path), trust=True)
    assert ours.sources.count > 0
    assert_equal(ours, evalglare(path), pixel=1)


def middles(path):
    """Of evalglare's sources and ours: angles apart [°], and whether ours is sure.

    The middle of a source is looked up in the pixel that holds it. Where it falls on
    the edge of a pixel, as that of a single pixel does, rounding decides.
    """
    sources = evaluate_glare(read_picture(path), trust=True).sources
    theirs = np.array(evalglare(path).sources)
    apart = np.abs(np.degrees(sources.sigma) - theirs[:, 12])
    place = np.stack([sources.row, sources.column])
    sure = np.abs(place - np.round(place)).min(axis=0) > 1e-6
    return apart, sure


def test_angles_of_sources_are_the_same_unless_rounding_decides(tmp_path):
    """In pictures of many small sources, whose veiling luminances differ most."""
    path, checked = tmp_path / "room.hdr", 0
    for number in (8, 10, 11, 19, 52, 53, 57, 88):
        write_picture(synthetic_picture(number), path)
        apart, sure = middles(path)
        assert np.all(apart[sure] < 2e-4)
        checked += sure.sum()
    assert checked > 50


# A room of 4 × 6 × 3 m with an open window to the south
ROOM = """
void plastic white 0 0 5 .7 .7 .7 0 0
void plastic grey 0 0 5 .3 .3 .3 .02 .05
grey polygon floor 0 0 12  0 0 0  4 0 0  4 6 0  0 6 0
white polygon roof 0 0 12  0 0 3  0 6 3  4 6 3  4 0 3
white polygon west 0 0 12  0 0 0  0 6 0  0 6 3  0 0 3
white polygon east 0 0 12  4 0 0  4 0 3  4 6 3  4 6 0
white polygon north 0 0 12  0 6 0  4 6 0  4 6 3  0 6 3
white polygon under 0 0 12  0 0 0  0 0 .9  4 0 .9  4 0 0
white polygon over 0 0 12  0 0 2.5  0 0 3  4 0 3  4 0 2.5
white polygon left 0 0 12  0 0 .9  0 0 2.5  .5 0 2.5  .5 0 .9
white polygon right 0 0 12  3.5 0 .9  3.5 0 2.5  4 0 2.5  4 0 .9
grey polygon post 0 0 12  2.0 0 .9  2.0 0 2.5  2.1 0 2.5  2.1 0 .9
"""


def glarendx_input(path):
    """Sources, and indirect illuminance by angle, of a findglare file."""
    sources, indirect, into = [], [], None
    for line in path.read_text().splitlines():
        if line.startswith("BEGIN"):
            into = sources if "source" in line else indirect
        elif line.startswith("END"):
            into = None
        elif into is not None:
            into.append([float(word) for word in line.split()])
    return np.array(sources), np.array(indirect)


def seen_from(ahead, sources):
    """Sources in front of a view, by the position index of glarendx."""
    view = View(direction=ahead)
    direction = sources[:, :3] / np.linalg.norm(sources[:, :3], axis=1, keepdims=True)
    front = direction @ ahead > 1e-6
    direction, sources = direction[front], sources[front]
    return GlareSources.of(
        luminance=sources[:, 4],
        solid_angle=sources[:, 3],
        position_index=position_of(direction, view, model="levin"),
        sigma=np.arccos(direction @ ahead),
    )


def dgi_of(ahead, sources, indirect):
    """DGI with the solid angles of sources weighted over their extent."""
    direction = sources[:, :3] / np.linalg.norm(sources[:, :3], axis=1, keepdims=True)
    weighted = weighted_solid_angle(direction, sources[:, 3], View(direction=ahead))
    seen = weighted > 0
    table = GlareSources.of(
        luminance=sources[seen, 4],
        solid_angle=sources[seen, 3],
        position_index=np.ones(seen.sum()),
    )
    return dgi(table, background=indirect / np.pi, weighted=weighted[seen])


def index_of(name, sources, indirect):
    """One of glarendx's indices from our functions."""
    direct = float(sources.illuminance.sum())
    if name == "vert_dir":
        return direct
    if name == "vert_ill":
        return direct + indirect
    if name == "ugr":
        return ugr(sources, background=indirect / np.pi)
    if name == "brs_gi":
        return brs_glare_index(sources, background=indirect / np.pi)
    if name == "cie_cgi":
        return cgi(sources, illuminance=direct + indirect, direct=direct)
    # Its average luminance is that of 5 sr
    rest = 5 - sources.solid_angle.sum()
    average = (sources.luminance @ sources.solid_angle + rest * indirect / np.pi) / 5
    rating = dgr(sources, average=float(average))
    return rating if name == "guth_dgr" else vcp(rating)


@pytest.mark.parametrize(
    "name",
    [
        "ugr",
        "brs_gi",
        "dgi",
        "cie_cgi",
        "guth_dgr",
        "guth_vcp",
        "vert_dir",
        "vert_ind",
        "vert_ill",
    ],
)
def test_indices_of_radiances_own_test_are_the_same(shared_data, name):
    """Every number of the reference, to the digits printed of the sources."""
    folder = shared_data / "radiance" / "util"
    sources, indirect = glarendx_input(folder / "glaresrc.txt")
    lines = (folder / "ref" / f"{name}.txt").read_text().splitlines()
    rows = [line.split() for line in lines if line[:1] in set("-0123456789")]
    ahead = np.array([-0.703298, 0.706112, 0.0])
    ahead /= np.linalg.norm(ahead)
    assert len(rows) == 19
    for angle, expected in np.array(rows, float):
        cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turned = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]]) @ ahead
        level = indirect[indirect[:, 0] == angle, 1][0]
        if name == "vert_ind":
            found = level
        elif name == "dgi":
            found = dgi_of(turned, sources, level)
        else:
            found = index_of(name, seen_from(turned, sources), level)
        # We take a comfort of 0 and of 100 beyond the range of ratings
        slack = 0.5 if name == "guth_vcp" else 1e-3
        assert found == pytest.approx(expected, rel=1e-3, abs=slack)
