"""Axes of transfer matrices: the meaning of their rows and columns.

Rows are receivers, columns are senders. Two matrices can be multiplied if the columns
of the left matrix and the rows of the right matrix have the same meaning.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from clerestory.argument_types import checked_fields
from clerestory.brief_repr import brief
from clerestory.checks import one_of
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import SkyPartition

Kind = Literal[
    "sensor", "interior", "exterior", "sky", "sun", "time", "pixel", "unknown"
]

_MEANING = {
    "sensor": "sensors",
    "interior": "window patches on the room side",
    "exterior": "window patches on the outer side",
    "sky": "sky patches",
    "sun": "suns",
    "pixel": "pixels",
    "time": "time steps",
    "unknown": "unlabelled entries",
}


@checked_fields
@dataclass(frozen=True, eq=False)
class Axis:
    """The rows or the columns of a matrix.

    Attributes
    ----------
    kind : kind of receiver or sender; "unknown" for files without labels
    size : number of rows or columns
    partition : partition of the window hemisphere or sky into patches
    window : name of the window group; None is compatible with every window
    times : time steps (local standard time)
    names : names of the sensors
    """

    kind: Kind
    size: int
    partition: RingPartition | SkyPartition | None = None
    window: str | None = None
    times: np.ndarray | None = None
    names: tuple[str, ...] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        one_of(self.kind, "kind of an axis", choices=_MEANING)

    def describe(self) -> str:
        """Return a description such as "145 window patches on the room side"."""
        text = f"{self.size} {_MEANING[self.kind]}"
        if self.partition is not None:
            text += f" ({self.partition.name})"
        return text + (f" of window {self.window!r}" if self.window else "")

    def fits(self, other: "Axis") -> bool:
        """Whether the columns `self` and the rows `other` have the same meaning."""
        if self.size != other.size or "unknown" in (self.kind, other.kind):
            return self.size == other.size
        windows = {self.window, other.window} - {None, ""}
        if self.kind != other.kind or len(windows) > 1:
            return False
        mine, yours = self.partition, other.partition
        if isinstance(mine, RingPartition) and isinstance(yours, RingPartition):
            return mine.matches(yours)
        if isinstance(mine, SkyPartition) and isinstance(yours, SkyPartition):
            return mine.subdivision == yours.subdivision
        return True

    def at_window(self, window: str | None) -> "Axis":
        """Return the axis, with the given window name if the axis has no name."""
        if self.window is None and window and self.kind in ("interior", "exterior"):
            return replace(self, window=window)
        return self


def sensor_axis(count: int, names: tuple[str, ...] | None = None) -> Axis:
    """Return the axis of `count` sensors."""
    return Axis("sensor", count, names=names)


def window_axis(
    side: Literal["interior", "exterior"],
    partition: RingPartition,
    window: str | None = None,
) -> Axis:
    """Return the axis of the patches on one side of a window."""
    return Axis(side, len(partition), partition=partition, window=window)


def sky_axis(partition: SkyPartition) -> Axis:
    """Return the axis of the patches of a sky."""
    return Axis("sky", len(partition), partition=partition)


def sun_axis(count: int) -> Axis:
    """Return the axis of `count` suns."""
    return Axis("sun", count)


def pixel_axis(count: int) -> Axis:
    """Return the axis of a picture's pixels, row by row from the top."""
    return Axis("pixel", count)


def time_axis(times: np.ndarray) -> Axis:
    """Return the axis of time steps."""
    return Axis("time", len(times), times=times)


def unknown_axis(size: int) -> Axis:
    """Return an axis without labels."""
    return Axis("unknown", size)
