"""Doubts about the geometry of a system name the item."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.geometry_checks import check_system
from clerestory.bsdfgen.shading_system import SampleArea, area_from_dimensions, area_of
from clerestory.bsdfgen.system_catalogue import SYSTEMS, make_system
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.scene.material import Source
from clerestory.scene.model import Dielectric, Plastic, Polygon, Scene

GREY = Plastic("grey", np.full(3, 0.5))
GLASS = Dielectric("glass", np.ones(3), 1.5)
NEEDED = {
    "venetian": {"slat_width": 0.08, "spacing": 0.072, "tilt_deg": 45.0},
    "fabric": {"openness": 0.05, "reflectance": 0.5},
    "diffuse_pane": {"transmittance": 0.5},
}


def quad(*corners, material="grey", name="slat", line=7):
    return Polygon(
        np.array(corners, dtype=float), material, name, Source("blind.rad", line)
    )


def doubts(*surfaces, material=GREY, periodic=False):
    scene = Scene({material.name: material}, surfaces)
    return check_system(scene, area_of(scene, periodic=periodic))


SLAT = quad((0, 0, -0.05), (1, 0, -0.05), (1, 0.05, 0), (0, 0.05, 0))


def box(material="glass", skip=(), flip=False):
    """The six sides of a box with their fronts outwards."""
    c = np.array([(x, y, z) for x in (0, 0.4) for y in (0, 0.5) for z in (-0.1, 0)])
    sides = [
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    ]
    return [
        quad(*c[list(side[::-1] if flip else side)], material=material, name=f"side{n}")
        for n, side in enumerate(sides)
        if n not in skip
    ]


def test_sound_systems_raise_no_doubt():
    assert doubts(SLAT) == ()
    assert doubts(*box(), material=GLASS) == ()


@pytest.mark.parametrize("kind", SYSTEMS)
def test_our_own_systems_raise_no_doubt(kind):
    system = make_system(kind, NEEDED.get(kind, {}))
    assert check_system(system.scene, system.area) == ()


def test_what_reaches_into_the_room_is_named():
    high = quad((0, 0, -0.05), (1, 0, -0.05), (1, 0.05, 0.02), line=9, name="edge")
    [text] = doubts(SLAT, high)
    assert text.startswith('blind.rad:9: polygon "edge" reaches 20 mm into the room')


def test_a_system_in_the_room_is_refused():
    with pytest.raises(InputError, match="all surfaces lie in the room"):
        doubts(quad((0, 0, 0.1), (1, 0, 0.1), (1, 1, 0.2)))


def test_millimetres_taken_for_metres_are_reported():
    scaled = quad(*(SLAT.vertices * 1000))
    assert any("millimetres" in text for text in doubts(scaled))


def test_a_dielectric_without_a_side_is_named():
    [text] = doubts(*box(skip=(3,)), material=GLASS)
    assert "open edge" in text
    assert '"glass" does not enclose a solid' in text
    assert text.startswith("blind.rad:7: polygon")


def moved(sides, offset, scale=1.0):
    return [replace(s, vertices=s.vertices * scale + offset) for s in sides]


INSIDE_OUT = {
    "box": box(flip=True),
    "one of two boxes": [*box(), *moved(box(flip=True), (1, 0, 0))],
    "the smaller one": [
        *moved(box(), 0, 1.5),
        *moved(box(flip=True), (2, 0, 0)),
    ],
    "box in a box with a gap": [
        *moved(box(flip=True), (1, 1, 0)),
        *moved(box(), (1.1, 1.1, -0.02), 0.5),
    ],
}


@pytest.mark.parametrize("solids", INSIDE_OUT.values(), ids=INSIDE_OUT)
def test_a_dielectric_inside_out_is_refused(solids):
    """Written as a BSDF, the box would transmit and reflect 104.5 % of the light."""
    with pytest.raises(InputError, match=r"blind.rad:7: .*\"glass\" is inside out"):
        doubts(*solids, material=GLASS)


def test_a_cavity_in_a_solid_has_inward_fronts():
    hollow = [*box(), *moved(box(flip=True), (0.1, 0.1, -0.02), 0.5)]
    assert doubts(*hollow, material=GLASS) == ()


def test_films_of_a_repeating_cell_may_be_open_at_its_sides():
    film = prismatic()
    assert check_system(film.scene, film.area) == ()
    finite = SampleArea(film.area.bounds, periodic=False)
    assert any("open edge" in text for text in check_system(film.scene, finite))


def test_surfaces_in_each_other_are_named():
    inner = quad(
        (0.2, 0.01, -0.04),
        (0.8, 0.01, -0.04),
        (0.8, 0.03, -0.02),
        line=12,
        name="stripe",
    )
    [text] = doubts(SLAT, inner)
    assert '"slat" and' in text
    assert '"stripe" are coplanar and overlap' in text


def test_neighbours_at_an_edge_do_not_overlap():
    upper = quad((0, 0.05, 0), (1, 0.05, 0), (1, 0, -0.05), (0, 0, -0.05))
    beside = quad((1, 0, -0.05), (2, 0, -0.05), (2, 0.05, 0), (1, 0.05, 0))
    assert doubts(SLAT, beside) == ()
    assert doubts(SLAT, upper) != ()


@pytest.mark.parametrize(
    "dimensions", [(0, 1, 0, 1), (0, 0, 0, 1, -1, 0), (0, 1, 0, 1, 0, -1)]
)
def test_boxes_without_size_are_refused(dimensions):
    with pytest.raises(InputError):
        area_from_dimensions(dimensions)


def test_an_empty_scene_has_no_box():
    with pytest.raises(InputError, match="no surfaces"):
        area_of(Scene())


@pytest.mark.parametrize("missing", [0, 3])
def test_more_light_than_arrives_is_refused(missing):
    """An open box with inward fronts: 103 to 105 % of the light leaves it."""
    scene = Scene({"glass": GLASS}, tuple(box(flip=True, skip=(missing,))))
    with (
        pytest.warns(ClerestoryWarning, match="open edge"),
        pytest.raises(InputError, match=r"10[345]\.\d% of the light"),
    ):
        generate_bsdf(scene, basis="quarter", samples=1024)
