"""Reader of glTF 2.0 files (.gltf, .glb).

The scene contains the triangles of all nodes, transformed to metres with z up.
Textures, animations, skins and cameras are ignored.

Reference: Khronos Group, glTF 2.0 specification, 2021.
"""

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.formats.gltf_document import (
    FAN,
    STRIP,
    TRIANGLES,
    GltfDocument,
    GltfMaterial,
    GltfMesh,
    GltfPrimitive,
    accessor_values,
    element,
    read_document,
)
from clerestory.formats.gltf_nodes import placed_nodes
from clerestory.scene.model import (
    Material,
    Plastic,
    Scene,
    TriangleMesh,
    insert_material,
)
from clerestory.scene.transform import LARGEST

# Rotation from y up to z up
_TURN = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


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

    def parts(mesh: GltfMesh) -> Iterator[tuple[np.ndarray, np.ndarray, str]]:
        # Faces, vertices and material of each primitive with triangles
        for primitive in mesh.primitives:
            faces, vertices = _triangles(document, buffers, primitive)
            if len(faces):
                material = _material(document, primitive, materials, colours)
                yield faces, vertices, insert_material(used, material)

    with located(file=path):
        document, buffers = read_document(Path(path))
        nodes, places = placed_nodes(document)
        large = f"a matrix of nodes exceeds {LARGEST:.0e} m"
        require(bool(np.abs(places).max(initial=0) <= LARGEST), large)
        mirrored = np.linalg.det(places[:, :3, :3]) < 0
        places = turn @ places[:, :3]
        turned_by_node = mirrored.tolist()
        known: dict[int, list[tuple[np.ndarray, np.ndarray, np.ndarray, str]]] = {}
        for k, node in enumerate(nodes):
            number = node.mesh or 0
            mesh = element(document.meshes, "meshes", number)
            if number not in known:
                known[number] = [
                    (faces, faces[:, ::-1], vertices, key)
                    for faces, vertices, key in parts(mesh)
                ]
            name = _word(node.name or mesh.name)
            for faces, back, vertices, key in known[number]:
                moved = vertices @ places[k, :, :3].T
                moved += places[k, :, 3]
                seen = back if turned_by_node[k] else faces
                surfaces.append(TriangleMesh(moved, seen, key, name))
        require(surfaces, "no triangles; a mesh expected")
    return Scene(used, tuple(surfaces))


def _triangles(
    document: GltfDocument, buffers: list[bytes], primitive: GltfPrimitive
) -> tuple[np.ndarray, np.ndarray]:
    mode, none = primitive.mode, (np.zeros((0, 3), int), np.zeros((0, 3)))
    if mode not in (TRIANGLES, STRIP, FAN):
        message = "points and lines of a glTF file are ignored"
        warnings.warn(message, ClerestoryWarning, stacklevel=2)
        return none
    vertices = accessor_values(
        document, buffers, primitive.attributes.get("POSITION"), 3
    )
    index = np.arange(len(vertices))
    if primitive.indices is not None:
        index = accessor_values(document, buffers, primitive.indices, 1)[:, 0].astype(
            int
        )
    last = index.max(initial=-1)
    known = last < len(vertices) and index.min(initial=0) >= 0
    require(known, f"a face has vertex {last}; numbers below {len(vertices)} expected")
    if mode == TRIANGLES:
        return index[: len(index) // 3 * 3].reshape(-1, 3), vertices.astype(float)
    if len(index) < 3:
        return none
    first = index[:-2] if mode == STRIP else np.full(len(index) - 2, index[0])
    faces = np.stack([first, index[1:-1], index[2:]], axis=1)
    if mode == STRIP:
        faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces, vertices.astype(float)


def _material(
    document: GltfDocument,
    primitive: GltfPrimitive,
    given: Mapping[str, Material],
    colours: bool,
) -> Material:
    item = GltfMaterial()
    if primitive.material is not None:
        item = element(document.materials, "materials", primitive.material)
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
