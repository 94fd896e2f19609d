"""Criteria of glare source detection, as in evalglare."""

import math
from dataclasses import dataclass
from typing import Literal

from clerestory.checks import not_negative, positive, require, within
from clerestory.glare.field_of_view import FieldOfView

Threshold = Literal["luminance", "times_mean", "times_task"]

# Thresholds up to this value are multiples of a mean luminance (evalglare -b)
LARGEST_FACTOR = 100.0


@dataclass(frozen=True)
class Zone:
    """Circular zone: centre row (from the top) and column, full opening angle [rad]."""

    row: int
    column: int
    opening: float

    def __post_init__(self) -> None:
        most = 2 * math.pi
        within(self.opening, "opening angle", least=0, most=most, unit="rad")


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
    merge_angle : sources closer than half this angle are merged [rad]
    peak_luminance : lowest luminance of pixels extracted as separate sources
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
        positive(self.threshold, "threshold")
        positive(self.merge_angle, "merging angle", unit="rad")
        if self.peak_luminance is not None:
            least = self.peak_luminance
            require(least > 0, f"peak luminance is {least:g} cd/m²; above 0 expected")
        not_negative(self.smallest, "smallest source", unit="sr")
        require(
            self.task is not None or self.threshold_kind != "times_task",
            "a threshold relative to the task without a task zone; a task zone"
            " expected",
        )
