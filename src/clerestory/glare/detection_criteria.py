"""Criteria of glare source detection, as in evalglare."""

import math
from dataclasses import dataclass
from typing import Literal

from clerestory.errors import InputError
from clerestory.glare.field_of_view import FieldOfView

Threshold = Literal["luminance", "times_mean", "times_task"]

# Thresholds up to this value are multiples of a mean luminance (evalglare -b)
LARGEST_FACTOR = 100.0


@dataclass(frozen=True)
class Zone:
    """A circular zone of the field of view.

    Attributes
    ----------
    row, column : row, from the top, and column of the central pixel
    opening : full opening angle [rad]
    """

    row: int
    column: int
    opening: float

    def __post_init__(self) -> None:
        if not 0 <= self.opening <= 2 * math.pi:
            raise InputError(f"opening angle {self.opening:g}; 0 to 2π rad expected")


@dataclass(frozen=True, kw_only=True)
class SourceRules:
    """Criteria of glare source detection.

    Attributes
    ----------
    threshold : luminance above which pixels are glare pixels [cd/m²], or its ratio to a
        mean luminance
    threshold_kind : "luminance", or ratio to the mean luminance of the picture
        ("times_mean") or of the task ("times_task")
    task : task zone
    merge_angle : opening angle; sources closer than half this angle are merged [rad]
    peak_luminance : luminance from which pixels are extracted as separate sources
        [cd/m²]; None for no peak extraction
    smooth : whether dark pixels surrounded by a source are added to the source
    smallest : solid angle below which sources are ignored [sr]
    field_of_view : Guth's field of view, outside of which pixels are ignored

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
                "a threshold relative to the task without a task zone; a task"
                " zone expected"
            )
