"""Expansion of scene files and of the files included by them."""

from collections.abc import Iterable, Iterator
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
from clerestory.radiance.polygon_checks import checked
from clerestory.radiance.primitives import surface
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
    """Begin or end of a scope of material names.

    Materials defined inside an instance are not visible outside it.
    """

    opens: bool


Item = PolygonRun | Primitive | Directive | Simple | Scope | Scene

_SHAPES = SURFACE_KINDS - INSTANCE_KINDS

# Maximum depth of nested files, which limits recursion
_DEEPEST = 100


@dataclass(frozen=True, eq=False)
class Placed:
    """A scene item with its accumulated placement.

    Attributes
    ----------
    item : polygons, another surface, a material or an alias (Primitive), a directive,
        begin or end of a scope, or a scene in its final position
    file : path of the file that contains the item
    placement : placement accumulated over nested xforms, already applied to surfaces
    """

    item: Item
    file: str
    placement: Placement


def placed_items(path: str | Path) -> Iterator[Placed]:
    """Yield the items of a file and of included files, in Radiance's order."""
    walk = _Walk(Path(path).parent, {}, {})
    yield from walk.items(Path(path), Placement(), ())


@dataclass(frozen=True)
class _Walk:
    # Files by path; each file is read once, even if it is placed several times
    top: Path
    loaded: dict[Path, tuple[Item | Command, ...]]
    compiled: Loaded

    def items(
        self, path: Path, placement: Placement, within: tuple[Path, ...]
    ) -> Iterator[Placed]:
        if path not in self.loaded:
            self.loaded[path] = _parsed(read_text(path), str(path))
        yield from self._put(self.loaded[path], path, placement, within)

    def _put(
        self,
        items: tuple[Item | Command, ...],
        path: Path,
        placement: Placement,
        within: tuple[Path, ...],
    ) -> Iterator[Placed]:
        file = str(path)
        for item in items:
            match item:
                case Command():
                    yield from self._included(item, path, placement, within)
                case Primitive() if item.kind in INSTANCE_KINDS:
                    yield from self._instanced(item, path, placement, within)
                case PolygonRun():
                    yield Placed(placement.polygons(item), file, placement)
                case Primitive() | Directive() | Scope() | Scene():
                    yield Placed(item, file, placement)
                case _:
                    yield Placed(placement.surface(item), file, placement)

    def _included(
        self,
        command: Command,
        path: Path,
        placement: Placement,
        within: tuple[Path, ...],
    ) -> Iterator[Placed]:
        with located(file=path, line=command.line):
            inclusion = parse_command(
                command.text, find=lambda name: self._find(name, path)
            )
            copies = [p.then(placement) for p in inclusion.placements]
            files = [self._find(name, path) for name in inclusion.files]
            _refuse_recursion(files, (*within, path))
        items = (replace(item, line=command.line) for item in inclusion.items)
        made = tuple(_built(items, str(path)))
        for inner in copies:
            yield from self._put(made, path, inner, within)
            if inclusion.build is not None:
                with located(file=path, line=command.line):
                    scene = inclusion.build(inner.transform)
                yield Placed(scene, str(path), inner)
            for found in files:
                yield from self.items(found, inner, (*within, path))

    def _instanced(
        self,
        item: Primitive,
        path: Path,
        placement: Placement,
        within: tuple[Path, ...],
    ) -> Iterator[Placed]:
        # Placed content of the file that an instance or mesh refers to
        with located(file=path, line=item.line):
            instance = read_instance(
                item,
                file=str(path),
                find=lambda name: self._find(name, path),
                loaded=self.compiled,
            )
            inner = instance.placement.then(placement)
            _refuse_recursion(instance.files, (*within, path))
        made = tuple(_built(instance.items, item.strings[0]))
        content = chain(
            self._put(made, path, inner, within),
            *(self.items(found, inner, (*within, path)) for found in instance.files),
        )
        if instance.placement.modifier is None:
            yield Placed(Scope(opens=True), str(path), inner)
            yield from content
            yield Placed(Scope(opens=False), str(path), inner)
        else:
            # A modifier of the instance replaces the materials of all surfaces in it
            yield from (p for p in content if not isinstance(p.item, Primitive))

    def _find(self, name: str, path: Path) -> Path:
        return found_in(name, [self.top, path.parent, Path()])


def _refuse_recursion(files: Iterable[Path], within: tuple[Path, ...]) -> None:
    for found in files:
        if any(found.samefile(p) for p in within):
            chain = " → ".join(p.name for p in (*within, found))
            raise InputError(f"the file includes itself: {chain}")
        if len(within) > _DEEPEST:
            raise InputError(f"files are nested more than {_DEEPEST} deep")


def _parsed(text: str, file: str) -> tuple[Item | Command, ...]:
    return tuple(_built(parse_statements(text, file=file), file))


def _built(
    statements: Iterable[Statement | TriangleMesh], file: str
) -> list[Item | Command]:
    # Statements, with surface primitives converted to surfaces
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
    return items


def _is_polygon(statement: Statement | TriangleMesh) -> bool:
    return isinstance(statement, Primitive) and statement.kind == "polygon"


def _run(polygons: list[Primitive], file: str) -> PolygonRun:
    # Consecutive polygons that were read word by word or made by a command
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
