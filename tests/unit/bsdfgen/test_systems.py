"""Parametric systems: shapes, names, words and files."""

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Geometry
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.extrusion import arc
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.mgf_text import mgf_text
from clerestory.bsdfgen.screen_geometry import perforated, woven
from clerestory.bsdfgen.system_catalogue import (
    SYSTEMS,
    make_system,
    parse_parameters,
    read_system,
)
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.errors import InputError
from clerestory.formats.mgf import parse_mgf
from clerestory.hemisphere.klems import klems
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.tessellate import meshes

BLIND = {"slat_width": 0.08, "spacing": 0.072}


def area(scene):
    """Of all surfaces [m²]."""
    total = 0.0
    for mesh in meshes(scene):
        a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
        total += np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return total


def test_positive_tilt_lowers_the_outer_edge():
    blind = venetian(**BLIND, tilt_deg=30.0, slats=1, length=1.0)
    [slat] = blind.scene.surfaces
    outer = slat.vertices[np.argmin(slat.vertices[:, 2])]
    inner = slat.vertices[np.argmax(slat.vertices[:, 2])]
    assert inner[1] - outer[1] == pytest.approx(0.08 * math.sin(math.radians(30)))
    assert inner[2] == pytest.approx(0)
    assert outer[2] == pytest.approx(-0.08 * math.cos(math.radians(30)))


def test_vertical_slats_are_horizontal_ones_turned():
    flat = venetian(**BLIND, tilt_deg=30.0, slats=2, length=1.0)
    upright = venetian(**BLIND, tilt_deg=30.0, slats=2, length=1.0, vertical=True)
    one, other = (s.scene.surfaces[1].vertices for s in (flat, upright))
    assert np.allclose(other, np.column_stack([one[:, 1], -one[:, 0], one[:, 2]]))


@pytest.mark.parametrize("rise", [0.01, -0.01, 0.05])
def test_curved_slats_follow_a_circle(rise):
    """All points are as far from the centre; ends and middle are the chord's."""
    points = arc(0.1, rise)
    radius = (0.1**2 / 4 + rise**2) / (2 * abs(rise))
    centre = [0, -math.copysign(radius, rise)]
    assert np.linalg.norm(points - centre, axis=1) == pytest.approx(radius)
    assert points[[0, -1], 0] == pytest.approx([-0.05, 0.05])
    assert np.ptp(points[:, 1]) == pytest.approx(abs(rise), rel=2e-3)


def test_sides_of_different_colour_are_two_faces():
    blind = venetian(**BLIND, reflectance=0.7, reflectance_below=0.2, slats=1)
    facing = {"upper": [], "lower": []}
    for s in blind.scene.surfaces:
        v = s.vertices
        normal = np.cross(v[1] - v[0], v[2] - v[1])
        facing[s.material].append(normal[1] / np.linalg.norm(normal))
    assert max(facing["upper"]) == pytest.approx(1)
    assert min(facing["lower"]) == pytest.approx(-1)


def test_microlouvre_shades_at_its_cut_off():
    """Between two bars, the steepest straight line runs at the cut-off."""
    louvre = microlouvre(depth=1.25e-3, thickness=0.22e-3, cutoff_deg=40)
    high = louvre.area.size[1]
    count = round(high / (0.22e-3 + 1.25e-3 * math.tan(math.radians(40))))
    assert high / count == pytest.approx(0.22e-3 + 1.25e-3 * math.tan(math.radians(40)))


def test_prisms_have_the_angles_asked_for():
    film = prismatic(pitch=1e-3, upper_angle_deg=60, lower_angle_deg=30, base=1e-4)
    up, down = set(), set()
    for s in film.scene.surfaces:
        if s.name.startswith("prism"):
            v = s.vertices
            n = np.cross(v[1] - v[0], v[2] - v[1])
            n /= np.linalg.norm(n)
            angle = round(math.degrees(math.acos(-n[2])), 6)
            (up if n[1] > 0 else down).add(angle)
    assert (up, down) == ({60.0}, {30.0})


def test_open_area_of_screens():
    """What is not open is sheet: (1 - open) of the cell, on the front."""
    screen = perforated(pitch=2e-3, hole=1e-3)
    cell = float(np.prod(screen.area.size[:2]))
    assert area(screen.scene) / cell == pytest.approx(1 - math.pi / 16, rel=1e-6)
    square = perforated(pitch=2e-3, hole=1e-3, shape="square")
    assert area(square.scene) / cell == pytest.approx(0.75)


def test_threads_do_not_touch():
    screen = woven(spacing=1e-3, thread=0.3e-3)
    low, high = screen.scene.bounds()
    assert high[2] < 0
    assert low[2] > screen.area.bounds[0, 2] - 1e-9


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        ("blind", {}, "kind of system is 'blind'"),
        ("venetian", {"slat_width": 0.08}, "lacks the parameter 'spacing'"),
        ("venetian", {**BLIND, "tilt": 3}, "parameter of venetian is 'tilt'"),
        ("venetian", {**BLIND, "tilt_deg": "x"}, "a number expected"),
        ("venetian", {**BLIND, "vertical": 1}, "true or false expected"),
        ("venetian", {**BLIND, "tilt_deg": 91}, "-90 to 90"),
        ("venetian", {**BLIND, "slats": 2.5}, "a whole number from 1"),
        (
            "venetian",
            {**BLIND, "slats": 2, "length": 0.0},
            "a positive number expected",
        ),
        ("venetian", {"slat_width": -1, "spacing": 1}, "a positive number expected"),
        ("venetian", {**BLIND, "reflectance": 1.5}, "number from 0 to 1"),
        ("venetian", {"slat_width": 1, "spacing": 1e-6}, "at most 200000 expected"),
        ("prismatic", {"pitch": 1e-9}, "from 0 to 10000 expected"),
        ("perforated", {"hole": 0.01}, "less than the pitch"),
        ("fabric", {"openness": 1.0, "reflectance": 0.5}, "0 ≤ openness < 1"),
        (
            "diffuse_pane",
            {"transmittance": 0.8, "reflectance": 0.4},
            "sum of at most 1",
        ),
        ("prismatic", {"index": 0.5}, "above 1"),
        ("mirrored_channels", {"mirror_depth": 1.0}, "at most the thickness"),
        ("microlouvre", {"cutoff_deg": 95}, "between 0 and 90"),
    ],
)
def test_impossible_systems_are_refused(kind, values, message):
    with pytest.raises(InputError, match=message):
        make_system(kind, values)


@given(st.text(max_size=60))
def test_words_are_read_or_refused(text):
    with contextlib.suppress(InputError):
        assert isinstance(parse_parameters(text), dict)


@given(
    st.sampled_from(sorted(SYSTEMS)),
    st.dictionaries(
        st.sampled_from(
            [
                "slat_width",
                "spacing",
                "tilt_deg",
                "rise",
                "openness",
                "reflectance",
                "pitch",
                "hole",
                "thickness",
                "transmittance",
                "depth",
                "index",
            ]
        ),
        st.one_of(
            st.floats(allow_nan=True),
            st.text(max_size=3),
            st.booleans(),
            st.floats(0.001, 0.1),
        ),
        max_size=4,
    ),
)
def test_any_values_make_a_system_or_are_refused(kind, values):
    try:
        system = make_system(kind, values)
    except InputError:
        return
    assert np.isfinite(system.area.bounds).all()


def test_toml_files_name_what_is_wrong(tmp_path):
    file = tmp_path / "blind.toml"
    file.write_text('kind = "venetian"\nslat_width = 0.08\n')
    with pytest.raises(
        InputError, match=r"blind\.toml: venetian lacks the parameter 'spacing'"
    ):
        read_system(file)
    file.write_text("kind = [")
    with pytest.raises(InputError, match=r"blind\.toml:1: not TOML"):
        read_system(file)


@pytest.mark.parametrize("kind", ["venetian", "prismatic", "woven", "clear_pane"])
def test_geometry_comes_back_from_mgf(kind):
    """What is written is read as the same surfaces, moved to the middle of the area."""
    system = make_system(kind, BLIND if kind == "venetian" else {})
    back = parse_mgf(mgf_text(system.scene, system.area))
    assert len(back.surfaces) == len(system.scene.surfaces)
    assert area(back) == pytest.approx(area(system.scene), rel=1e-6)
    middle = [*system.area.bounds[:, :2].mean(axis=0), 0]
    assert np.allclose(back.bounds(), system.scene.bounds() - middle, rtol=0, atol=1e-8)


def test_geometry_stands_in_the_file(tmp_path):
    system = venetian(**BLIND)
    product = system.product
    text = mgf_text(system.scene, system.area)
    bsdf = Bsdf(
        lambertian(0.5, klems("quarter")).functions,
        type(product)(name="blind", geometry=Geometry(text)),
    )
    write_bsdf(tmp_path / "blind.xml", bsdf)
    assert '<MGFblock unit="meter">xf -t' in (tmp_path / "blind.xml").read_text()


@pytest.mark.parametrize("tilt", [0, 20, 45, 80])
def test_slats_are_those_of_genblinds(tmp_path, tilt):
    """Radiance's generator, turned into genBSDF's frame, up to where it begins."""
    file = tmp_path / "blind.rad"
    file.write_text(
        "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
        f"!genblinds grey blind 0.08 1 1.008 14 {tilt} | xform -rz -90 -rx -90\n"
    )
    theirs = read_rad(file)
    ours = venetian(
        slat_width=0.08, spacing=0.072, tilt_deg=tilt, slats=14, length=1.0
    ).scene
    places = []
    for scene in (theirs, ours):
        corners = np.array([slat.vertices for slat in scene.surfaces])
        corners -= corners.reshape(-1, 3).min(axis=0)
        # Sides of thin slats are alike: any corner may come first, either way round
        order = np.lexsort(corners.round(6).transpose(2, 0, 1), axis=-1)
        places.append(np.take_along_axis(corners, order[..., None], axis=1))
    assert places[0] == pytest.approx(places[1], abs=1e-6)
