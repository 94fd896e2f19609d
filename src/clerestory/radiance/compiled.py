"""Reader of Radiance's compiled files: octrees (oconv) and meshes (obj2mesh).

Both kinds of file have a text header, an octree (skipped by this reader) and primitives
in a portable binary format. Numbers are big-endian; real numbers have a mantissa of
four bytes and an exponent of one byte. The vertices of a mesh are stored in patches of
up to 256, as fractions of a bounding cube. Most triangles have all vertices in one
patch; some have one or two vertices in other patches. Vertex normals and texture
coordinates are ignored.

Reference: Radiance, src/common: portio.c, octree.h, sceneio.c, readoct.c, mesh.c.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clerestory.array_types import Faces, Vector, Vertices
from clerestory.checks import require
from clerestory.files import read_bytes, read_start
from clerestory.radiance.statements import MODIFIER_KINDS, SURFACE_KINDS
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import number

_OCTREE = (b"Radiance_octree", 4 * 8 + 251)
MESH_HEADER = (b"Radiance_tmesh", 1 * 8 + 311)
_LARGEST_INTEGER = 8
_LONGEST_HEADER = 1 << 16
_MOST = 2**15

_EMPTY, _FULL, _TREE = range(3)


@dataclass(frozen=True)
class Octree:
    """An octree: its primitives if it is frozen, otherwise its scene files."""

    files: tuple[str, ...]
    items: tuple[Primitive, ...]

    def scene_files(self, find: Callable[[str], Path]) -> tuple[Path, ...]:
        """Return the paths of the scene files, which `find` looks for by name."""
        for name in self.files:
            require(
                not name.startswith("!"),
                f'the octree was compiled from the command "{name}"; a frozen octree'
                " (oconv -f) expected",
            )
        return tuple(map(find, self.files))


def is_octree(path: str | Path) -> bool:
    """Whether a file has the header of an octree; pipes and devices are not read."""
    start = read_start(path, _LONGEST_HEADER)
    if not start.startswith(b"#?"):
        return False
    return b"FORMAT=Radiance_octree" in start.partition(b"\n\n")[0].replace(b" ", b"")


def read_octree(path: str | Path) -> Octree:
    """Read the primitives or the scene files of an octree."""
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
    """Sequential reader of a compiled file; sizes are numbers of bytes."""

    def __init__(self, path: str | Path) -> None:
        self.data, self.path, self.at = read_bytes(path), path, 0

    def header(self, form: bytes, magic: int) -> int:
        """Skip the header; return the size of an object index [bytes]."""
        end = self.data.find(b"\n\n")
        known = end >= 0 and b"FORMAT=" + form in self.data[:end].replace(b" ", b"")
        self.require(known, f"the header has no FORMAT={form.decode()}")
        self.at = end + 2
        size = self.whole(2) - magic
        supported = 0 < size <= _LARGEST_INTEGER
        self.require(supported, "the version of the format is not supported")
        return size

    def require(self, valid: object, message: str) -> None:
        """Raise an error with the file name if a condition is false."""
        expected = "a file compiled by Radiance expected"
        require(valid, f"{message}; {expected}", file=self.path)

    def take(self, count: int) -> bytes:
        """Read `count` bytes."""
        part = self.data[self.at : self.at + count]
        self.require(len(part) == count, "the file ends early")
        self.at += count
        return part

    def whole(self, size: int) -> int:
        """Read a signed integer of `size` bytes."""
        return int.from_bytes(self.take(size), "big", signed=True)

    def within(self, size: int, low: int, high: int, what: str) -> int:
        """Read a signed integer from `low` to `high`."""
        value = self.whole(size)
        self.require(low <= value <= high, f"{what} is {value}")
        return value

    def text(self) -> str:
        """Read a zero-terminated string."""
        end = self.data.find(b"\0", self.at)
        self.require(end >= 0, "the file ends early")
        text = self.data[self.at : end].decode("utf-8", errors="replace")
        self.at = end + 1
        return text

    def table(self, kind: str, rows: int, columns: int) -> np.ndarray:
        """Read numbers of the NumPy data type `kind`."""
        raw = self.take(np.dtype(kind).itemsize * rows * columns)
        return np.frombuffer(raw, dtype=kind).reshape(rows, columns)

    def reals(self, count: int) -> tuple[float, ...]:
        """Read `count` real numbers."""
        raw = self.table("u1", count, 5)
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
                    at += size * (count + 1) if count >= 0 else len(data)
                elif kind != _EMPTY:
                    at = len(data)
        except IndexError:
            self.require(False, "the octree is damaged or ends early")
        self.at = at

    def primitives(self, size: int) -> tuple[Primitive, ...]:
        """Read the list of primitives."""
        kinds = []
        while kind := self.text():
            kinds.append(kind)
        items: list[Primitive] = []
        while (number := self.whole(1)) != -1:
            known = 0 <= number < len(kinds)
            self.require(known, f"a primitive has the unknown type {number}")
            items.append(self._primitive(kinds[number], items, size))
        return tuple(items)

    def _primitive(self, kind: str, before: list[Primitive], size: int) -> Primitive:
        modifier = self.whole(size)
        defined = modifier < len(before)
        self.require(defined, f"the modifier of the {kind} is defined after it")
        by = "void" if modifier < 0 else before[modifier].name
        name = self.text()
        count = self.within(2, 0, _MOST, "the number of arguments")
        strings = tuple(self.text() for _ in range(count))
        reals = self.reals(self.within(2, 0, _MOST, "the number of arguments"))
        if kind == "alias":
            target = strings[0] if strings else by
            by = by if strings else "inherit"
            return Primitive(by, kind, name, (target,), (), 0)
        known = kind in SURFACE_KINDS | MODIFIER_KINDS
        self.require(known, f'a primitive has the unknown type "{kind}"')
        return Primitive(by, kind, name, strings, reals, 0)


_VERTICES, _NORMALS, _COORDINATES = 1, 2, 4

# Number of vertex indices reserved for each patch
_PATCH = 256
_MOST_TRIANGLES = 512

_NO_MATERIAL = -1


@dataclass(frozen=True, eq=False)
class CompiledMesh:
    """Material primitives and triangles of a compiled mesh.

    Faces are counter-clockwise as seen from the front; `material` has the name of each
    face's material, empty if the face has none.
    """

    items: tuple[Primitive, ...]
    vertices: Vertices
    faces: Faces
    material: tuple[str, ...]


def read_compiled_mesh(path: str | Path) -> CompiledMesh:
    """Read the triangles and materials of a compiled mesh."""
    reader = Reader(path)
    size = reader.header(*MESH_HEADER)
    cube = [number(reader.text()) for _ in range(4)]
    known = [value for value in cube if value is not None]
    reader.require(len(known) == 4 and known[3] > 0, "the bounds are not a cube")
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
        flags = self.reader.within(1, 0, 7, "the value of the flags of a patch")
        self.reader.require(flags & _VERTICES, "a patch has no vertices")
        count = self.reader.within(2, 1, _PATCH, "the number of vertices of a patch")
        self.vertices.append(self.reader.table(">u4", count, 3).astype(float))
        if flags & _NORMALS:
            self.reader.take(4 * count)
        if flags & _COORDINATES:
            self.reader.take(8 * count)
        self._own(patch)
        self._joining(patch, foreign=1)
        self._joining(patch, foreign=2)

    def _own(self, patch: int) -> None:
        # Triangles with all vertices in the patch, of one or several materials
        count = self.reader.within(
            2, 0, _MOST_TRIANGLES, "the number of triangles of a patch"
        )
        corners = self.reader.table("u1", count, 3).astype(np.int64) + _PATCH * patch
        if self.reader.whole(2) > 1:
            material = self.reader.table(">i2", count, 1)[:, 0]
        else:
            material = np.full(count, self.reader.whole(2))
        self.faces.append(corners)
        self.materials.append(material.astype(int))

    def _joining(self, patch: int, *, foreign: int) -> None:
        # Triangles with one or two vertices in other patches
        count = self.reader.within(
            2, 0, _PATCH, "the number of joining triangles of a patch"
        )
        width = 4 * foreign + (3 - foreign) + 2
        raw = self.reader.table("u1", count, width)
        split = 4 * foreign
        others = np.ascontiguousarray(raw[:, :split]).view(">i4").astype(np.int64)
        own = raw[:, split:-2].astype(np.int64) + _PATCH * patch
        self.faces.append(np.concatenate([others.reshape(count, foreign), own], axis=1))
        ends = np.ascontiguousarray(raw[:, -2:]).view(">i2").reshape(count)
        self.materials.append(ends.astype(int))

    def mesh(
        self, origin: Vector, size: float, items: tuple[Primitive, ...]
    ) -> CompiledMesh:
        self.reader.require(self.vertices, "the mesh has no triangles")
        # Vertex indices are renumbered without gaps between patches
        counts = np.array([len(v) for v in self.vertices])
        start = np.cumsum(counts) - counts
        given = np.concatenate(self.faces)
        patch, inside = given // _PATCH, given % _PATCH
        wrong = (given < 0) | (patch >= len(counts))
        patch = np.where(wrong, 0, patch)
        complete = not np.any(wrong | (inside >= counts[patch]))
        self.reader.require(complete, "a triangle has vertices that do not exist")
        points = (np.concatenate(self.vertices) + 0.5) / 2.0**32
        material = np.concatenate(self.materials)
        defined = material.max(initial=-1) < len(items)
        self.reader.require(defined, "a triangle has a material that does not exist")
        names = [item.name for item in items]
        return CompiledMesh(
            items,
            origin + size * points,
            start[patch] + inside,
            tuple("" if m <= _NO_MATERIAL else names[m] for m in material.tolist()),
        )
