"""Nodes of a glTF document: where its meshes are placed in the scene."""

import numpy as np
from scipy.spatial.transform import Rotation

from clerestory.checks import require
from clerestory.formats.gltf_document import GltfDocument, GltfMesh, GltfNode, element

# Largest depth of nodes, and largest number of nodes or tens of triangles
_DEEPEST, _LARGEST = 64, 1_000_000


def placed_nodes(document: GltfDocument) -> tuple[list[GltfNode], np.ndarray]:
    """Return the nodes with a mesh, and matrices from mesh to scene coordinates."""
    start = tuple(range(len(document.nodes)))
    if document.scenes:
        start = element(document.scenes, "scenes", document.scene).nodes
    _require_few(document, start)
    own = _transforms(document.nodes)
    found: list[GltfNode] = []
    places: list[np.ndarray] = []
    waiting: list[tuple[int, np.ndarray | None]] = [(number, None) for number in start]
    while waiting:
        number, outer = waiting.pop()
        node = element(document.nodes, "nodes", number)
        place = own[number] if outer is None else outer @ own[number]
        if node.mesh is not None:
            found.append(node)
            places.append(place)
        waiting += [(child, place) for child in node.children]
    return found, np.array(places).reshape(-1, 4, 4)


def _transforms(nodes: tuple[GltfNode, ...]) -> np.ndarray:
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


def _require_few(document: GltfDocument, start: tuple[int, ...]) -> None:
    # Count the nodes and triangles of all nodes, each of which can have many parents
    meshes = [_size(document, mesh) for mesh in document.meshes]
    sizes: dict[int, int] = {}
    parents: list[int] = []

    def size(number: int) -> int:
        if number not in sizes:
            node = element(document.nodes, "nodes", number)
            cyclic, deep = number in parents, len(parents) > _DEEPEST
            require(not cyclic, f"nodes[{number}] contains itself; a tree expected")
            require(not deep, f"more than {_DEEPEST} nested nodes; fewer expected")
            parents.append(number)
            own = 0 if node.mesh is None else element(meshes, "meshes", node.mesh)
            inner = sum(size(child) for child in node.children)
            parents.pop()
            sizes[number] = 1 + own + inner
        return sizes[number]

    total = sum(size(number) for number in start)
    message = f"the nodes place meshes of a size of {min(total, 1e99):.2g}; at most"
    few = f"{message} {_LARGEST:,} (nodes, or tens of triangles) expected"
    require(total <= _LARGEST, few)


def _size(document: GltfDocument, mesh: GltfMesh) -> int:
    # Tens of triangles, and number of primitives
    total = 0
    for each in mesh.primitives:
        points = each.attributes.get("POSITION")
        index = points if each.indices is None else each.indices
        total += 1
        if index is not None and index < len(document.accessors):
            total += document.accessors[index].count // 30
    return total
