"""Reader of Radiance's compiled files: octrees (oconv) and meshes (obj2mesh).

Both kinds of file have a text header, an octree (skipped by this reader) and primitives
in a portable binary format. Numbers are big-endian; real numbers have a mantissa of
four bytes and an exponent of one byte. The vertices of a mesh are stored in patches of
up to 256, as fractions of a bounding cube. Most triangles have all vertices in one
patch; some have one or two vertices in other patches. Vertex normals and texture
coordinates are ignored.

Reference: Radiance, src/common: portio.c, octree.h, sceneio.c, readoct.c, mesh.c.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clerestory.array_types import Faces, Vector, Vertices
from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.radiance.statements import MODIFIER_KINDS, SURFACE_KINDS
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import number

_OCTREE = (b"Radiance_octree", 4 * 8 + 251)
MESH_HEADER = (b"Radiance_tmesh", 1 * 8 + 311)
_LARGEST_INTEGER = 8

_EMPTY, _FULL, _TREE = range(3)


@dataclass(frozen=True)
class Octree:
    """Primitives of a frozen octree, or scene files of any other octree."""

    files: tuple[str, ...]
    items: tuple[Primitive, ...]


def read_octree(path: str | Path) -> Octree:
    """Return the scene files or primitives of an octree."""
    reader = Reader(path)
    size = reader.header(*_OCTREE)
    for _ in range(4):
        reader.text()
    files = []
    while name := reader.text():
        files.append(name)
    reader.whole(size)
    if files:
        return Octree(tuple(files), ())
    reader.skip_tree(size)
    return Octree((), reader.primitives(size))


class Reader:
    """Sequential reader of a compiled file."""

    def __init__(self, path: str | Path) -> None:
        self.data, self.path, self.at = read_bytes(path), path, 0

    def header(self, form: bytes, magic: int) -> int:
        """Skip the header; return the number of bytes of an object index."""
        end = self.data.find(b"\n\n")
        if end < 0 or b"FORMAT=" + form not in self.data[:end].replace(b" ", b""):
            raise self.error(f"the header has no FORMAT={form.decode()}")
        self.at = end + 2
        size = self.whole(2) - magic
        if not 0 < size <= _LARGEST_INTEGER:
            raise self.error("the version of the format is not supported")
        return size

    def error(self, message: str) -> InputError:
        """Return an error about the file."""
        expected = "a file compiled by Radiance expected"
        return InputError(f"{message}; {expected}", file=self.path)

    def take(self, count: int) -> bytes:
        """Read `count` bytes."""
        part = self.data[self.at : self.at + count]
        if len(part) < count:
            raise self.error("the file ends early")
        self.at += count
        return part

    def whole(self, size: int) -> int:
        """Read a signed integer of `size` bytes."""
        return int.from_bytes(self.take(size), "big", signed=True)

    def text(self) -> str:
        """Read a zero-terminated string."""
        end = self.data.find(b"\0", self.at)
        if end < 0:
            raise self.error("the file ends early")
        text = self.data[self.at : end].decode("utf-8", errors="replace")
        self.at = end + 1
        return text

    def reals(self, count: int) -> tuple[float, ...]:
        """Read `count` real numbers."""
        raw = np.frombuffer(self.take(5 * count), dtype=np.uint8).reshape(count, 5)
        mantissa = np.ascontiguousarray(raw[:, :4]).view(">i4")[:, 0].astype(float)
        exponent = raw[:, 4].view(np.int8).astype(int)
        # The mantissa is a fraction of 2³¹-1, rounded towards 0
        fraction = (mantissa + np.sign(mantissa) * 0.5) / 0x7FFFFFFF
        return tuple(np.ldexp(fraction, exponent).tolist())

    def skip_tree(self, size: int) -> None:
        """Skip an octree with object indices of `size` bytes."""
        data, at, left = self.data, self.at, 1
        try:
            while left:
                kind, at, left = data[at], at + 1, left - 1
                if kind == _TREE:
                    left += 8
                elif kind == _FULL:
                    count = int.from_bytes(data[at : at + size], "big", signed=True)
                    if count < 0:
                        raise self.error("damaged octree")
                    at += size * (count + 1)
                elif kind != _EMPTY:
                    raise self.error("damaged octree")
        except IndexError:
            raise self.error("the file ends early") from None
        self.at = at

    def primitives(self, size: int) -> tuple[Primitive, ...]:
        """Read the primitives up to the end of their list."""
        kinds = []
        while kind := self.text():
            kinds.append(kind)
        items: list[Primitive] = []
        while (number := self.whole(1)) != -1:
            if not 0 <= number < len(kinds):
                raise self.error(f"a primitive of unknown type {number}")
            items.append(self._primitive(kinds[number], items, size))
        return tuple(items)

    def _primitive(self, kind: str, before: list[Primitive], size: int) -> Primitive:
        modifier = self.whole(size)
        if modifier >= len(before):
            raise self.error(f"the modifier of a {kind} is defined after it")
        by = "void" if modifier < 0 else before[modifier].name
        name = self.text()
        strings = tuple(self.text() for _ in range(self._count(2)))
        reals = self.reals(self._count(2))
        if kind == "alias":
            target = strings[0] if strings else by
            by = by if strings else "inherit"
            return Primitive(by, kind, name, (target,), (), 0)
        if kind not in SURFACE_KINDS and kind not in MODIFIER_KINDS:
            raise self.error(f'a primitive of unknown type "{kind}"')
        return Primitive(by, kind, name, strings, reals, 0)

    def _count(self, size: int) -> int:
        count = self.whole(size)
        if count < 0:
            raise self.error("a negative count")
        return count


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
