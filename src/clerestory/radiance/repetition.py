"""Copies of surfaces by arrays and by files that are placed repeatedly.

The surfaces of a file that is placed repeatedly are transformed together. This requires
that its materials do not depend on the placement, and that no name has two definitions.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from clerestory.radiance.placement import Placement, Placements
from clerestory.radiance.statements import Command, Directive, PolygonRun
from clerestory.scene.model import Scene, Simple
from clerestory.scene.primitive import Primitive

# Types of materials that do not depend on the placement
_FIXED = {"plastic", "metal", "trans", "glass", "mirror", "light", "illum", "alias"}


@dataclass(frozen=True)
class Scope:
    """Beginning or end of a scope of material names.

    Materials defined inside an instance are not visible outside it.
    """

    opens: bool


Part = PolygonRun | Simple
Item = Part | Primitive | Directive | Scope | Scene


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


@dataclass(frozen=True)
class Materials:
    """Definitions of materials, with their files, and names of all materials used."""

    definitions: tuple[tuple[Primitive, str], ...] = ()
    used: frozenset[str] = frozenset()


def joined(found: Iterable[Materials | None]) -> Materials | None:
    """Combine the materials of contents that are placed one after another, repeatedly.

    None if one of them is None, or if a name is used before its definition or has two.
    """
    known: dict[str, tuple[Primitive, str]] = {}
    used: set[str] = set()
    for each in found:
        if each is None:
            return None
        for item, file in each.definitions:
            if item.name not in known and item.name not in used:
                known[item.name] = item, file
            elif item.name not in known or known[item.name][0] is not item:
                return None
        used |= each.used
    return Materials(tuple(known.values()), frozenset(used))


def materials_of(
    items: Iterable[Item | Command],
    file: str,
    inner: Callable[[Command], Materials | None],
) -> Materials | None:
    """Return the materials of the items of a file; `inner` gives those of a command."""
    return joined(_materials(item, file, inner) for item in items)


def _materials(
    item: Item | Command, file: str, inner: Callable[[Command], Materials | None]
) -> Materials | None:
    match item:
        case Command():
            return inner(item)
        case PolygonRun():
            return Materials((), frozenset(item.modifier))
        case Primitive(kind=kind) if kind in _FIXED:
            used = frozenset((item.modifier, *item.strings))
            return Materials(((item, file),), used)
        case Primitive() | Directive() | Scope() | Scene():
            return None
    return Materials((), frozenset((item.material,)))


def copied(parts: tuple[Part, ...], placements: Placements) -> Iterator[Part]:
    """Yield the surfaces of all copies, one copy after the other."""
    runs = [part for part in parts if isinstance(part, PolygonRun)]
    if runs and len(runs) == len(parts):
        yield placements.polygons(_merged(runs))
        return
    for placement in placements:
        for part in parts:
            match part:
                case PolygonRun():
                    yield placement.polygons(part)
                case _:
                    yield placement.surface(part)


def _merged(runs: list[PolygonRun]) -> PolygonRun:
    if len(runs) == 1:
        return runs[0]
    starts = np.cumsum([0, *(len(run.vertices) for run in runs)])
    ends = (run.first[1:] + at for run, at in zip(runs, starts, strict=False))
    return PolygonRun(
        [name for run in runs for name in run.modifier],
        [name for run in runs for name in run.name],
        [source for run in runs for source in run.source],
        np.concatenate([[0], *ends]),
        np.concatenate([run.vertices for run in runs]),
    )
