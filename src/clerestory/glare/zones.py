"""Zones of a picture; glare sources are divided along the borders of zones."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from clerestory.checks import require
from clerestory.glare.detection_criteria import Zone
from clerestory.glare.glare_view import GlareView
from clerestory.glare.sources import Members, in_zone


@dataclass(frozen=True)
class Zones:
    """Zone 1 is a circle, zone 2 the ring around it up to `outer_opening` [rad].

    Without `outer_opening` there is no zone 2.
    """

    inner: Zone
    outer_opening: float | None = None

    def __post_init__(self) -> None:
        inner, outer = self.inner.opening, self.outer_opening
        require(
            outer is None or outer > inner,
            f"the outer opening angle is {outer} rad; more than the inner one of"
            f" {inner:g} rad expected",
        )

    def of_pixels(self, eye: GlareView) -> Int[np.ndarray, "row column"]:
        """Zone number of each pixel: 1 inner circle, 2 ring, 0 elsewhere."""
        inside = in_zone(eye, self.inner)
        if self.outer_opening is None:
            return inside.astype(np.int64)
        inner = self.inner
        reach = in_zone(eye, Zone(inner.row, inner.column, self.outer_opening))
        return np.where(inside, 1, np.where(reach, 2, 0))


def cut_along(
    members: Members, zone: Int[np.ndarray, "row column"]
) -> tuple[Members, Int[np.ndarray, " label"]]:
    """Divide glare sources along the borders of zones.

    The pixels of a source that lie in a zone become a new source. New labels follow all
    existing labels, in scan order. Return the divided sources and the zone number of
    each label.
    """
    label, row, column = members
    where = zone[row, column]
    count = int(label.max(initial=0))
    inside = np.flatnonzero(where)
    inside = inside[np.lexsort((-row[inside], column[inside]))]
    key = label[inside] * 3 + where[inside]
    parts, first = np.unique(key, return_index=True)
    rank = np.empty(parts.size, dtype=np.int64)
    rank[np.argsort(first)] = np.arange(parts.size)

    new = label.copy()
    new[inside] = count + 1 + rank[np.searchsorted(parts, key)]
    zone_of = np.zeros(count + 1 + parts.size, dtype=np.int64)
    zone_of[count + 1 + rank] = parts % 3
    return Members(new, row, column), zone_of
