"""Reader of windows in Radiance scene files with comments for rfluxmtx.

A comment `#@rfluxmtx h=kf u=Z` gives angular basis and up vector of the polygons after
it. The default basis is Klems full; up is +z, or +y for a horizontal window.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.hemisphere.klems import klems
from clerestory.radiance.expansion import placed_items
from clerestory.radiance.repetition import Placed
from clerestory.radiance.statements import Directive, PolygonRun
from clerestory.scene.material import error_at
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.transform import number
from clerestory.scene.window import Window, window_of

_BASES = {"k": "full", "kf": "full", "k1": "full", "kh": "half", "k2": "half"}
_BASES |= {"kq": "quarter", "k4": "quarter"}


def read_window(path: str | Path) -> Window:
    r"""Read a window from a .rad file; all polygons of the file belong to it.

    Materials are ignored. The window has the name of the modifier of its polygons or,
    if they have different modifiers, the name of the file.

    Examples
    --------
    >>> import tempfile
    >>> text = "#@rfluxmtx h=kf u=Z\n void polygon pane 0 0 9 0 0 0 0 0 1 1 0 0"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "south.rad")
    ...     _ = file.write_text(text)
    ...     window = read_window(file)
    >>> window.name, window.area, window.frame.normal.tolist()
    ('south', 0.5, [0.0, 1.0, 0.0])
    """
    groups = read_panes(path)
    names = list(groups)
    name = names[0] if len(names) == 1 and names[0] != "void" else Path(path).stem
    return window_of_panes(name, [pane for group in groups.values() for pane in group])


def read_windows(*paths: str | Path) -> tuple[Window, ...]:
    """Read windows from .rad files, one for each modifier, in order of appearance."""
    groups: dict[str, list[Pane]] = {}
    for path in paths:
        for name, panes in read_panes(path).items():
            groups.setdefault(name, []).extend(panes)
    return tuple(window_of_panes(name, panes) for name, panes in groups.items())


@dataclass(frozen=True, eq=False)
class Pane:
    """A polygon of a window, with its angular basis and up vector."""

    polygon: Polygon
    basis: str
    up: Vector | None


def read_panes(path: str | Path) -> dict[str, list[Pane]]:
    """Read the polygons of windows in a .rad file, by modifier."""
    groups: dict[str, list[Pane]] = {}
    basis, up = "full", None
    for placed in placed_items(path):
        match placed.item:
            case Directive():
                with located(file=placed.file, line=placed.item.line):
                    basis, up = _variables(placed.item, basis, up)
            case PolygonRun():
                for polygon in placed.item.polygons():
                    groups.setdefault(polygon.material, []).append(
                        Pane(polygon, basis, up)
                    )
            case _:
                _refuse_surface(placed)
    require(groups, "no polygons; the polygons of a window expected", file=path)
    return groups


def _refuse_surface(placed: Placed) -> None:
    require(
        not isinstance(placed.item, Scene),
        "the window file has a command that creates a scene; polygons expected",
        file=placed.file,
    )
    source = getattr(placed.item, "source", None)
    if source is not None:
        kind = type(placed.item).__name__.lower()
        raise error_at(
            source, f"the window file has surfaces of type {kind}; polygons expected"
        )


def window_of_panes(
    name: str, panes: Sequence[Pane], *, faceted: bool = False
) -> Window:
    """Return the window of some panes; the first one gives basis and up vector."""
    polygons, first = tuple(pane.polygon for pane in panes), panes[0]
    partition = klems(first.basis)
    return window_of(
        polygons, name=name, up=first.up, partition=partition, faceted=faceted
    )


def _variables(
    directive: Directive, basis: str, up: Vector | None
) -> tuple[str, Vector | None]:
    # Angular basis and up vector, changed by a `#@rfluxmtx` comment
    for word in directive.text.split():
        key, _, value = word.partition("=")
        match key:
            case "h":
                basis = basis_of(value)
            case "u":
                up = up_of(value)
            case "o":
                pass  # output file, used by rfluxmtx only
            case _:
                raise InputError(
                    f'unknown variable "{word}" of #@rfluxmtx; h=kf|kh|kq or'
                    " u=X|Y|Z|x,y,z expected"
                )
    return basis, up


def basis_of(value: str) -> str:
    """Return the angular basis of a window from the value of h."""
    require(
        not value.startswith("-"),
        f"h={value} has left-handed coordinates, which are not supported;"
        f" h={value[1:]} expected",
    )
    name = value.removeprefix("+").lower()
    wrong = f"h={value} is not a basis of windows; kf, kh or kq expected"
    require(name in _BASES, wrong)
    return _BASES[name]


def up_of(value: str) -> Vector:
    """Return the up vector from the value of u."""
    if value.lstrip("+-").lower() in ("x", "y", "z"):
        axis = np.eye(3)["xyz".index(value[-1].lower())]
        return np.asarray(-axis if value.startswith("-") else axis)
    parts = [number(part) for part in value.split(",")]
    vector = np.array([p for p in parts if p is not None])
    require(
        len(parts) == len(vector) == 3 and vector.any(),
        f"u={value} is not a direction; X, -X, Y, -Y, Z, -Z or x,y,z expected",
    )
    return vector
