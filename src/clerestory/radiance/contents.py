"""Contents of scene files, and of the commands and instances that insert files."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import groupby
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
from clerestory.radiance.repetition import Item, Placed
from clerestory.radiance.search_path import found_in
from clerestory.radiance.statements import (
    SURFACE_KINDS,
    Command,
    PolygonRun,
    Statement,
    parse_statements,
)
from clerestory.scene.model import Source, TriangleMesh
from clerestory.scene.primitive import Primitive

_SHAPES = SURFACE_KINDS - INSTANCE_KINDS

# Maximum number of copies by all commands, each counted once
_MOST_COPIES = 1_000_000

# Maximum depth of nested files, which limits recursion
_DEEPEST = 100


@dataclass(frozen=True)
class Place:
    """Path and placement of a scene file, and paths of the files that include it."""

    path: Path
    placement: Placement
    within: tuple[Path, ...] = ()

    def put(self, item: Item) -> Placed:
        """Return an item of the file in its position."""
        return Placed(item, str(self.path), self.placement)

    def inner(self, path: Path, placement: Placement) -> "Place":
        """Return the place of a file that the file includes."""
        return Place(path, placement, (*self.within, self.path))


@dataclass(frozen=True, eq=False)
class Content:
    """Content that a command or instance inserts for each copy: items, then files."""

    items: tuple[Item | Command, ...]
    files: tuple[Path, ...]
    copies: tuple[Placements, ...]
    build: Build | None = None

    @property
    def count(self) -> int:
        """Number of copies."""
        return sum(map(len, self.copies))


@dataclass(frozen=True)
class Contents:
    """Contents by path, and by command or instance of a file.

    Each file is read once, even if it is placed repeatedly.
    """

    top: Path
    loaded: dict[Path, tuple[Item | Command, ...]] = field(default_factory=dict)
    _compiled: Loaded = field(default_factory=dict)
    _inserted: dict[tuple[Path, Item | Command], Content] = field(default_factory=dict)
    _copies: Counter[str] = field(default_factory=Counter)

    def items(self, path: Path) -> tuple[Item | Command, ...]:
        """Return the items of a file."""
        if path not in self.loaded:
            statements = parse_statements(read_text(path), file=str(path))
            self.loaded[path] = built(statements, str(path))
        return self.loaded[path]

    def inserted(self, item: Command | Primitive, place: Place) -> Content:
        """Return the content that a command or an instance in a file inserts."""
        key = place.path, item
        with located(file=place.path, line=item.line):
            if key not in self._inserted:
                self._inserted[key] = self._read(item, place)
                self._copies["all"] += self._inserted[key].count - 1
                few = f"arrays make more than {_MOST_COPIES:,} copies; fewer expected"
                require(self._copies["all"] <= _MOST_COPIES, few)
            _refuse_recursion(self._inserted[key].files, (*place.within, place.path))
        return self._inserted[key]

    def _read(self, item: Command | Primitive, place: Place) -> Content:
        file = str(place.path)

        def find(name: str) -> Path:
            return found_in(name, [self.top, place.path.parent, Path()])

        if isinstance(item, Primitive):
            mesh = read_instance(item, file=file, find=find, loaded=self._compiled)
            items = built(mesh.items, item.strings[0])
            return Content(items, mesh.files, (one_placement(mesh.placement),))
        inclusion = parse_command(item.text, find=find)
        items = built((replace(i, line=item.line) for i in inclusion.items), file)
        files = tuple(find(name) for name in inclusion.files)
        return Content(items, files, inclusion.placements, inclusion.build)


def _refuse_recursion(files: Iterable[Path], within: tuple[Path, ...]) -> None:
    for found in files:
        if any(found.samefile(p) for p in within):
            cycle = " → ".join(p.name for p in (*within, found))
            raise InputError(f"the file includes itself: {cycle}")
        deep = f"files are nested more than {_DEEPEST} deep; fewer levels expected"
        require(len(within) <= _DEEPEST, deep)


def built(
    statements: Iterable[Statement | TriangleMesh], file: str
) -> tuple[Item | Command, ...]:
    """Convert surface primitives to surfaces; other statements are unchanged."""
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
