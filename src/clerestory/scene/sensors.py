"""Illuminance sensors and their .pts files."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.brief_repr import brief
from clerestory.checks import finite, require, same_length
from clerestory.directions import unit
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.scene.transform import LARGEST, number


@checked_fields
@dataclass(frozen=True, eq=False)
class Sensors:
    """Illuminance sensors: points and directions (normals of illuminance meters).

    Attributes
    ----------
    position : sensor positions [m]
    direction : sensor directions; normalized to unit length
    names : one name per sensor; None for sensors without names

    Raises
    ------
    InputError : shapes do not match, a number is not finite, or a direction is zero

    Examples
    --------
    >>> desk = Sensors(np.array([[1.0, 2.0, 0.8]]), np.array([[0.0, 0.0, 2.0]]))
    >>> len(desk), desk.direction.tolist()
    (1, [[0.0, 0.0, 1.0]])
    """

    position: Float[np.ndarray, "sensors 3"]
    direction: Float[np.ndarray, "sensors 3"]
    names: tuple[str, ...] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        position = np.asarray(self.position, dtype=float)
        direction = np.asarray(self.direction, dtype=float)
        shapes = {position.shape, direction.shape}
        require(
            shapes == {(len(position), 3)},
            f"sensor positions have shape {position.shape} and directions"
            f" {direction.shape}; (n, 3) expected for both",
        )
        if self.names is not None:
            same_length(self.names, position, "names", "sensors")
        finite(position, "the coordinate of a sensor", unit="m")
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "direction", unit(direction))

    def __len__(self) -> int:
        return len(self.position)


def read_sensors(path: str | Path) -> Sensors:
    """Read sensors from a file with x y z dx dy dz on each line, as for rtrace.

    Blank lines and lines that begin with # are ignored.
    """
    return parse_sensors(read_text(path), path)


def parse_sensors(content: str, path: str | Path) -> Sensors:
    """Return sensors from the text of a sensor file; `path` is for messages."""
    rows = _rows(content, path, _sensor)
    require(rows, "no sensors; lines of x y z dx dy dz expected", file=path)
    table = np.array(rows)
    return Sensors(table[:, :3], table[:, 3:])


def read_positions(path: str | Path) -> Float[np.ndarray, "position 3"]:
    """Read positions [m] from a file with x y z on each line, as `read_sensors`.

    Lines may have directions, as those of sensors; these are ignored.
    """
    rows = _rows(read_text(path), path, _position)
    require(rows, "no positions; lines of x y z expected", file=path)
    return np.array(rows)


def _rows(
    content: str, path: str | Path, row: Callable[[list[str]], list[float]]
) -> list[list[float]]:
    rows = []
    for i, text in enumerate(content.split("\n"), start=1):
        words = text.partition("#")[0].replace(",", " ").split()
        if words:
            with located(file=path, line=i):
                rows.append(row(words))
    return rows


def _sensor(words: list[str]) -> list[float]:
    values = _numbers(words)
    require(len(values) == 6, f"{len(values)} numbers; six (x y z dx dy dz) expected")
    unit(np.array(values[3:]))
    return values


def _position(words: list[str]) -> list[float]:
    values = _numbers(words)
    require(len(values) in (3, 6), f"{len(values)} numbers; three (x y z) expected")
    return values[:3]


def _numbers(words: list[str]) -> list[float]:
    values = []
    for word in words:
        value = number(word)
        if value is None:
            raise InputError(f'"{word}" is found where a finite number is expected')
        if abs(value) > LARGEST:
            raise InputError(f"a number exceeds {LARGEST:.0e}; a smaller one expected")
        values.append(value)
    return values
