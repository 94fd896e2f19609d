"""Reader of glTF 2.0 files (.gltf, .glb).

The scene contains the triangles of all nodes, transformed to metres with z up.
Textures, animations, skins and cameras are ignored.

Reference: Khronos Group, glTF 2.0 specification, 2021.
"""

import base64
import struct
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field
from scipy.spatial.transform import Rotation

from clerestory.checks import require
from clerestory.documents import Item, Number, parse_json
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.files import read_bytes
from clerestory.scene.model import (
    Material,
    Plastic,
    Scene,
    TriangleMesh,
    insert_material,
)
from clerestory.scene.transform import LARGEST

_JSON, _BIN = 0x4E4F534A, 0x004E4942
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6

# Largest depth of nodes, and largest number of nodes or tens of triangles
_DEEPEST, _LARGEST = 64, 1_000_000

# Rotation from y up to z up
_TURN = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])

_Size = Annotated[int, Field(ge=0)]
_Four = tuple[Number, Number, Number, Number]
_Three = tuple[Number, Number, Number]
_Element = TypeVar("_Element")


class _View(Item):
    buffer: _Size
    byteOffset: _Size = 0
    byteStride: _Size = 0


class _Accessor(Item):
    bufferView: _Size | None = None
    byteOffset: _Size = 0
    componentType: int
    count: Annotated[int, Field(ge=1)]
    type: str
    sparse: object = None


class _Primitive(Item):
    attributes: dict[str, _Size]
    indices: _Size | None = None
    material: _Size | None = None
    mode: int = _TRIANGLES


class _Mesh(Item):
    name: str = "mesh"
    primitives: list[_Primitive]


class _Colour(Item):
    baseColorFactor: _Four = (1.0, 1.0, 1.0, 1.0)


class _Material(Item):
    name: str = ""
    pbrMetallicRoughness: _Colour = _Colour()


class _Node(Item):
    name: str = ""
    mesh: _Size | None = None
    children: tuple[_Size, ...] = ()
    matrix: Annotated[list[Number], Field(min_length=16, max_length=16)] | None = None
    rotation: _Four = (0.0, 0.0, 0.0, 1.0)
    scale: _Three = (1.0, 1.0, 1.0)
    translation: _Three = (0.0, 0.0, 0.0)


class _Scene(Item):
    nodes: tuple[_Size, ...] = ()


class _Document(Item):
    asset: dict[str, object]
    extensionsRequired: tuple[str, ...] = ()
    scene: _Size = 0
    scenes: tuple[_Scene, ...] = ()
    nodes: tuple[_Node, ...] = ()
    meshes: tuple[_Mesh, ...] = ()
    materials: tuple[_Material, ...] = ()
    accessors: tuple[_Accessor, ...] = ()
    bufferViews: tuple[_View, ...] = ()
    buffers: tuple[dict[str, object], ...] = ()


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
    colours : whether to create diffuse materials, with the base colour in the file,
        for names that are not in `materials`
    scale : metres per unit of the file
    up : axis of the file that points up, "y" or "z"

    Raises
    ------
    InputError : the file is malformed, or has a material that is not in `materials`
    """
    used: dict[str, Material] = {}
    surfaces: list[TriangleMesh] = []
    turn = scale * (_TURN if up == "y" else np.eye(3))

    def parts(mesh: _Mesh) -> Iterator[tuple[np.ndarray, np.ndarray, str]]:
        # Faces, vertices and material of each primitive with triangles
        for primitive in mesh.primitives:
            faces, vertices = _triangles(document, buffers, primitive)
            if len(faces):
                material = _material(document, primitive, materials, colours)
                yield faces, vertices, insert_material(used, material)

    with located(file=path):
        document, buffers = _read(Path(path))
        nodes, places = _nodes(document)
        large = f"a matrix of nodes exceeds {LARGEST:.0e} m"
        require(bool(np.abs(places).max(initial=0) <= LARGEST), large)
        mirrored = np.linalg.det(places[:, :3, :3]) < 0
        known: dict[int, list[tuple[np.ndarray, np.ndarray, str]]] = {}
        for node, place, turned in zip(
            nodes, turn @ places[:, :3], mirrored, strict=True
        ):
            number = node.mesh or 0
            mesh = _element(document.meshes, "meshes", number)
            if number not in known:
                known[number] = list(parts(mesh))
            name = _word(node.name or mesh.name)
            for faces, vertices, key in known[number]:
                moved = vertices @ place[:, :3].T + place[:, 3]
                seen = faces[:, ::-1] if turned else faces
                surfaces.append(TriangleMesh(moved, seen, key, name))
        require(surfaces, "no triangles; a mesh expected")
    return Scene(used, tuple(surfaces))


def _read(path: Path) -> tuple[_Document, list[bytes]]:
    data = read_bytes(path)
    text, binary = _chunks(data) if data[:4] == b"glTF" else (data, None)
    document = parse_json(text, _Document, file=path)
    version, needed = str(document.asset.get("version")), document.extensionsRequired
    require(version.startswith("2"), f'glTF version "{version}"; 2.0 expected')
    names = ", ".join(needed)
    require(
        not needed, f"the file requires {names}; a file without extensions expected"
    )
    uris = [str(buffer.get("uri") or "") for buffer in document.buffers]
    return document, [_buffer(uri, binary, path) for uri in uris]


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    text, binary, at = b"", None, 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        chunk = data[at + 8 : at + 8 + length]
        require(len(chunk) == length, "the file ends within a chunk")
        if kind == _JSON:
            text = chunk
        elif kind == _BIN:
            binary = chunk
        at += 8 + length
    return text, binary


def _buffer(uri: str, binary: bytes | None, path: Path) -> bytes:
    if not uri and binary is not None:
        return binary
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except ValueError as error:
            raise InputError("a buffer is not base64") from error
    inside = uri not in ("", ".", "..") and "/" not in uri and "\\" not in uri
    shown = f'buffer file "{uri[:60]}"'
    require(inside, f"{shown} is not in the folder of the glTF file")
    return read_bytes(path.parent / uri)


def _element(elements: Sequence[_Element], what: str, index: int | None) -> _Element:
    # Element of a list of the glTF document; `what` is the name of the list
    known = index is not None and index < len(elements)
    message = f"{what}[{index}] is missing; the file has {len(elements)} {what}"
    require(known, message)
    return elements[index or 0]


def _nodes(document: _Document) -> tuple[list[_Node], np.ndarray]:
    # Nodes with a mesh, and matrices from mesh to scene coordinates
    start = tuple(range(len(document.nodes)))
    if document.scenes:
        start = _element(document.scenes, "scenes", document.scene).nodes
    _require_few(document, start)
    own = _transforms(document.nodes)
    found: list[_Node] = []
    places: list[np.ndarray] = []
    waiting = [(number, np.eye(4)) for number in start]
    while waiting:
        number, place = waiting.pop()
        node = _element(document.nodes, "nodes", number)
        place = place @ own[number]
        if node.mesh is not None:
            found.append(node)
            places.append(place)
        waiting += [(child, place) for child in node.children]
    return found, np.array(places).reshape(-1, 4, 4)


def _transforms(nodes: tuple[_Node, ...]) -> np.ndarray:
    # Matrices from node coordinates to parent coordinates
    place = np.tile(np.eye(4), (len(nodes), 1, 1))
    if not nodes:
        return place
    rotation = np.array([node.rotation for node in nodes])
    nowhere = "a rotation by four zeros; a quaternion expected"
    require(rotation.any(axis=1).all(), nowhere)
    scale = np.array([node.scale for node in nodes])[:, None]
    place[:, :3, :3] = Rotation.from_quat(rotation).as_matrix() * scale
    place[:, :3, 3] = [node.translation for node in nodes]
    for number, node in enumerate(nodes):
        if node.matrix is not None:
            place[number] = np.array(node.matrix).reshape(4, 4).T
    return place


def _require_few(document: _Document, start: tuple[int, ...]) -> None:
    # Count the nodes and triangles of all nodes, each of which can have many parents
    meshes = [_size(document, mesh) for mesh in document.meshes]
    sizes: dict[int, int] = {}
    parents: list[int] = []

    def size(number: int) -> int:
        if number not in sizes:
            node = _element(document.nodes, "nodes", number)
            cyclic, deep = number in parents, len(parents) > _DEEPEST
            require(not cyclic, f"nodes[{number}] contains itself; a tree expected")
            require(not deep, f"more than {_DEEPEST} nested nodes; fewer expected")
            parents.append(number)
            own = 0 if node.mesh is None else _element(meshes, "meshes", node.mesh)
            inner = sum(size(child) for child in node.children)
            parents.pop()
            sizes[number] = 1 + own + inner
        return sizes[number]

    total = sum(size(number) for number in start)
    message = f"the nodes place meshes of a size of {min(total, 1e99):.2g}; at most"
    few = f"{message} {_LARGEST:,} (nodes, or tens of triangles) expected"
    require(total <= _LARGEST, few)


def _size(document: _Document, mesh: _Mesh) -> int:
    # Tens of triangles, and number of primitives
    total = 0
    for each in mesh.primitives:
        points = each.attributes.get("POSITION")
        index = points if each.indices is None else each.indices
        total += 1
        if index is not None and index < len(document.accessors):
            total += document.accessors[index].count // 30
    return total


def _triangles(
    document: _Document, buffers: list[bytes], primitive: _Primitive
) -> tuple[np.ndarray, np.ndarray]:
    mode, none = primitive.mode, (np.zeros((0, 3), int), np.zeros((0, 3)))
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        message = "points and lines of a glTF file are ignored"
        warnings.warn(message, ClerestoryWarning, stacklevel=2)
        return none
    vertices = _values(document, buffers, primitive.attributes.get("POSITION"), 3)
    index = np.arange(len(vertices))
    if primitive.indices is not None:
        index = _values(document, buffers, primitive.indices, 1)[:, 0].astype(int)
    last = index.max(initial=-1)
    known = last < len(vertices) and index.min(initial=0) >= 0
    require(known, f"a face has vertex {last}; numbers below {len(vertices)} expected")
    if mode == _TRIANGLES:
        return index[: len(index) // 3 * 3].reshape(-1, 3), vertices.astype(float)
    if len(index) < 3:
        return none
    first = index[:-2] if mode == _STRIP else np.full(len(index) - 2, index[0])
    faces = np.stack([first, index[1:-1], index[2:]], axis=1)
    if mode == _STRIP:
        faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces, vertices.astype(float)


def _values(
    document: _Document, buffers: list[bytes], number: int | None, width: int
) -> np.ndarray:
    # Numbers of a glTF accessor, as rows of `width` numbers
    accessor = _element(document.accessors, "accessors", number)
    where, kind = f"accessors[{number}]", _TYPES.get(accessor.componentType)
    plain = _COUNTS.get(accessor.type) == width and accessor.sparse is None
    if kind is None or not plain:
        message = f"{where} is sparse or has the wrong type; a dense accessor of"
        raise InputError(f"{message} {width} number(s) per element expected")
    view = _element(document.bufferViews, "bufferViews", accessor.bufferView)
    data = _element(buffers, "buffers", view.buffer)
    item = np.dtype(kind).itemsize
    stride = view.byteStride or item * width
    start = view.byteOffset + accessor.byteOffset
    last = start + (accessor.count - 1) * stride + item * width
    inside = stride >= item * width and last <= len(data)
    require(inside, f"{where} exceeds its buffer; at most {len(data)} bytes expected")
    layout = np.ndarray((accessor.count, width), kind, data, start, (stride, item))
    require(np.isfinite(layout).all(), f"{where} has values that are not finite")
    return layout


def _material(
    document: _Document,
    primitive: _Primitive,
    given: Mapping[str, Material],
    colours: bool,
) -> Material:
    item = _Material()
    if primitive.material is not None:
        item = _element(document.materials, "materials", primitive.material)
    if item.name in given:
        return given[item.name]
    if colours:
        colour = np.clip(item.pbrMetallicRoughness.baseColorFactor[:3], 0, 1)
        return Plastic(_word(item.name) or "unnamed", colour)
    if "*" in given:
        return given["*"]
    raise InputError(f'no material is given for "{item.name}" or "*"; one expected')


def _word(name: str) -> str:
    return "_".join(name.split())
