"""Groups of three bands, as the engine traces them."""

import numpy as np
import pytest

from clerestory.bands import RGB, unnamed_bands
from clerestory.engine.channels import band_groups, channels_of
from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Illum, Light, Mixture, Plastic, Scene

GREY = Plastic("grey", np.full(3, 0.5))


@pytest.mark.parametrize("count", [1, 2, 4, 9, 20])
def test_the_groups_hold_all_bands(count):
    """In their order; the last one is repeated."""
    values = np.arange(1.0, count + 1)
    material = Mixture("mixed", Plastic("leaf", values), GREY, 0.5)
    scene = Scene({"mixed": material}, bands=unnamed_bands_of(count))
    groups = list(band_groups(scene))
    assert len(groups) == -(-count // 3)
    assert {group.bands for group in groups} == {RGB}
    found = [group.materials["mixed"].foreground.reflectance for group in groups]
    assert np.concatenate(found)[:count] == pytest.approx(values)
    assert np.concatenate(found)[count:] == pytest.approx(values[-1])
    for group in groups:
        assert group.materials["mixed"].background.reflectance == pytest.approx(0.5)


def unnamed_bands_of(count):
    bands = unnamed_bands(20)
    return type(bands)(bands.names[:count])


def test_rgb_is_one_group():
    scene = Scene({"grey": GREY})
    assert list(band_groups(scene)) == [scene]


def test_grey_scenes_have_one_channel():
    """What is emitted does not count; what is seen of an illum does."""
    nine = unnamed_bands(9)
    leaf, lamp = Plastic("leaf", np.linspace(0, 1, 9)), Light("lamp", np.arange(9.0))
    assert channels_of(Scene({"grey": GREY, "lamp": lamp}, bands=nine)) == 1
    assert channels_of(Scene({"leaf": leaf}, bands=nine)) == 9
    pane = Illum("pane", np.zeros(9), leaf)
    assert channels_of(Scene({"pane": pane}, bands=nine)) == 9
    assert channels_of(Scene({"red": Plastic("red", np.array([0.5, 0.1, 0.1]))})) == 3


@pytest.mark.parametrize(
    ("pattern", "accepted"),
    [("brightfunc p 2 Px . 0 0", True), ("colorfunc p 4 Px Py Pz . 0 0", False)],
)
def test_patterns_in_rgb_are_refused(tmp_path, pattern, accepted):
    """A multiplier that is the same in all bands serves any number of them."""
    file = tmp_path / "a.rad"
    file.write_text(
        f"void {pattern}\np plastic paint 0 0 5 .5 .5 .5 0 0\n"
        "paint polygon floor 0 0 9 0 0 0 1 0 0 1 1 0\n"
    )
    room = read_rad(file)
    scene = Scene(room.materials, room.surfaces, bands=unnamed_bands(9))
    if accepted:
        assert len(list(band_groups(scene))) == 3
    else:
        with pytest.raises(InputError, match="pattern or BSDF in red, green and blue"):
            list(band_groups(scene))
