"""Section of a report: HTML, and JSON values for the scripts of the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from clerestory.report.class_map import DayMap
from clerestory.report.markup import Markup


@dataclass(frozen=True, eq=False)
class Section:
    """Section of a report: HTML, JSON values and annual maps.

    Attributes
    ----------
    body : HTML; empty if the results lack the quantities that the section shows
    data : JSON values for the scripts of the page
    maps : annual maps of glare categories or window states in the section
    """

    body: Markup | str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    maps: Sequence[DayMap] = ()
