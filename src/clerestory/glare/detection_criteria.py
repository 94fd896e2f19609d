"""What counts as a glare source, and which pixels make one."""

import math
from dataclasses import dataclass
from typing import Literal

from clerestory.errors import InputError
from clerestory.glare.field_of_view import FieldOfView

Threshold = Literal["luminance", "times_mean", "times_task"]

# Smallest factor that evalglare takes for a luminance [cd/m²]
LARGEST_FACTOR = 100.0


@dataclass(frozen=True)
class Zone:
    """A circular part of the field of view.

    Attributes
    ----------
    row, column : pixel in its middle
    opening : angle across the circle [rad]
    """

    row: int
    column: int
    opening: float

    def __post_init__(self) -> None:
        if not 0 <= self.opening <= 2 * math.pi:
            raise InputError(f"opening angle {self.opening:g}; 0 to 2π rad expected")


@dataclass(frozen=True, kw_only=True)
class SourceRules:
    """How glare sources are found in a picture.

    Attributes
    ----------
    threshold : glare pixels are brighter than this; a luminance [cd/m²], or a multiple
    threshold_kind : "luminance", or a multiple of the average luminance of the picture
        ("times_mean") or of the task ("times_task")
    task : the task's place in the picture
    merge_angle : sources nearer than half this opening angle are one [rad]
    peak_luminance : brighter pixels become sources of their own [cd/m²]; None keeps
        them where they are
    smooth : count dark pixels to the source that surrounds them
    smallest : sources of less solid angle are left out [sr]
    field_of_view : leave out sources that Guth's field of view does not hold

    Raises
    ------
    InputError : a number out of range, a threshold by the task without a task

    Examples
    --------
    >>> SourceRules(threshold=5, threshold_kind="times_task", task=Zone(400, 400, 0.6))
    ... # doctest: +ELLIPSIS
    SourceRules(threshold=5, threshold_kind='times_task', ...)
    """

    threshold: float = 2000.0
    threshold_kind: Threshold = "luminance"
    task: Zone | None = None
    merge_angle: float = 0.2
    peak_luminance: float | None = 50_000.0
    smooth: bool = False
    smallest: float = 0.0
    field_of_view: FieldOfView | None = None

    def __post_init__(self) -> None:
        for name in ("threshold", "merge_angle"):
            if not 0 < getattr(self, name) < math.inf:
                raise InputError(
                    f"{name.replace('_', ' ')} {getattr(self, name)}; above 0 expected"
                )
        if self.peak_luminance is not None and not self.peak_luminance > 0:
            raise InputError(f"peak luminance {self.peak_luminance}; above 0 expected")
        if not 0 <= self.smallest < math.inf:
            raise InputError(f"smallest source {self.smallest} sr; 0 or more expected")
        if self.threshold_kind == "times_task" and self.task is None:
            raise InputError(
                "a threshold by the task's luminance needs the task's place"
            )
