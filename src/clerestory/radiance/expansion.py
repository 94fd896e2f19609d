"""Expansion of scene files: insertion of files, instances and generated surfaces."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, groupby
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.radiance.command import parse_command
from clerestory.radiance.instance import INSTANCE_KINDS, Loaded, read_instance
from clerestory.radiance.placement import Placement
from clerestory.radiance.primitives import checked, surface
from clerestory.radiance.search_path import found_in
from clerestory.radiance.statements import (
    SURFACE_KINDS,
    Command,
    Directive,
    PolygonRun,
    Statement,
    parse_statements,
)
from clerestory.scene.model import Scene, Simple, TriangleMesh
from clerestory.scene.primitive import Primitive


@dataclass(frozen=True)
class Scope:
    """Beginning or end of a scope of material names.

    Materials defined inside an instance are not visible outside it.
    """

    opens: bool


Item = PolygonRun | Primitive | Directive | Simple | Scope | Scene

_SHAPES = SURFACE_KINDS - INSTANCE_KINDS

# Maximum depth of nested files, which limits recursion
_DEEPEST = 100


@dataclass(frozen=True, eq=False)
class Placed:
    """An item of a scene file in its final position, with the name of the file.

    Items are polygons, other surfaces, materials and aliases (Primitive), directives,
    scope limits and scenes. `placement` combines all nested xforms, which are already
    applied to surfaces.
    """

    item: Item
    file: str
    placement: Placement


def placed_items(path: str | Path) -> Iterator[Placed]:
    """Yield the items of a scene file and of included files, in Radiance's order."""
    walk = _Walk(Path(path).parent, {}, {})
    yield from walk.items(_Place(Path(path), Placement()))


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


@dataclass(frozen=True)
class _Walk:
    # Cache of files by path; each file is read once, even if it is placed repeatedly
    top: Path
    loaded: dict[Path, tuple[Item | Command, ...]]
    compiled: Loaded

    def items(self, place: _Place) -> Iterator[Placed]:
        path = place.path
        if path not in self.loaded:
            statements = parse_statements(read_text(path), file=str(path))
            self.loaded[path] = _built(statements, str(path))
        yield from self._put(self.loaded[path], place)

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

    def _included(self, command: Command, place: _Place) -> Iterator[Placed]:
        with located(file=place.path, line=command.line):
            inclusion = parse_command(command.text, find=self._finder(place))
            files = [self._finder(place)(name) for name in inclusion.files]
            _refuse_recursion(files, (*place.within, place.path))
        items = (replace(item, line=command.line) for item in inclusion.items)
        made = _built(items, str(place.path))
        for placement in inclusion.placements:
            inner = replace(place, placement=placement.then(place.placement))
            yield from self._put(made, inner)
            if inclusion.build is not None:
                with located(file=place.path, line=command.line):
                    scene = inclusion.build(inner.placement.transform)
                yield inner.put(scene)
            for found in files:
                yield from self.items(place.inner(found, inner.placement))

    def _instanced(self, item: Primitive, place: _Place) -> Iterator[Placed]:
        # Items of the file to which an instance or mesh refers
        file = str(place.path)
        with located(file=file, line=item.line):
            instance = read_instance(
                item, file=file, find=self._finder(place), loaded=self.compiled
            )
            placement = instance.placement.then(place.placement)
            _refuse_recursion(instance.files, (*place.within, place.path))
        inner = replace(place, placement=placement)
        content = chain(
            self._put(_built(instance.items, item.strings[0]), inner),
            *(self.items(place.inner(found, placement)) for found in instance.files),
        )
        if instance.placement.modifier is None:
            yield inner.put(Scope(opens=True))
            yield from content
            yield inner.put(Scope(opens=False))
        else:
            # The modifier of an instance replaces the materials of all its surfaces
            yield from (p for p in content if not isinstance(p.item, Primitive))

    def _finder(self, place: _Place) -> Callable[[str], Path]:
        return lambda name: found_in(name, [self.top, place.path.parent, Path()])


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
    modifier, name, line, count = [], [], [], []
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
        line.append(item.line)
        count.append(given // 3)
        numbers += item.reals
    first = np.cumsum([0, *count])
    return PolygonRun(modifier, name, line, first, np.array(numbers).reshape(-1, 3))
