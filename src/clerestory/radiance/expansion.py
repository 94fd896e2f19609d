"""Expansion of scene files: insertion of files, instances and generated surfaces."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain, groupby
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.radiance.command import parse_command
from clerestory.radiance.generators.catalogue import Build
from clerestory.radiance.instance import INSTANCE_KINDS, Loaded, read_instance
from clerestory.radiance.placement import Placement, Placements, one_placement
from clerestory.radiance.primitives import checked, surface
from clerestory.radiance.repetition import (
    MOST_REPEATED,
    SLOW,
    Item,
    Materials,
    Part,
    Placed,
    Scope,
    copied,
    joined,
    materials_of,
    own_size,
)
from clerestory.radiance.search_path import found_in
from clerestory.radiance.statements import (
    SURFACE_KINDS,
    Command,
    Directive,
    PolygonRun,
    Statement,
    parse_statements,
)
from clerestory.scene.model import Scene, Source, TriangleMesh
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import Transform

_SHAPES = SURFACE_KINDS - INSTANCE_KINDS

# Maximum depth of nested files, which limits recursion
_DEEPEST = 100


def placed_items(path: str | Path) -> Iterator[Placed]:
    """Yield the items of a scene file and of included files, in Radiance's order.

    Copies of surfaces by arrays and repeated files are counted before they are made.
    """
    place = _Place(Path(path), Placement())
    walk = _Walk(place.path.parent)
    walk.require_few(place)
    yield from walk.items(place)


@dataclass(frozen=True)
class _Place:
    # Path and placement of a scene file, and paths of the files that include it
    path: Path
    placement: Placement
    within: tuple[Path, ...] = ()

    def put(self, item: Item) -> Placed:
        return Placed(item, str(self.path), self.placement)

    def inner(self, path: Path, placement: Placement) -> "_Place":
        return _Place(path, placement, (*self.within, self.path))


@dataclass(frozen=True, eq=False)
class _Content:
    # Content that a command or an instance inserts for each copy: items, then files
    items: tuple[Item | Command, ...]
    files: tuple[Path, ...]
    copies: tuple[Placements, ...]
    build: Build | None = None

    @property
    def count(self) -> int:
        return sum(map(len, self.copies))


@dataclass(frozen=True)
class _Walk:
    # Caches by path, and by command or instance of a file; each file is read once, even
    # if it is placed repeatedly
    top: Path
    loaded: dict[Path, tuple[Item | Command, ...]] = field(default_factory=dict)
    compiled: Loaded = field(default_factory=dict)
    contents: dict[tuple[Path, Item | Command], _Content] = field(default_factory=dict)
    materials: dict[Path, Materials | None] = field(default_factory=dict)
    surfaces: dict[Path, tuple[Part, ...]] = field(default_factory=dict)
    sizes: dict[Path, int] = field(default_factory=dict)
    joined: dict[_Content, Materials | None] = field(default_factory=dict)

    def items(self, place: _Place) -> Iterator[Placed]:
        yield from self._put(self._loaded(place.path), place)

    def _put(
        self, items: tuple[Item | Command, ...], place: _Place
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

    def _loaded(self, path: Path) -> tuple[Item | Command, ...]:
        if path not in self.loaded:
            statements = parse_statements(read_text(path), file=str(path))
            self.loaded[path] = _built(statements, str(path))
        return self.loaded[path]

    def _included(self, command: Command, place: _Place) -> Iterator[Placed]:
        content = self._content(command, place)
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
            yield from self._put(content.items, inner)
            if content.build is not None:
                with located(file=place.path, line=command.line):
                    scene = content.build(inner.placement.transform)
                yield inner.put(scene)
            for found in content.files:
                yield from self.items(place.inner(found, inner.placement))

    def _instanced(self, item: Primitive, place: _Place) -> Iterator[Placed]:
        # Items of the file to which an instance or mesh refers
        content = self._content(item, place)
        [[own]] = content.copies
        inner = replace(place, placement=own.then(place.placement))
        placed = chain(
            self._put(content.items, inner),
            *(self.items(place.inner(f, inner.placement)) for f in content.files),
        )
        if own.modifier is None:
            yield inner.put(Scope(opens=True))
            yield from placed
            yield inner.put(Scope(opens=False))
        else:
            # The modifier of an instance replaces the materials of all its surfaces
            yield from (p for p in placed if not isinstance(p.item, Primitive))

    def _content(self, item: Command | Primitive, place: _Place) -> _Content:
        key = place.path, item
        with located(file=place.path, line=item.line):
            if key not in self.contents:
                self.contents[key] = self._read(item, place)
            files = self.contents[key].files
            _refuse_recursion(files, (*place.within, place.path))
        return self.contents[key]

    def _read(self, item: Command | Primitive, place: _Place) -> _Content:
        file = str(place.path)

        def find(name: str) -> Path:
            return found_in(name, [self.top, place.path.parent, Path()])

        if isinstance(item, Primitive):
            mesh = read_instance(item, file=file, find=find, loaded=self.compiled)
            items = _built(mesh.items, item.strings[0])
            return _Content(items, mesh.files, (one_placement(mesh.placement),))
        told = parse_command(item.text, find=find)
        items = _built((replace(i, line=item.line) for i in told.items), file)
        files = tuple(find(name) for name in told.files)
        return _Content(items, files, told.placements, told.build)

    def require_few(self, place: _Place) -> None:
        """Raise an error if arrays, instances and files repeat too many surfaces."""
        inserting = [item for item in self._loaded(place.path) if _inserts(item)]
        sizes = {item: self._size_of(item, place) for item in inserting}
        once = sum(map(own_size, self.loaded.values()))
        for together, most in ((True, MOST_REPEATED), (False, MOST_REPEATED // SLOW)):
            found = [i for i in inserting if self._together(i, place) == together]
            total = sum(sizes[item] for item in found)
            if total > once + most:
                raise InputError(
                    f"arrays, instances and repeated files make {total:.2g} surfaces;"
                    f" at most {most:,} expected"
                    + ("" if together else " if materials depend on the placement"),
                    file=place.path,
                    line=getattr(max(found, key=sizes.__getitem__), "line", None),
                )

    def _together(self, item: Item | Command, place: _Place) -> bool:
        # Whether all copies by a command are transformed together
        if not isinstance(item, Command):
            return False
        return self._materials_of(self._content(item, place)) is not None

    def _size(self, place: _Place) -> int:
        # Number of surfaces of a file with the files that it includes
        if place.path not in self.sizes:
            self.sizes[place.path] = self._size_all(self._loaded(place.path), place)
        return self.sizes[place.path]

    def _size_all(self, items: tuple[Item | Command, ...], place: _Place) -> int:
        inserted = sum(self._size_of(i, place) for i in items if _inserts(i))
        return 1 + own_size(items) + inserted

    def _size_of(self, item: Item | Command, place: _Place) -> int:
        assert isinstance(item, Command | Primitive)
        content = self._content(item, place)
        below = (place.inner(file, Placement()) for file in content.files)
        once = self._size_all(content.items, place) + sum(map(self._size, below))
        if content.build is not None and (content.count > 1 or place.within):
            once += len(content.build(Transform()).surfaces)
        return content.count * once

    def _materials_of(self, content: _Content) -> Materials | None:
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
            place = _Place(path, Placement())

            def inner(command: Command) -> Materials | None:
                return self._materials_of(self._content(command, place))

            items = self._loaded(path)
            self.materials[path] = materials_of(items, str(path), inner)
        return self.materials[path]

    def _parts_of(self, content: _Content) -> tuple[Part, ...]:
        files = (self._parts(file) for file in content.files)
        return (*self._flat(content.items, None), *chain.from_iterable(files))

    def _parts(self, path: Path) -> tuple[Part, ...]:
        # Surfaces of a file and of the files that it includes
        if path not in self.surfaces:
            place = _Place(path, Placement())
            self.surfaces[path] = tuple(self._flat(self._loaded(path), place))
        return self.surfaces[path]

    def _flat(
        self, items: tuple[Item | Command, ...], place: _Place | None
    ) -> Iterator[Part]:
        for item in items:
            match item:
                case Command() if place is not None:
                    content = self._content(item, place)
                    for copies in content.copies:
                        yield from copied(self._parts_of(content), copies)
                case Command() | Primitive() | Directive() | Scope() | Scene():
                    pass  # definitions
                case _:
                    yield item


def _inserts(item: Item | Command) -> bool:
    if isinstance(item, Primitive):
        return item.kind in INSTANCE_KINDS
    return isinstance(item, Command)


def _refuse_recursion(files: Iterable[Path], within: tuple[Path, ...]) -> None:
    for found in files:
        if any(found.samefile(p) for p in within):
            cycle = " → ".join(p.name for p in (*within, found))
            raise InputError(f"the file includes itself: {cycle}")
        deep = f"files are nested more than {_DEEPEST} deep; fewer levels expected"
        require(len(within) <= _DEEPEST, deep)


def _built(
    statements: Iterable[Statement | TriangleMesh], file: str
) -> tuple[Item | Command, ...]:
    # Converts surface primitives to surfaces; other statements are unchanged
    items: list[Item | Command] = []
    for polygonal, group in groupby(statements, _is_polygon):
        if polygonal:
            polygons = [p for p in group if isinstance(p, Primitive)]
            items.append(checked(_run(polygons, file), file=file))
            continue
        for statement in group:
            match statement:
                case PolygonRun():
                    items.append(checked(statement, file=file))
                case Primitive(kind=kind) if kind in _SHAPES:
                    built = surface(statement, file=file)
                    items += [] if built is None else [built]
                case _:
                    items.append(statement)
    return tuple(items)


def _is_polygon(statement: Statement | TriangleMesh) -> bool:
    return isinstance(statement, Primitive) and statement.kind == "polygon"


def _run(polygons: list[Primitive], file: str) -> PolygonRun:
    # Converts polygon primitives, read word by word or made by a command
    modifier, name, source, count = [], [], [], []
    numbers: list[float] = []
    for item in polygons:
        given, words = len(item.reals), len(item.strings)
        require(
            words == 0 and given >= 9 and given % 3 == 0,
            f'polygon "{item.name}" has {given} numbers and {words} strings;'
            " three numbers for each of at least 3 vertices expected",
            file=file,
            line=item.line,
        )
        modifier.append(item.modifier)
        name.append(item.name)
        source.append(Source(file, item.line))
        count.append(given // 3)
        numbers += item.reals
    first = np.cumsum([0, *count])
    return PolygonRun(modifier, name, source, first, np.array(numbers).reshape(-1, 3))
