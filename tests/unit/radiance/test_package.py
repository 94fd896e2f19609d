"""Layers as surfaces of a scene, written to a file and read back."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.product_data import Geometry, Product
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.radiance.bsdf_package import layer_geometry, package
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    Glow,
    Illum,
    Interface,
    Metal,
    Mirror,
    Mixture,
    Plastic,
    Ring,
    Scene,
    Sphere,
    Spotlight,
    Trans,
    Void,
    same_material,
)
from clerestory.scene.transform import parse_transform

SLATS = """m white =
rd .7
v a =
p -500 -250 -40
v b =
p 500 -250 -40
v c =
p 500 -250 0
v d =
p -500 -250 0
xf -a 6 -t 0 100 0
f a b c d
xf
"""


def blind(**product):
    given = {
        "name": "Blind",
        "width": 1.0,
        "height": 0.5,
        "thickness": 0.04,
        "geometry": Geometry(SLATS, 0.001, 1),
    }
    layer = lambertian(0.4, klems("quarter"), reflectance=0.3)
    return replace(layer, product=Product(**(given | product)))


def test_geometry_comes_in_metres_and_goes_where_the_transform_says():
    slats = layer_geometry(blind())
    expected = [[-0.5, -0.25, -0.04], [0.5, 0.25, 0.0]]
    np.testing.assert_allclose(slats.bounds(), expected, atol=1e-12)
    move, _ = parse_transform(["-rx", "90", "-t", "0", "0", "2"])
    moved = layer_geometry(blind(), transform=move).bounds()
    np.testing.assert_allclose(moved[:, 2], [1.75, 2.25])


def test_a_layer_with_geometry_is_enclosed_by_two_surfaces():
    """Thickness is the depth of the geometry behind (+) or in front of (−) each."""
    scene = package(blind(), "blind")
    front, back = scene.surfaces[:2]
    assert (front.name, back.name) == ("blind_f", "blind_b")
    assert 0 < front.vertices[0, 2] < 1e-6
    assert -0.04001 < back.vertices[0, 2] < -0.04
    thickness = [scene.materials[s.material].thickness for s in (front, back)]
    np.testing.assert_allclose(thickness, [0.04, -0.04], rtol=1e-4)
    assert len(scene.surfaces) == 2 + 6


def test_a_layer_without_geometry_is_one_surface():
    scene = package(blind(geometry=None), "blind")
    assert [s.name for s in scene.surfaces] == ["blind"]
    assert scene.materials["m_blind"].thickness == 0


def test_a_layer_of_unknown_size_is_refused():
    with pytest.raises(InputError, match="no width and height"):
        package(blind(width=None), "blind")


@pytest.mark.parametrize("xform", ["", "-rx 90 -rz 30 -t 1 2 3", "-s 2 -mx"])
def test_a_packaged_layer_is_read_back_as_it_was(tmp_path, xform):
    write_bsdf(tmp_path / "a blind.xml", blind())
    layer = read_bsdf(tmp_path / "a blind.xml")
    move, _ = parse_transform(xform.split())
    scene = package(layer, "blind", transform=move)
    files = {
        key: "a blind.xml"
        for key, m in scene.materials.items()
        if isinstance(m, BsdfSurface)
    }
    (tmp_path / "blind.rad").write_text(format_rad(scene, bsdf_file=files))
    back = read_rad(tmp_path / "blind.rad")
    assert len(back.surfaces) == len(scene.surfaces) == 8
    for one, other in zip(scene.surfaces, back.surfaces, strict=True):
        np.testing.assert_allclose(other.vertices, one.vertices, atol=1e-9)
    for key in files:
        one, other = scene.materials[key], back.materials[key]
        assert other.thickness == pytest.approx(one.thickness)
        turned = [m.up @ m.transform for m in (one, other)]
        np.testing.assert_allclose(*turned, atol=1e-9)


def test_every_material_and_surface_is_read_back(tmp_path):
    red, up = np.array([0.5, 0.2, 0.1]), np.array([0.0, 0.0, 1.0])
    grey = Plastic("grey", np.full(3, 0.4), 0.02, 0.1)
    kinds = [
        grey,
        Metal("brushed", red, 0.5, np.array([0.1, 0.2]), up=up),
        Trans("film", red, 0.1, np.array([0.1, 0.2]), 0.4, 0.3, up=up),
        Dielectric("solid", np.array([0.9, 0.8, 0.7]), 1.5),
        Interface("sea", np.ones(3), 1.5, np.ones(3), 1.33),
        Mirror("looking_glass", red, grey),
        Mixture("net", grey, Void(), 0.25),
        Glow("sky", red, 2.0),
        Spotlight("spot", red, 20.0, up, 3.0),
        Illum("pane", red, Void()),
    ]
    surfaces = [
        Sphere(np.full(3, float(k)), 0.1, k % 2 == 1, m.name, f"s{k}")
        for k, m in enumerate(kinds)
    ]
    surfaces.append(Ring(np.zeros(3), up, 0.0, 1.0, "spot", "disc"))
    scene = Scene({m.name: m for m in kinds}, tuple(surfaces))
    (tmp_path / "all.rad").write_text(format_rad(scene, bsdf_file={}))
    back = read_rad(tmp_path / "all.rad")
    assert [s.name for s in back.surfaces] == [s.name for s in surfaces]
    for surface in surfaces:
        assert same_material(
            back.materials[surface.material], scene.materials[surface.material]
        )


def test_what_cannot_be_written_is_refused():
    with pytest.raises(InputError, match="no BSDF file is given"):
        format_rad(package(blind(), "blind"), bsdf_file={})
