"""Glare source detection, as in evalglare.

Pixels with luminance above a threshold are grouped into sources, and close sources are
merged. Optionally, dark pixels surrounded by a source are added (smoothing) and peaks
are extracted.
"""

import itertools
import math
import warnings
from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from clerestory.array_types import Image, ImageMask, PictureMasks, Pictures
from clerestory.checks import require
from clerestory.errors import ClerestoryWarning
from clerestory.glare.detection_criteria import SourceRules, Zone
from clerestory.glare.glare_view import GlareView
from clerestory.glare.neighbour_search import Neighbourhood, neighbourhood
from clerestory.glare.peak_extraction import split_peaks
from clerestory.glare.pixel_scan import ScannedPixels, first_scan, scan_order
from clerestory.glare.smoothing import surrounded
from clerestory.glare.source_merging import merge_sources
from clerestory.glare.source_table import GlareSources

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
    return SourceSearch(eye, rules or SourceRules()).members(luminance[None])[0]


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
    mask: ImageMask, peak: ImageMask, eye: GlareView, rules: SourceRules
) -> Members:
    """Group glare pixels into sources."""
    scale = merging_pixels(eye, rules)
    near = neighbourhood(eye, rules.merge_angle / 2)
    pixels = scan_order(mask, near.reach)
    label = np.zeros(0, dtype=np.int64)
    if pixels.row.size:
        label = first_scan(pixels, mask, near, single=scale <= 1)
        if scale > 1:
            label = merge_sources(pixels, label, eye.solid_angle, near, skip_inner=True)
    members = Members(label, pixels.row, pixels.column)
    if scale < 1:
        return members
    if rules.smooth:
        members = _smooth(members, mask, eye, scale / _SMOOTHING)
    if rules.peak_luminance is not None:
        members = _split(members, peak, eye, near)
    return members


@dataclass
class SourceSearch:
    """Search for the glare sources of pictures of one view.

    The last results are kept, since pictures often have the same glare pixels.
    """

    eye: GlareView
    rules: SourceRules
    _last: deque[tuple[ImageMask, ImageMask, Members]] = field(
        default_factory=lambda: deque(maxlen=_KEPT)
    )

    def members(
        self, pictures: Pictures
    ) -> tuple[Members, Bool[np.ndarray, "picture member"]]:
        """Return the pixels of glare sources, and those that each picture has.

        Pixels that are glare pixels in any of the pictures are grouped together.
        """
        masks, peaks = glare_pixels(pictures, self.eye, self.rules)
        every, peak = np.asarray(masks.any(axis=0)), np.asarray(peaks.any(axis=0))
        members = self._grouped(every, peak)
        place = members.row, members.column
        # Pixels that smoothing adds belong to the sources of all pictures
        return members, masks[:, *place] | ~every[place]

    def _grouped(self, mask: ImageMask, peak: ImageMask) -> Members:
        for before, peaks, members in self._last:
            if np.array_equal(mask, before) and np.array_equal(peak, peaks):
                return members
        members = grouped(mask, peak, self.eye, self.rules)
        self._last.append((mask, peak, members))
        return members


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


def tabulate(
    members: Members,
    luminance: Image,
    eye: GlareView,
    *,
    zone: Int[np.ndarray, " label"] | None = None,
) -> GlareSources:
    """Return the table of the sources of a picture, in the order of labels."""
    every = np.ones((1, len(members.label)), bool)
    return tables(members, every, luminance[None], eye, zone=zone)[0]


def tables(
    members: Members,
    own: Bool[np.ndarray, "picture member"],
    pictures: Pictures,
    eye: GlareView,
    *,
    zone: Int[np.ndarray, " label"] | None = None,
    error: Image | None = None,
) -> list[GlareSources]:
    """Return the tables of the sources of pictures, in the order of labels.

    `own` are the members of the sources in each picture. `error` is the standard error
    of each pixel, independent of those of other pixels.
    """
    picture, member = np.nonzero(own)
    row, column = members.row[member], members.column[member]
    # Labels of the sources of a picture follow those of the picture before
    count = int(members.label.max(initial=0)) + 1
    label = members.label[member] + count * picture
    bright = pictures[picture, row, column].astype(float)
    omega = eye.solid_angle[row, column]
    flux = bright * omega

    pixels = np.bincount(label, minlength=1)
    used = np.flatnonzero(pixels)

    def total(values: np.ndarray) -> np.ndarray:
        return np.asarray(np.bincount(label, weights=values)[used], dtype=float)

    # Centre of each source, weighted by luminance; the pixel at the centre defines
    # position index and direction. evalglare counts rows from below and truncates
    # coordinates
    solid_angle, power = total(omega), total(flux)
    noise = np.zeros(label.size) if error is None else error[row, column] * omega
    last = eye.shape[0] - 1
    up, across = total(flux * (last - row)) / power, total(flux * column) / power
    up_pixel, column_pixel = (x.astype(np.float32).astype(int) for x in (up, across))
    at = last - up_pixel, column_pixel
    found = GlareSources(
        luminance=power / solid_angle,
        solid_angle=solid_angle,
        position_index=eye.position_index[at],
        sigma=eye.sigma[at],
        direction=eye.direction[at],
        illuminance=total(bright * eye.eye_weight[row, column]),
        pixels=pixels[used],
        row=last - up,
        column=across,
        zone=np.zeros(used.size, dtype=np.int64)
        if zone is None
        else zone[used % count],
        luminance_error=np.sqrt(total(noise**2)) / solid_angle,
    )
    first = np.searchsorted(used, count * np.arange(len(pictures) + 1))
    return [found.select(np.arange(*some)) for some in itertools.pairwise(first)]
