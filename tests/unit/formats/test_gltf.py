"""glTF files of a cube made here, its area and volume as they must be."""

import base64
import json
import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import InputError
from clerestory.formats.gltf import read_gltf
from clerestory.radiance.material_map import read_material_map
from clerestory.scene.model import Glass, Plastic

CORNERS = np.array(
    [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype="<f4"
)
FACES = np.array(
    [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
        (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ],
    dtype="<u2",
)  # fmt: skip
GREY = {"*": Plastic("grey", np.full(3, 0.5))}


def document(node=None, uri=None):
    data = CORNERS.tobytes() + FACES.tobytes()
    buffer = {"byteLength": len(data)} | ({"uri": uri} if uri else {})
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "my cube"} | (node or {})],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0}, "indices": 1, "material": 0}
                ]
            }
        ],
        "materials": [
            {
                "name": "Red",
                "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1]},
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        ],
        "buffers": [buffer],
    }, data


def glb(path, value, data):
    text = json.dumps(value).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def volume(scene):
    """Of closed meshes whose fronts look outwards."""
    (mesh,) = scene.surfaces
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return float(np.einsum("fi,fi->", a, np.cross(b, c)) / 6)


def test_a_binary_cube_has_its_volume_and_stands_upright(tmp_path):
    value, data = document({"scale": [2, 3, 4]})
    glb(tmp_path / "a.glb", value, data)
    scene = read_gltf(tmp_path / "a.glb", materials=GREY)
    assert abs(volume(scene)) == pytest.approx(24)
    low, high = scene.bounds()
    assert (high - low).tolist() == [2, 4, 3]  # y up has become z up
    assert scene.surfaces[0].name == "my_cube"


def test_a_text_file_with_its_data_inside(tmp_path):
    _, data = document()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    value, _ = document({"translation": [0, 0, 5]}, uri)
    (tmp_path / "a.gltf").write_text(json.dumps(value))
    scene = read_gltf(tmp_path / "a.gltf", materials=GREY, up="z", scale=0.1)
    low, high = scene.bounds()
    np.testing.assert_allclose([low, high], [[0, 0, 0.5], [0.1, 0.1, 0.6]], atol=1e-7)


def test_a_mirrored_node_keeps_its_fronts_outside(tmp_path):
    glb(tmp_path / "a.glb", *document())
    glb(tmp_path / "b.glb", *document({"scale": [-1, 1, 1]}))
    plain = read_gltf(tmp_path / "a.glb", materials=GREY)
    mirrored = read_gltf(tmp_path / "b.glb", materials=GREY)
    assert volume(plain) == pytest.approx(volume(mirrored))


def test_a_turned_node(tmp_path):
    """A quarter turn about the file's y takes x to -z."""
    half = np.sqrt(0.5)
    glb(tmp_path / "a.glb", *document({"rotation": [0, half, 0, half]}))
    low, high = read_gltf(tmp_path / "a.glb", materials=GREY, up="z").bounds()
    np.testing.assert_allclose([low, high], [[0, 0, -1], [1, 1, 0]], atol=1e-6)


def test_materials_by_map_and_by_colour(tmp_path):
    glb(tmp_path / "a.glb", *document())
    coloured = read_gltf(tmp_path / "a.glb", materials={}, colours=True)
    assert coloured.materials["Red"].reflectance.tolist() == [0.8, 0.1, 0.1]
    with pytest.raises(InputError, match='no material is given for "Red"'):
        read_gltf(tmp_path / "a.glb", materials={})


def test_a_material_map_names_and_makes_materials(tmp_path):
    (tmp_path / "m.rad").write_text("void plastic oak 0 0 5 .5 .4 .3 0 0")
    (tmp_path / "m.toml").write_text(
        'file = "m.rad"\nscale = 0.001\n[materials]\nRed = "oak"\n'
        'Pane = { transmissivity = 0.9 }\n"*" = { reflectance = [0.1, 0.2, 0.3] }\n'
    )
    found = read_material_map(tmp_path / "m.toml")
    assert found.materials["Red"].name == "oak"
    assert isinstance(found.materials["Pane"], Glass)
    assert found.materials["*"].reflectance.tolist() == [0.1, 0.2, 0.3]
    assert found.scale == 0.001


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("scale = 1", "materials is missing"),
        ("[materials]\na = { reflectance = 2 }", "materials.a"),
        ('[materials]\na = "oak"', 'no material "oak"'),
        ("[", "not TOML"),
    ],
)
def test_a_wrong_map_is_refused(tmp_path, text, message):
    (tmp_path / "m.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        read_material_map(tmp_path / "m.toml")


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_a_damaged_file_is_refused_in_words(tmp_path, data):
    value, content = document()
    part = data.draw(st.sampled_from(sorted(value)))
    at = value[part]
    while isinstance(at, dict | list) and at:
        key = data.draw(st.sampled_from(list(at) if isinstance(at, dict) else [0]))
        if not isinstance(at[key], dict | list) or data.draw(st.booleans()):
            at[key] = data.draw(
                st.none() | st.integers(-3, 10**6) | st.text(max_size=3) | st.floats()
                | st.lists(st.integers(), max_size=4)
            )  # fmt: skip
            break
        at = at[key]
    glb(tmp_path / "a.glb", value, content[: data.draw(st.integers(0, 168))])
    with suppress(InputError):
        read_gltf(tmp_path / "a.glb", materials=GREY)
