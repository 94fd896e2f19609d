"""Reader of Radiance's compiled files: octrees (oconv) and meshes (obj2mesh).

Both kinds of file have a text header, an octree (skipped by this reader) and primitives
in a portable binary format. Numbers are big-endian; real numbers have a mantissa of
four bytes and an exponent of one byte.

Reference: Radiance, src/common: portio.c, octree.h, sceneio.c, readoct.c, readmesh.c.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.radiance.statements import MODIFIER_KINDS, SURFACE_KINDS
from clerestory.scene.primitive import Primitive

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
