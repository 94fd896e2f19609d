"""Illuminance sensors and their .pts files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import finite, require, same_length
from clerestory.directions import unit
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.scene.transform import LARGEST, number


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
    rows = []
    for i, text in enumerate(content.split("\n"), start=1):
        words = text.partition("#")[0].replace(",", " ").split()
        if words:
            with located(file=path, line=i):
                rows.append(_row(words))
    require(rows, "no sensors; lines of x y z dx dy dz expected", file=path)
    table = np.array(rows)
    return Sensors(table[:, :3], table[:, 3:])


def _row(words: list[str]) -> list[float]:
    values = []
    for word in words:
        value = number(word)
        if value is None:
            raise InputError(f'"{word}" is found where a finite number is expected')
        if abs(value) > LARGEST:
            raise InputError(f"a number exceeds {LARGEST:.0e}; a smaller one expected")
        values.append(value)
    require(len(values) == 6, f"{len(values)} numbers; six (x y z dx dy dz) expected")
    unit(np.array(values[3:]))
    return values
