"""The items of a .rad file and of all it includes, each in its place in the scene."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.radiance.command import Inclusion, parse_command
from clerestory.radiance.instance import INSTANCE_KINDS, Loaded, read_instance
from clerestory.radiance.placement import Placement
from clerestory.radiance.polygon_checks import checked
from clerestory.radiance.primitives import surface
from clerestory.radiance.statements import (
    SURFACE_KINDS,
    Alias,
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
    """Where names begin to stand for themselves alone, and where that ends.

    Materials defined inside an instance are not known outside it.
    """

    opens: bool


Item = PolygonRun | Primitive | Alias | Directive | Simple | Scope | Scene

# Files nested deeper than this are a mistake, and would exhaust the stack
_DEEPEST = 100


@dataclass(frozen=True, eq=False)
class Placed:
    """An item after all transforms it passed.

    Attributes
    ----------
    item : polygons, another surface, a material (Primitive), an alias, a directive,
        the bounds of a scope, or a scene whose surfaces are in place already
    file : where it stands
    placement : what it passed; already applied to surfaces
    """

    item: Item
    file: str
    placement: Placement


def placed_items(path: str | Path) -> Iterator[Placed]:
    """Yield everything in a file and in the files it includes, in Radiance's order."""
    walk = _Walk(Path(path).parent, {}, {})
    yield from walk.items(Path(path), Placement(), ())


@dataclass(frozen=True)
class _Walk:
    # Each file is read once, however often it is placed
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
                case Primitive() | Alias() | Directive() | Scope() | Scene():
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
        inclusion, placements = self._inclusion(command, path, placement)
        if inclusion.text:
            # A generator's text has one line, that of its command
            text = "\n" * (command.line - 1) + inclusion.text
            made = _parsed(text, str(path))
            for inner in placements:
                yield from self._put(made, path, inner, within)
            return
        if inclusion.build is not None:
            for inner in placements:
                with located(file=path, line=command.line):
                    scene = inclusion.build(inner.transform)
                yield Placed(scene, str(path), inner)
            return
        found = self._found(inclusion, command, path, within)
        for inner in placements:
            for included in found:
                yield from self.items(included, inner, (*within, path))

    def _instanced(
        self,
        item: Primitive,
        path: Path,
        placement: Placement,
        within: tuple[Path, ...],
    ) -> Iterator[Placed]:
        # What an instance or mesh names, where it puts it
        with located(file=path, line=item.line):
            instance = read_instance(
                item,
                file=str(path),
                find=lambda name: self._find(name, path),
                loaded=self.compiled,
            )
            inner = instance.placement.then(placement)
            for found in instance.files:
                _refuse_recursion(found, (*within, path))
        if instance.placement.modifier is None:
            yield Placed(Scope(opens=True), str(path), inner)
        made = tuple(_built(instance.items, item.strings[0]))
        for placed in chain(
            self._put(made, path, inner, within),
            *(self.items(found, inner, (*within, path)) for found in instance.files),
        ):
            # A modifier of its own outweighs all materials inside
            defines = isinstance(placed.item, Primitive | Alias)
            if instance.placement.modifier is None or not defines:
                yield placed
        if instance.placement.modifier is None:
            yield Placed(Scope(opens=False), str(path), inner)

    def _inclusion(
        self, command: Command, path: Path, placement: Placement
    ) -> tuple[Inclusion, list[Placement]]:
        # What a command stands for, and where its copies come to lie
        with located(file=path, line=command.line):
            inclusion = parse_command(
                command.text, find=lambda name: self._find(name, path)
            )
            return inclusion, [p.then(placement) for p in inclusion.placements]

    def _found(
        self,
        inclusion: Inclusion,
        command: Command,
        path: Path,
        within: tuple[Path, ...],
    ) -> list[Path]:
        with located(file=path, line=command.line):
            files = [self._find(name, path) for name in inclusion.files]
            for found in files:
                _refuse_recursion(found, (*within, path))
        return files

    def _find(self, name: str, path: Path) -> Path:
        folders = dict.fromkeys([self.top, path.parent, Path()])
        for folder in folders:
            if (folder / name).is_file():
                return folder / name
        tried = ", ".join(str(f) for f in folders)
        raise InputError(f'the file "{name}" is missing; looked for in {tried}')


def _refuse_recursion(found: Path, within: tuple[Path, ...]) -> None:
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
    # Statements with their surfaces as values
    items: list[Item | Command] = []
    for statement in statements:
        match statement:
            case PolygonRun():
                items.append(checked(statement, file=file))
            case Primitive(kind="polygon") if _is_outline(statement):
                items.append(checked(_run(statement), file=file))
            case Primitive(kind="polygon"):
                raise InputError(
                    f'polygon "{statement.name}" has {len(statement.reals)} numbers'
                    f" and {len(statement.strings)} strings;"
                    " three numbers for each of at least 3 vertices expected",
                    file=file,
                    line=statement.line,
                )
            case Primitive() if statement.kind in INSTANCE_KINDS:
                items.append(statement)
            case Primitive() if statement.kind in SURFACE_KINDS:
                built = surface(statement, file=file)
                items += [] if built is None else [built]
            case _:
                items.append(statement)
    return items


def _is_outline(item: Primitive) -> bool:
    count = len(item.reals)
    return not item.strings and count >= 9 and count % 3 == 0


def _run(item: Primitive) -> PolygonRun:
    # A single polygon, read word by word
    vertices = np.array(item.reals).reshape(-1, 3)
    first = np.array([0, len(vertices)])
    return PolygonRun([item.modifier], [item.name], [item.line], first, vertices)
