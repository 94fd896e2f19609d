"""Glare source detection, as in evalglare.

Pixels with luminance above a threshold are grouped into sources, and close sources are
merged. Optionally, dark pixels surrounded by a source are added (smoothing) and peaks
are extracted.
"""

import math
import warnings
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from clerestory.array_types import EachGroup, Image, ImageMask, PictureMasks, Pictures
from clerestory.checks import require
from clerestory.errors import ClerestoryWarning
from clerestory.glare.detection_criteria import SourceRules, Zone
from clerestory.glare.glare_view import GlareView
from clerestory.glare.mask_stack import MaskStack
from clerestory.glare.neighbour_search import Neighbourhood, neighbourhood
from clerestory.glare.peak_extraction import split_peaks
from clerestory.glare.pixel_scan import (
    ScannedPixels,
    first_scan,
    scan_order,
)
from clerestory.glare.smoothing import surrounded
from clerestory.glare.source_merging import merge_sources

# Ratio of half the merging angle to the smoothing radius (evalglare)
_SMOOTHING = 1.75

# A warning is issued if half the merging angle is less than this [pixels] (evalglare)
_FEW_PIXELS = 3.0

# Number of sets of glare pixels whose sources are kept
_KEPT = 2


class Members(NamedTuple):
    """Pixels of glare sources, each with the label of its source.

    Labels start at 1; labels of merged sources are unused. A pixel that smoothing adds
    to several sources is listed once per source.
    """

    label: Int[np.ndarray, " member"]
    row: Int[np.ndarray, " member"]
    column: Int[np.ndarray, " member"]


# Pixels that the sources of each picture of a group have
OwnMembers = Bool[np.ndarray, "_ _"]


def threshold_luminance(luminance: Image, eye: GlareView, rules: SourceRules) -> float:
    """Luminance above which pixels are glare pixels [cd/m²]."""
    if rules.threshold_kind == "luminance":
        return rules.threshold
    return rules.threshold * reference_luminance(luminance, eye, rules.task)


def reference_luminance(luminance: Image, eye: GlareView, task: Zone | None) -> float:
    """Mean luminance of the task, or of the picture if there is no task [cd/m²]."""
    weight = eye.solid_angle
    if task is not None:
        weight = weight * in_zone(eye, task)
    total = float(weight.sum())
    require(
        total > 0,
        "the task zone has no pixel in the picture; a larger opening angle expected",
    )
    return float(np.vdot(weight, luminance)) / total


def in_zone(eye: GlareView, zone: Zone) -> np.ndarray:
    """Whether each pixel is in a zone."""
    rows, columns = eye.shape
    require(
        0 <= zone.row < rows and 0 <= zone.column < columns,
        f"zone centre at row {zone.row}, column {zone.column} of a picture of"
        f" {columns} × {rows} pixels; a pixel of the picture expected",
    )
    return np.asarray(2 * eye.angle_from(zone.row, zone.column) <= zone.opening)


def merging_pixels(eye: GlareView, rules: SourceRules) -> float:
    """Half the merging angle [pixels]."""
    return rules.merge_angle / 2 / eye.pixel_angle()


def warn_if_coarse(eye: GlareView, rules: SourceRules, *, name: str) -> None:
    """Warn if pixels are too large for the merging of sources, as in evalglare.

    `name` of the picture or view precedes the message.
    """
    found, sides = merging_pixels(eye, rules), max(eye.shape)
    if found < _FEW_PIXELS:
        warnings.warn(
            f"{name}: a resolution of {sides} pixels is too coarse to tell glare"
            f" sources apart; {math.ceil(sides * _FEW_PIXELS / found)} or more"
            " expected",
            ClerestoryWarning,
            stacklevel=2,
        )


def find_sources(
    luminance: Image, eye: GlareView, rules: SourceRules | None = None
) -> Members:
    """Return the pixels of the glare sources of a picture."""
    search = SourceSearch(eye, rules or SourceRules())
    [(members, _)] = search.members([luminance[None]])
    return members


def glare_pixels(
    pictures: Pictures, eye: GlareView, rules: SourceRules
) -> tuple[PictureMasks, PictureMasks]:
    """Return the masks of the glare pixels of pictures, and of the pixels of peaks."""
    level = [threshold_luminance(each, eye, rules) for each in pictures]
    mask = pictures > np.array(level, pictures.dtype)[:, None, None]
    mask &= eye.valid
    if rules.field_of_view is not None:
        mask &= eye.in_field(rules.field_of_view)
    limit = np.inf if rules.peak_luminance is None else rules.peak_luminance
    return mask, pictures >= limit


def grouped(
    masks: Sequence[ImageMask],
    peaks: Sequence[ImageMask],
    eye: GlareView,
    rules: SourceRules,
) -> list[Members]:
    """Group the glare pixels of each picture into sources."""
    scale = merging_pixels(eye, rules)
    near = neighbourhood(eye, rules.merge_angle / 2)
    stack = MaskStack.of(masks, near.reach)
    pixels = scan_order(stack.mask, near.reach)
    label, picture = np.zeros(0, dtype=np.int64), pixels.row // stack.pitch
    place = stack.seen(pixels.row, pixels.column)
    seen = ScannedPixels(*place, pixels.island)
    if picture.size:
        label = first_scan(pixels, stack, near, single=scale <= 1)
        if scale > 1:
            label = merge_sources(seen, label, eye.solid_angle, near, skip_inner=True)
    order = np.argsort(picture, kind="stable")
    ends = np.cumsum(np.bincount(picture, minlength=len(masks)))
    found = []
    for own, mask, peak in zip(np.split(order, ends[:-1]), masks, peaks, strict=True):
        members = Members(label[own], seen.row[own], seen.column[own])
        if scale >= 1 and rules.smooth:
            members = _smooth(members, mask, eye, scale / _SMOOTHING)
        if scale >= 1 and rules.peak_luminance is not None:
            members = _split(members, peak, eye, near)
        found.append(members)
    return found


@dataclass
class _Marked:
    # Glare pixels and peaks of a picture, and the pixels of sources, once known
    mask: ImageMask
    peak: ImageMask
    members: Members | None = None


@dataclass
class SourceSearch:
    """Search for the glare sources of pictures of one view.

    The last results are kept, since pictures often have the same glare pixels.
    """

    eye: GlareView
    rules: SourceRules
    _last: deque[_Marked] = field(default_factory=lambda: deque(maxlen=_KEPT))

    def members(self, groups: Sequence[EachGroup]) -> list[tuple[Members, OwnMembers]]:
        """Return the pixels of glare sources, and those that each picture has.

        Pixels that are glare pixels in any picture of a group are grouped together.
        """
        masks, kept = [], []
        for pictures in groups:
            mask, peak = glare_pixels(pictures, self.eye, self.rules)
            masks.append(mask)
            every = (np.asarray(each.any(axis=0)) for each in (mask, peak))
            kept.append(self._kept(*every))
        new = list({id(one): one for one in kept if one.members is None}.values())
        if new:
            marks = [one.mask for one in new], [one.peak for one in new]
            for one, members in zip(
                new, grouped(*marks, self.eye, self.rules), strict=True
            ):
                one.members = members
        return [_of_pictures(mask, one) for mask, one in zip(masks, kept, strict=True)]

    def _kept(self, mask: ImageMask, peak: ImageMask) -> _Marked:
        for one in self._last:
            if np.array_equal(mask, one.mask) and np.array_equal(peak, one.peak):
                return one
        self._last.append(_Marked(mask, peak))
        return self._last[-1]


def _of_pictures(masks: PictureMasks, marked: _Marked) -> tuple[Members, OwnMembers]:
    # Pixels of sources of a group of pictures, and those that each of them has
    assert marked.members is not None
    place = marked.members.row, marked.members.column
    # Pixels that smoothing adds belong to the sources of all pictures
    return marked.members, masks[:, *place] | ~marked.mask[place]


def _smooth(
    members: Members, mask: np.ndarray, eye: GlareView, radius: float
) -> Members:
    dark = eye.valid & ~mask
    parts = [members]
    for label in np.unique(members.label):
        mine = np.zeros(eye.shape, dtype=bool)
        one = members.label == label
        mine[members.row[one], members.column[one]] = True
        row, column = np.nonzero(surrounded(mine, eye.solid_angle, radius) & dark)
        parts.append(Members(np.full(row.size, label), row, column))
    return Members(*map(np.concatenate, zip(*parts, strict=True)))


def _split(
    members: Members, peaks: np.ndarray, eye: GlareView, near: Neighbourhood
) -> Members:
    # The labels of extracted peaks are larger than all other labels
    peak = peaks[members.row, members.column]
    if not peak.any():
        return members
    label = members.label.copy()
    following = int(label.max()) + 1
    nearer = neighbourhood(eye, near.angle / 2)
    for source in np.unique(members.label[peak]):
        index = np.flatnonzero(peak & (members.label == source))
        here = ScannedPixels(
            members.row[index], members.column[index], np.zeros(index.size, np.int64)
        )
        number = split_peaks(here, eye.solid_angle, near, nearer)
        label[index] = following + number - 1
        following += int(number.max())
    return Members(label, members.row, members.column)
