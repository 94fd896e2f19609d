"""Mirrors of a system, and the patches that they make alike."""

import numpy as np
import pytest

from clerestory.bsdfgen.mirror_symmetry import NO_MIRROR, Orbits, mirror_flips
from clerestory.bsdfgen.screen_geometry import perforated, woven
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.bsdfgen.venetian_geometry import venetian
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.model import Plastic, Polygon, Ring, Scene, Trans

BOX = SampleArea(np.array([[0.0, 0, -0.1], [1, 2, 0]]))
GREY = Plastic("grey", np.full(3, 0.5))
LEFT_RIGHT = ((1, 1), (-1, 1))


def scene(*corners, material=GREY):
    polygons = (Polygon(np.array(c, dtype=float), material.name) for c in corners)
    return Scene({material.name: material}, tuple(polygons))


SLAT = [(0.1, 0.3, -0.1), (0.9, 0.3, -0.1), (0.9, 0.5, 0), (0.1, 0.5, 0)]


def moved(corners, by):
    return [tuple(np.add(corner, by)) for corner in corners]


def test_blinds_mirror_left_to_right_and_screens_both_ways():
    blind = venetian(slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.5)
    assert mirror_flips(blind.scene, blind.area) == LEFT_RIGHT
    upright = venetian(
        slat_width=0.08, spacing=0.072, tilt_deg=45, reflectance=0.5, vertical=True
    )
    assert mirror_flips(upright.scene, upright.area) == ((1, 1), (1, -1))
    for screen in (perforated(), woven()):
        assert len(mirror_flips(screen.scene, screen.area)) == 4


def test_a_slat_off_the_middle_has_no_mirror():
    assert mirror_flips(scene(SLAT), BOX) == LEFT_RIGHT
    assert mirror_flips(scene(moved(SLAT, (1e-3, 0, 0))), BOX) == NO_MIRROR


def test_rounding_of_files_does_not_matter():
    assert mirror_flips(scene(moved(SLAT, (1e-7, 0, 0))), BOX) == LEFT_RIGHT


def test_a_turned_pair_is_its_own_image_by_both_mirrors_together():
    """Half a turn about z is left-right and top-bottom at once."""
    turned = [(1 - x, 2 - y, z) for x, y, z in SLAT[:3]]
    assert mirror_flips(scene(SLAT[:3], turned), BOX) == ((1, 1), (-1, -1))


def test_front_and_back_of_a_surface_differ():
    """A triangle in the mirror's plane, and its image with the front turned away."""
    one = [(0.2, 0, -0.1), (0.2, 1, -0.1), (0.2, 1, 0)]
    image = [(0.8, 0, -0.1), (0.8, 1, -0.1), (0.8, 1, 0)]
    material = Trans("grey", np.full(3, 0.5))
    same = scene(one, image[::-1], material=material)
    other = scene(one, image, material=material)
    assert mirror_flips(same, BOX) == LEFT_RIGHT
    assert mirror_flips(other, BOX) == NO_MIRROR


def test_equal_places_of_different_materials_are_no_mirror():
    black = Plastic("black", np.zeros(3))
    one = [(0.2, 0, -0.1), (0.2, 1, -0.1), (0.2, 1, 0)]
    image = [(1 - x, y, z) for x, y, z in one[::-1]]
    both = Scene(
        {"grey": GREY, "black": black},
        (Polygon(np.array(one), "grey"), Polygon(np.array(image), "black")),
    )
    assert mirror_flips(both, BOX) == NO_MIRROR


def test_grain_and_unknown_shapes_have_no_mirror():
    brushed = Plastic(
        "grey", np.full(3, 0.5), 0.1, np.array([0.1, 0.2]), up=np.array([1.0, 1, 0])
    )
    assert mirror_flips(scene(SLAT, material=brushed), BOX) == NO_MIRROR
    ring = Ring(np.array([0.5, 1, -0.05]), np.array([0.0, 0, 1]), 0, 0.1, "grey")
    assert mirror_flips(Scene({"grey": GREY}, (ring,)), BOX) == NO_MIRROR


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
@pytest.mark.parametrize("flips", [LEFT_RIGHT, ((1, 1), (1, -1), (-1, 1), (-1, -1))])
def test_a_symmetric_matrix_is_unfolded_from_its_chosen_rows(basis, flips):
    """A function of directions that is symmetric itself is known from a part of it."""
    partition = klems(basis)
    centre = partition.centres()
    shifted = centre + np.array([0.2, 0.4, 0])
    table = np.zeros((len(partition), len(partition)))
    for flip in flips:
        image = centre * [*flip, 1]
        table += np.exp(2 * image @ centre.T) + np.exp(
            (image * [1, 3, 1] + [0.3, -0.2, 0]) @ shifted.T
        )
    # Average over the mirrors acting on both ends
    images = [partition.find(centre * [*flip, 1]) for flip in flips]
    table = np.mean([table[np.ix_(i, i)] for i in images], axis=0)
    orbits = Orbits.of(partition, flips)
    assert len(orbits.chosen) < len(partition) / len(flips) + 24
    assert np.bincount(orbits.kind).sum() == len(partition)
    assert orbits.unfolded(table[orbits.chosen]) == pytest.approx(table)


def test_mirrors_that_split_patches_are_left_out():
    odd = RingPartition("odd", np.array([1, 3]), np.array([0, 0.5, np.pi / 2]))
    assert len(Orbits.of(odd, ((1, 1), (1, -1))).flips) == 1
    assert len(Orbits.of(odd, LEFT_RIGHT).flips) == 2
