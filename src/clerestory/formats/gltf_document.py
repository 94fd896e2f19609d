"""Document of a glTF 2.0 file: its items, buffers and accessors.

Reference: Khronos Group, glTF 2.0 specification, 2021.
"""

import base64
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field

from clerestory.checks import require
from clerestory.documents import Item, Number, parse_json
from clerestory.errors import InputError
from clerestory.files import read_bytes

# Drawing modes of a primitive with triangles
TRIANGLES, STRIP, FAN = 4, 5, 6

_JSON, _BIN = 0x4E4F534A, 0x004E4942
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

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


class GltfPrimitive(Item):
    """Faces of one material."""

    attributes: dict[str, _Size]
    indices: _Size | None = None
    material: _Size | None = None
    mode: int = TRIANGLES


class GltfMesh(Item):
    """Primitives that are placed together."""

    name: str = "mesh"
    primitives: list[GltfPrimitive]


class _Colour(Item):
    baseColorFactor: _Four = (1.0, 1.0, 1.0, 1.0)


class GltfMaterial(Item):
    """Name and base colour of a material."""

    name: str = ""
    pbrMetallicRoughness: _Colour = _Colour()


class GltfNode(Item):
    """Place of a mesh, or of other nodes."""

    name: str = ""
    mesh: _Size | None = None
    children: tuple[_Size, ...] = ()
    matrix: Annotated[list[Number], Field(min_length=16, max_length=16)] | None = None
    rotation: _Four = (0.0, 0.0, 0.0, 1.0)
    scale: _Three = (1.0, 1.0, 1.0)
    translation: _Three = (0.0, 0.0, 0.0)


class _Scene(Item):
    nodes: tuple[_Size, ...] = ()


class GltfDocument(Item):
    """All items of a file that are read."""

    asset: dict[str, object]
    extensionsRequired: tuple[str, ...] = ()
    scene: _Size = 0
    scenes: tuple[_Scene, ...] = ()
    nodes: tuple[GltfNode, ...] = ()
    meshes: tuple[GltfMesh, ...] = ()
    materials: tuple[GltfMaterial, ...] = ()
    accessors: tuple[_Accessor, ...] = ()
    bufferViews: tuple[_View, ...] = ()
    buffers: tuple[dict[str, object], ...] = ()


def read_document(path: Path) -> tuple[GltfDocument, list[bytes]]:
    """Return the document of a .gltf or .glb file, and its buffers."""
    data = read_bytes(path)
    text, binary = _chunks(data) if data[:4] == b"glTF" else (data, None)
    document = parse_json(text, GltfDocument, file=path)
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


def element(elements: Sequence[_Element], what: str, index: int | None) -> _Element:
    """Return an element of a list of the document; `what` is the name of the list."""
    known = index is not None and index < len(elements)
    message = f"{what}[{index}] is missing; the file has {len(elements)} {what}"
    require(known, message)
    return elements[index or 0]


def accessor_values(
    document: GltfDocument, buffers: list[bytes], number: int | None, width: int
) -> np.ndarray:
    """Return the numbers of an accessor, as rows of `width` numbers."""
    accessor = element(document.accessors, "accessors", number)
    where, kind = f"accessors[{number}]", _TYPES.get(accessor.componentType)
    plain = _COUNTS.get(accessor.type) == width and accessor.sparse is None
    if kind is None or not plain:
        message = f"{where} is sparse or has the wrong type; a dense accessor of"
        raise InputError(f"{message} {width} number(s) per element expected")
    view = element(document.bufferViews, "bufferViews", accessor.bufferView)
    data = element(buffers, "buffers", view.buffer)
    item = np.dtype(kind).itemsize
    stride = view.byteStride or item * width
    start = view.byteOffset + accessor.byteOffset
    last = start + (accessor.count - 1) * stride + item * width
    inside = stride >= item * width and last <= len(data)
    require(inside, f"{where} exceeds its buffer; at most {len(data)} bytes expected")
    layout = np.ndarray((accessor.count, width), kind, data, start, (stride, item))
    require(np.isfinite(layout).all(), f"{where} has values that are not finite")
    return layout
