"""Reader of glTF 2.0 files (.gltf, .glb).

The scene contains the triangles of all nodes, transformed to metres with z up.
Textures, animations, skins and cameras are ignored.

Reference: Khronos Group, glTF 2.0 specification, 2021.
"""

import base64
import binascii
import json
import struct
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_bytes
from clerestory.formats.json_item import Item
from clerestory.scene.model import (
    Material,
    Plastic,
    Scene,
    TriangleMesh,
    insert_material,
)

_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_DEEPEST = 64

# Rotation from y up to z up
_TURN = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


@dataclass(frozen=True, eq=False)
class _Document:
    root: Item
    buffers: list[bytes]

    def element(self, key: str, index: Any) -> Item:
        """Return an element of one of the document's lists."""
        elements = list(self.root.items(key))
        if type(index) is not int or not 0 <= index < len(elements):
            raise InputError(
                f"{key}: number {index!r}; one of {len(elements)} expected",
                file=self.root.file,
            )
        return elements[index]


def read_gltf(
    path: str | Path,
    *,
    materials: Mapping[str, Material],
    colours: bool = False,
    scale: float = 1.0,
    up: str = "y",
) -> Scene:
    """Return the triangles of a glTF file as a scene with z up.

    Parameters
    ----------
    materials : materials by name in the file; "*" for all other names
    colours : whether materials that are not in `materials` are diffuse, with the base
        colour in the file
    scale : metres per unit of the file; 1 by the glTF standard
    up : axis of the file that points up, "y" or "z"

    Raises
    ------
    InputError : the file is malformed, or has a material that is not in `materials`
    """
    document = _read(path)
    root = document.root
    used: dict[str, Material] = {}
    surfaces: list[TriangleMesh] = []
    turn = _TURN if up == "y" else np.eye(3)
    for node, place in _nodes(document):
        mesh = document.element("meshes", node.value["mesh"])
        name = node.text("name", "") or mesh.text("name", "mesh")
        for primitive in mesh.items("primitives"):
            faces, vertices = _triangles(document, primitive)
            if not len(faces):
                continue
            material = _material(document, primitive, materials, colours)
            moved = vertices @ place[:3, :3].T + place[:3, 3]
            if np.linalg.det(place[:3, :3]) < 0:
                faces = faces[:, ::-1]
            key = insert_material(used, material)
            surfaces.append(
                TriangleMesh(scale * moved @ turn.T, faces, key, _word(name))
            )
    if not surfaces:
        raise InputError("no triangles; a mesh expected", file=root.file)
    return Scene(used, tuple(surfaces))


def _read(path: str | Path) -> _Document:
    data = read_bytes(path)
    binary: bytes | None = None
    if data[:4] == b"glTF":
        text, binary = _chunks(data, path)
    else:
        text = data
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError("not glTF: no JSON in it", file=path) from error
    if not isinstance(value, dict):
        raise InputError("not glTF: an object expected", file=path)
    root = Item(value, "", str(path))
    version = root.item("asset").text("version", "")
    if not version.startswith("2"):
        raise InputError(f'glTF version "{version}"; 2.0 expected', file=path)
    for name in root.value.get("extensionsRequired") or []:
        raise InputError(f"needs the extension {name}; plain glTF expected", file=path)
    buffers = [_buffer(item, binary, Path(path)) for item in root.items("buffers")]
    return _Document(root, buffers)


def _chunks(data: bytes, path: str | Path) -> tuple[bytes, bytes | None]:
    text, binary, at = b"", None, 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        chunk = data[at + 8 : at + 8 + length]
        if len(chunk) < length:
            raise InputError("the file ends within a chunk", file=path)
        if kind == _JSON:
            text = chunk
        elif kind == _BIN:
            binary = chunk
        at += 8 + length
    return text, binary


def _buffer(item: Item, binary: bytes | None, path: Path) -> bytes:
    uri = item.text("uri", "")
    if not uri:
        if binary is None:
            raise item.wrong("uri", "the name of a file")
        return binary
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error as error:
            raise item.wrong("uri", "base64") from error
    if "/" in uri or "\\" in uri or uri in (".", ".."):
        raise item.wrong("uri", "the name of a file beside this one")
    return read_bytes(path.parent / uri)


def _nodes(document: _Document) -> list[tuple[Item, np.ndarray]]:
    # Nodes with a mesh, and transforms from their meshes to the scene
    root = document.root
    scenes = list(root.items("scenes"))
    if scenes:
        chosen = document.element("scenes", root.value.get("scene", 0))
        start = chosen.value.get("nodes") or []
    else:
        start = list(range(len(list(root.items("nodes")))))
    found: list[tuple[Item, np.ndarray]] = []
    waiting = [(number, np.eye(4), 0) for number in _numbers(start, root)]
    while waiting:
        number, place, depth = waiting.pop()
        node = document.element("nodes", number)
        if depth > _DEEPEST or len(found) > 1_000_000:
            raise InputError(f"{node.where}: cyclic nodes", file=root.file)
        place = place @ _transform(node)
        if "mesh" in node.value:
            found.append((node, place))
        children = _numbers(node.value.get("children") or [], node)
        waiting += [(child, place, depth + 1) for child in children]
    return found


def _numbers(value: Any, item: Item) -> list[int]:
    if not isinstance(value, list) or not all(type(one) is int for one in value):
        raise InputError(f"{item.where}: a list of numbers expected", file=item.file)
    return value


def _transform(node: Item) -> np.ndarray:
    if node.value.get("matrix") is not None:
        return _floats(node, "matrix", 16).reshape(4, 4).T
    place = np.eye(4)
    place[:3, :3] = _rotation(_floats(node, "rotation", 4, (0, 0, 0, 1)))
    place[:3, :3] *= _floats(node, "scale", 3, (1, 1, 1))
    place[:3, 3] = _floats(node, "translation", 3, (0, 0, 0))
    return place


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion / max(float(np.linalg.norm(quaternion)), 1e-12)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _floats(
    item: Item, key: str, count: int, default: tuple[float, ...] | None = None
) -> np.ndarray:
    value = item.value.get(key)
    if value is None and default is not None:
        return np.array(default, dtype=float)
    good = isinstance(value, list) and len(value) == count
    if not good or not all(type(x) in (int, float) for x in value or []):
        raise item.wrong(key, f"{count} numbers")
    try:
        numbers = np.array(value, dtype=float)
    except OverflowError as error:
        raise item.wrong(key, f"{count} numbers") from error
    if not np.all(np.isfinite(numbers)):
        raise item.wrong(key, f"{count} finite numbers")
    return numbers


def _triangles(document: _Document, primitive: Item) -> tuple[np.ndarray, np.ndarray]:
    mode = primitive.value.get("mode", _TRIANGLES)
    none = np.zeros((0, 3), int), np.zeros((0, 3))
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        warnings.warn(
            f"{primitive.file}: {primitive.where}: points and lines are ignored",
            ClerestoryWarning,
            stacklevel=2,
        )
        return none
    attributes = primitive.item("attributes").value
    vertices = _accessor(document, attributes.get("POSITION"), 3).astype(float)
    if primitive.value.get("indices") is None:
        index = np.arange(len(vertices))
    else:
        index = _accessor(document, primitive.value["indices"], 1)[:, 0].astype(int)
    if len(index) and not 0 <= index.min() <= index.max() < len(vertices):
        raise primitive.wrong("indices", f"numbers below {len(vertices)}")
    if mode == _TRIANGLES:
        return index[: len(index) // 3 * 3].reshape(-1, 3), vertices
    if len(index) < 3:
        return none
    first = index[:-2] if mode == _STRIP else np.full(len(index) - 2, index[0])
    faces = np.stack([first, index[1:-1], index[2:]], axis=1)
    if mode == _STRIP:
        faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces, vertices


def _accessor(document: _Document, number: Any, width: int) -> np.ndarray:
    accessor = document.element("accessors", number)
    kind = _TYPES.get(int(accessor.number("componentType")))
    if kind is None or _COUNTS.get(accessor.text("type")) != width:
        raise accessor.wrong("type", f"numbers in groups of {width}")
    if accessor.value.get("sparse") is not None:
        raise accessor.wrong("sparse", "plain accessors")
    count = int(accessor.number("count"))
    view = document.element("bufferViews", accessor.value.get("bufferView"))
    buffer = view.value.get("buffer")
    if type(buffer) is not int or not 0 <= buffer < len(document.buffers):
        raise view.wrong("buffer", "the number of a buffer")
    size = np.dtype(kind).itemsize * width
    stride = int(view.number("byteStride", 0.0)) or size
    start = int(view.number("byteOffset", 0.0) + accessor.number("byteOffset", 0.0))
    data = document.buffers[buffer]
    if count < 1 or start < 0 or stride < size:
        raise accessor.wrong("count", "a layout inside the buffer")
    if start + (count - 1) * stride + size > len(data):
        raise accessor.wrong("count", "no more than the buffer holds")
    layout = np.ndarray(
        (count, width), kind, data, start, (stride, np.dtype(kind).itemsize)
    )
    if layout.dtype.kind == "f" and not np.all(np.isfinite(layout)):
        raise accessor.wrong("bufferView", "finite numbers")
    return layout


def _material(
    document: _Document,
    primitive: Item,
    given: Mapping[str, Material],
    colours: bool,
) -> Material:
    number = primitive.value.get("material")
    item = None if number is None else document.element("materials", number)
    name = "" if item is None else item.text("name", "")
    if name in given:
        return given[name]
    if colours:
        factor = np.ones(4)
        if item is not None:
            pbr = item.item("pbrMetallicRoughness")
            factor = _floats(pbr, "baseColorFactor", 4, (1, 1, 1, 1))
        colour = np.clip(factor[:3], 0, 1)
        return Plastic(_word(name) or "unnamed", colour)
    if "*" in given:
        return given["*"]
    raise InputError(
        f'material "{name}" is not given; it or "*" expected', file=primitive.file
    )


def _word(name: str) -> str:
    return "_".join(name.split())
