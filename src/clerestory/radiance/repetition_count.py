"""Number of surfaces of a scene file, before copies are made."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from clerestory.errors import InputError
from clerestory.radiance.contents import Content, Contents, Place
from clerestory.radiance.instance import INSTANCE_KINDS
from clerestory.radiance.placement import Placement
from clerestory.radiance.repetition import Item
from clerestory.radiance.statements import Command, PolygonRun
from clerestory.scene.model import TriangleMesh
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import Transform

# Largest number of surfaces that arrays, instances and repeated files may add
_MOST_REPEATED = 1_000_000

# Cost of a surface that is placed one by one, relative to surfaces placed together, and
# vertices or triangles that cost as much as one surface
_SLOW, _VERTICES = 10, 10


@dataclass(frozen=True)
class RepetitionCount:
    """Numbers of surfaces of files and of what commands and instances insert.

    `together` tells whether the copies of a command's content are made together.
    """

    contents: Contents
    together: Callable[[Content], bool]
    _sizes: dict[Path, int] = field(default_factory=dict)

    def require_few(self, place: Place) -> None:
        """Raise an error if arrays, instances and files repeat too many surfaces."""
        inserting = [item for item in self.contents.items(place.path) if _inserts(item)]
        sizes = {item: self._size_of(item, place) for item in inserting}
        once = sum(map(_own_size, self.contents.loaded.values()))
        for together, most in (
            (True, _MOST_REPEATED),
            (False, _MOST_REPEATED // _SLOW),
        ):
            found = [i for i in inserting if self._together(i, place) == together]
            total = sum(sizes[item] for item in found)
            if total > once + most:
                raise InputError(
                    "arrays, instances and repeated files make"
                    f" {min(total, 1e99):.2g} surfaces; at most {most:,} expected"
                    + ("" if together else " if materials depend on the placement"),
                    file=place.path,
                    line=getattr(max(found, key=sizes.__getitem__), "line", None),
                )

    def _together(self, item: Item | Command, place: Place) -> bool:
        # Whether all copies by a command are transformed together
        if not isinstance(item, Command):
            return False
        return self.together(self.contents.inserted(item, place))

    def _size(self, place: Place) -> int:
        # Number of surfaces of a file with the files that it includes
        if place.path not in self._sizes:
            self._sizes[place.path] = self._size_all(
                self.contents.items(place.path), place
            )
        return self._sizes[place.path]

    def _size_all(self, items: tuple[Item | Command, ...], place: Place) -> int:
        inserted = sum(self._size_of(i, place) for i in items if _inserts(i))
        return 1 + _own_size(items) + inserted

    def _size_of(self, item: Item | Command, place: Place) -> int:
        assert isinstance(item, Command | Primitive)
        content = self.contents.inserted(item, place)
        below = (place.inner(file, Placement()) for file in content.files)
        once = self._size_all(content.items, place) + sum(map(self._size, below))
        if content.build is not None and (content.count > 1 or place.within):
            once += len(content.build(Transform()).surfaces)
        return content.count * once


def _inserts(item: Item | Command) -> bool:
    if isinstance(item, Primitive):
        return item.kind in INSTANCE_KINDS
    return isinstance(item, Command)


def _own_size(items: Iterable[Item | Command]) -> int:
    # Surfaces and definitions, without what commands insert; ten vertices of a polygon,
    # or ten triangles of a mesh, count as a surface
    size = 0
    for item in items:
        match item:
            case PolygonRun():
                size += max(len(item.modifier), len(item.vertices) // _VERTICES)
            case TriangleMesh():
                size += 1 + len(item.faces) // _VERTICES
            case _:
                size += 1
    return size
