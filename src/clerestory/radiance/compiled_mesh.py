"""Reader of triangle meshes compiled by Radiance's obj2mesh (.rtm).

Vertices are stored in patches of up to 256, as fractions of a bounding cube. Most
triangles have all vertices in one patch; some have one or two vertices in other
patches. Vertex normals and texture coordinates are ignored.

Reference: Radiance, common/mesh.h, mesh.c, readmesh.c.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clerestory.array_types import Faces, Vector, Vertices
from clerestory.radiance.compiled import MESH_HEADER, Reader
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import number

_VERTICES, _NORMALS, _COORDINATES = 1, 2, 4

# Range of vertex indices reserved for each patch
_PATCH = 256
_MOST_TRIANGLES = 512

_NO_MATERIAL = -1


@dataclass(frozen=True, eq=False)
class CompiledMesh:
    """Material primitives and triangles of a compiled mesh.

    Faces are counter-clockwise as seen from the front; the material of a face is an
    empty name if the face has none.
    """

    items: tuple[Primitive, ...]
    vertices: Vertices
    faces: Faces
    material: tuple[str, ...]


def read_compiled_mesh(path: str | Path) -> CompiledMesh:
    """Return the triangles of a compiled mesh."""
    reader = Reader(path)
    size = reader.header(*MESH_HEADER)
    cube = [number(reader.text()) for _ in range(4)]
    known = [value for value in cube if value is not None]
    if len(known) != 4 or known[3] <= 0:
        raise reader.error("the bounds are not a cube")
    reader.reals(4)
    reader.skip_tree(size)
    items = reader.primitives(size)
    patches = _Patches(reader)
    for i in range(reader.whole(4)):
        patches.add(i)
    return patches.mesh(np.array(known[:3]), known[3], items)


@dataclass
class _Patches:
    reader: Reader
    vertices: list[np.ndarray] = field(default_factory=list)
    faces: list[np.ndarray] = field(default_factory=list)
    materials: list[np.ndarray] = field(default_factory=list)

    def add(self, patch: int) -> None:
        flags = self._within(1, 0, 7, "flags")
        if not flags & _VERTICES:
            raise self.reader.error("a patch without vertices")
        count = self._within(2, 1, _PATCH, "number of vertices")
        self.vertices.append(self._table(">u4", count, 3).astype(float))
        if flags & _NORMALS:
            self.reader.take(4 * count)
        if flags & _COORDINATES:
            self.reader.take(8 * count)
        self._own(patch)
        self._joining(patch, foreign=1)
        self._joining(patch, foreign=2)

    def _own(self, patch: int) -> None:
        # Triangles with all vertices in the patch, of one or several materials
        count = self._within(2, 0, _MOST_TRIANGLES, "number of triangles")
        corners = self._table("u1", count, 3).astype(np.int64) + _PATCH * patch
        if self.reader.whole(2) > 1:
            material = self._table(">i2", count, 1)[:, 0]
        else:
            material = np.full(count, self.reader.whole(2))
        self.faces.append(corners)
        self.materials.append(material.astype(int))

    def _joining(self, patch: int, *, foreign: int) -> None:
        # Triangles with one or two vertices in other patches
        count = self._within(2, 0, _PATCH, "number of joining triangles")
        width = 4 * foreign + (3 - foreign) + 2
        raw = self._table("u1", count, width)
        split = 4 * foreign
        others = np.ascontiguousarray(raw[:, :split]).view(">i4").astype(np.int64)
        own = raw[:, split:-2].astype(np.int64) + _PATCH * patch
        self.faces.append(np.concatenate([others.reshape(count, foreign), own], axis=1))
        ends = np.ascontiguousarray(raw[:, -2:]).view(">i2").reshape(count)
        self.materials.append(ends.astype(int))

    def _table(self, kind: str, rows: int, columns: int) -> np.ndarray:
        raw = self.reader.take(np.dtype(kind).itemsize * rows * columns)
        return np.frombuffer(raw, dtype=kind).reshape(rows, columns)

    def _within(self, size: int, low: int, high: int, what: str) -> int:
        value = self.reader.whole(size)
        if not low <= value <= high:
            raise self.reader.error(f"{what} of a patch is {value}")
        return value

    def mesh(
        self,
        origin: Vector,
        size: float,
        items: tuple[Primitive, ...],
    ) -> CompiledMesh:
        if not self.vertices:
            raise self.reader.error("no triangles")
        # Vertex indices are renumbered without gaps between patches
        counts = np.array([len(v) for v in self.vertices])
        start = np.cumsum(counts) - counts
        given = np.concatenate(self.faces)
        patch, inside = given // _PATCH, given % _PATCH
        wrong = (given < 0) | (patch >= len(counts))
        patch = np.where(wrong, 0, patch)
        if np.any(wrong | (inside >= counts[patch])):
            raise self.reader.error("a triangle without its vertices")
        points = (np.concatenate(self.vertices) + 0.5) / 2.0**32
        material = np.concatenate(self.materials)
        if material.max(initial=-1) >= len(items):
            raise self.reader.error("a triangle without its material")
        names = [item.name for item in items]
        return CompiledMesh(
            items,
            origin + size * points,
            start[patch] + inside,
            tuple("" if m <= _NO_MATERIAL else names[m] for m in material.tolist()),
        )
