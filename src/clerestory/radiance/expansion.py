"""Expansion of scene files: insertion of files, instances and generated surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

from clerestory.errors import located
from clerestory.radiance.compiled import is_octree, read_octree
from clerestory.radiance.contents import Content, Contents, Place, built
from clerestory.radiance.instance import INSTANCE_KINDS
from clerestory.radiance.placement import Placement, one_placement
from clerestory.radiance.repetition import (
    Item,
    Materials,
    Part,
    Placed,
    Scope,
    copied,
    joined,
    materials_of,
)
from clerestory.radiance.repetition_count import RepetitionCount
from clerestory.radiance.search_path import found_in
from clerestory.radiance.statements import Command, Directive, PolygonRun
from clerestory.scene.model import Scene
from clerestory.scene.primitive import Primitive


def placed_items(path: str | Path) -> Iterator[Placed]:
    """Yield the items of a scene file and of included files, in Radiance's order.

    Copies of surfaces by arrays and repeated files are counted before they are made. Of
    an octree, the items are those of its scene files or, if it is frozen, its own.
    """
    place = Place(Path(path), Placement())
    if is_octree(path):
        yield from _octree_items(place)
        return
    walk = _Walk(Contents(place.path.parent))
    RepetitionCount(walk.contents, walk.together).require_few(place)
    yield from walk.items(place)


def _octree_items(place: Place) -> Iterator[Placed]:
    octree = read_octree(place.path)
    # Names of files are relative to the folder in which oconv was run
    folders = [Path(), place.path.parent]
    with located(file=place.path):
        files = octree.scene_files(lambda name: found_in(name, folders))
    walk = _Walk(Contents(place.path.parent))
    yield from walk.given(built(octree.items, str(place.path)), place)
    for file in files:
        yield from placed_items(file)


@dataclass(frozen=True)
class _Walk:
    # Contents of files, with caches by path and by content of a command
    contents: Contents
    materials: dict[Path, Materials | None] = field(default_factory=dict)
    surfaces: dict[Path, tuple[Part, ...]] = field(default_factory=dict)
    joined: dict[Content, Materials | None] = field(default_factory=dict)

    def items(self, place: Place) -> Iterator[Placed]:
        yield from self.given(self.contents.items(place.path), place)

    def given(
        self, items: tuple[Item | Command, ...], place: Place
    ) -> Iterator[Placed]:
        for item in items:
            match item:
                case Command():
                    yield from self._included(item, place)
                case Primitive() if item.kind in INSTANCE_KINDS:
                    yield from self._instanced(item, place)
                case PolygonRun():
                    yield place.put(place.placement.polygons(item))
                case Primitive() | Directive() | Scope() | Scene():
                    yield place.put(item)
                case _:
                    yield place.put(place.placement.surface(item))

    def _included(self, command: Command, place: Place) -> Iterator[Placed]:
        content = self.contents.inserted(command, place)
        materials = self._materials_of(content)
        if materials is not None:
            # Define the materials once, and make all copies of the surfaces together
            for item, file in materials.definitions:
                yield Placed(item, file, place.placement)
            parts = self._parts_of(content)
            for copies in content.copies:
                moved = copies.then(one_placement(place.placement))
                yield from map(place.put, copied(parts, moved))
            return
        for own in chain.from_iterable(content.copies):
            inner = replace(place, placement=own.then(place.placement))
            yield from self.given(content.items, inner)
            if content.build is not None:
                with located(file=place.path, line=command.line):
                    scene = content.build(inner.placement.transform)
                yield inner.put(scene)
            for found in content.files:
                yield from self.items(place.inner(found, inner.placement))

    def _instanced(self, item: Primitive, place: Place) -> Iterator[Placed]:
        # Items of the file to which an instance or mesh refers
        content = self.contents.inserted(item, place)
        [[own]] = content.copies
        inner = replace(place, placement=own.then(place.placement))
        placed = chain(
            self.given(content.items, inner),
            *(self.items(place.inner(f, inner.placement)) for f in content.files),
        )
        if own.modifier is None:
            yield inner.put(Scope(opens=True))
            yield from placed
            yield inner.put(Scope(opens=False))
        else:
            # The modifier of an instance replaces the materials of all its surfaces
            yield from (p for p in placed if not isinstance(p.item, Primitive))

    def together(self, content: Content) -> bool:
        """Whether all copies of what a command inserts are made together."""
        return self._materials_of(content) is not None

    def _materials_of(self, content: Content) -> Materials | None:
        # Materials of a command's files; None if they depend on the placement
        if content not in self.joined:
            own = materials_of(content.items, "", lambda _: None)
            replaced = (copies.modifier for copies in content.copies)
            given = Materials((), frozenset(name for name in replaced if name))
            files = () if content.build else map(self._materials, content.files)
            found = [None if content.build else own, given, *files]
            self.joined[content] = joined(found)
        return self.joined[content]

    def _materials(self, path: Path) -> Materials | None:
        if path not in self.materials:
            place = Place(path, Placement())

            def inner(command: Command) -> Materials | None:
                return self._materials_of(self.contents.inserted(command, place))

            items = self.contents.items(path)
            self.materials[path] = materials_of(items, str(path), inner)
        return self.materials[path]

    def _parts_of(self, content: Content) -> tuple[Part, ...]:
        files = (self._parts(file) for file in content.files)
        return (*self._flat(content.items, None), *chain.from_iterable(files))

    def _parts(self, path: Path) -> tuple[Part, ...]:
        # Surfaces of a file and of the files that it includes
        if path not in self.surfaces:
            place = Place(path, Placement())
            self.surfaces[path] = tuple(self._flat(self.contents.items(path), place))
        return self.surfaces[path]

    def _flat(
        self, items: tuple[Item | Command, ...], place: Place | None
    ) -> Iterator[Part]:
        for item in items:
            match item:
                case Command() if place is not None:
                    content = self.contents.inserted(item, place)
                    for copies in content.copies:
                        yield from copied(self._parts_of(content), copies)
                case Command() | Primitive() | Directive() | Scope() | Scene():
                    pass  # definitions
                case _:
                    yield item
