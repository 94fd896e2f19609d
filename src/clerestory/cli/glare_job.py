"""What `clerestory glare` does with each picture, from the words of its options."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.errors import InputError
from clerestory.glare.check_picture import Colour, check_picture
from clerestory.glare.cropped_picture import SeenRows, fill_cut
from clerestory.glare.detection_criteria import (
    LARGEST_FACTOR,
    SourceRules,
    Threshold,
    Zone,
)
from clerestory.glare.dgp import EVALGLARE, DgpCoefficients
from clerestory.glare.evaluate import eye_of, summarise
from clerestory.glare.field_of_view import FieldOfView
from clerestory.glare.glare_view import GlareView
from clerestory.glare.index import Background
from clerestory.glare.pgsv import contrast_pgsv, pgsv, saturation_pgsv
from clerestory.glare.position_index import PositionModel
from clerestory.glare.region_statistics import (
    MASK_LUMINANCE,
    RegionStatistics,
    band,
    region_statistics,
)
from clerestory.glare.result import Glare
from clerestory.glare.sources import find_sources, in_zone
from clerestory.glare.zones import Zones
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.radiance.view_text import parse_view, read_view
from clerestory.scene.view import View

# Threshold in task luminances, and without a task [cd/m²] (evalglare)
_TASK_FACTOR, _LUMINANCE = 5.0, 2000.0

_FIELDS: dict[str | None, FieldOfView | None] = {
    None: None,
    "1": "total",
    "2": "binocular",
}

# Pixel to the right, pixel up from below, opening angles
Circle = tuple[int, int, float]
Circles = tuple[int, int, float, float]

# Illuminance of the eye, and the rows from which a cut picture is filled up and down
Filling = tuple[float, int, int]


@dataclass(frozen=True, kw_only=True)
class Job:
    """Everything asked for, in the words of the command line."""

    threshold: float | None
    task: Circle | None
    merge_angle: float
    smooth: bool
    peak: float | None
    smallest: float
    field: str | None
    illuminance: float | None
    fill: Filling | None
    background: Background
    low_light: bool
    age: float | None
    position: str
    view: str | None
    mask: Path | None
    band: float | None
    zone: Circle | None
    zones: Circles | None
    check: Path | None
    show_task: bool
    colour: Colour | None
    weights: tuple[float, ...] | None
    trust: bool

    def other_view(self) -> View | None:
        """View to take in place of the pictures' own: a file, or options."""
        if self.view is None or self.view.lstrip().startswith("-"):
            return None if self.view is None else parse_view(self.view)
        return read_view(self.view)

    def model(self) -> PositionModel:
        """Model of the position index."""
        return "kim" if self.position == "1" else "guth"

    def rules(self, rows: int) -> SourceRules:
        """Rules for sources in a picture of so many rows."""
        task = None if self.task is None else zone_from_below(self.task, rows)
        level, kind = self._threshold()
        return SourceRules(
            threshold=level,
            threshold_kind=kind,
            task=task,
            merge_angle=self.merge_angle,
            peak_luminance=self.peak,
            smooth=self.smooth,
            smallest=self.smallest,
            field_of_view=_FIELDS[self.field],
        )

    def _threshold(self) -> tuple[float, Threshold]:
        # Numbers up to 100 are multiples
        value = self.threshold
        if value is None:
            value = _LUMINANCE if self.task is None else _TASK_FACTOR
        if value > LARGEST_FACTOR:
            return value, "luminance"
        return value, "times_mean" if self.task is None else "times_task"

    def seen_rows(self, rows: int) -> SeenRows | None:
        """Rows seen of a picture of so many, where the others are to be filled."""
        if self.fill is None:
            return None
        _, above, below = self.fill
        if not -1 < below < above - 1 < rows:
            raise InputError(
                f"filled from row {above} up and from row {below} down, of {rows};"
                " rows between them expected"
            )
        return SeenRows(first=rows - above, last=rows - 2 - below)

    def coefficients(self) -> DgpCoefficients:
        """Coefficients of DGP."""
        if self.weights is None:
            return EVALGLARE
        a1, a2, a3, a4, a5, c1, c2, c3 = self.weights
        return DgpCoefficients(c1=c1, c2=c2, c3=c3, a1=a1, a2=a2, a3=a3, a4=a4, a5=a5)

    def summary_options(self) -> dict[str, Any]:
        """Arguments of `summarise` that no picture changes."""
        return {
            "given_illuminance": self.fill[0] if self.fill else self.illuminance,
            "background": self.background,
            "low_light": self.low_light,
            "age": self.age,
            "coefficients": self.coefficients(),
        }


def window_votes(result: Glare, window: RegionStatistics) -> dict[str, float]:
    """Return the glare sensation votes of a window that a mask marks."""
    seen = {
        "window": window.average,
        "window_solid_angle": window.solid_angle,
        "average": result.average,
    }
    level = result.illuminance
    return {
        "pgsv_con": contrast_pgsv(**seen),
        "pgsv_sat": saturation_pgsv(level),
        "pgsv": pgsv(**seen, illuminance=level, task=result.reference),
    }


@dataclass(frozen=True, eq=False)
class Evaluation:
    """One picture evaluated.

    Attributes
    ----------
    luminance, eye : the picture
    result : its glare
    regions : statistics of what was asked for, by name
    """

    luminance: np.ndarray
    eye: GlareView
    result: Glare
    regions: dict[str, RegionStatistics]


def evaluate(file: Path, job: Job) -> Evaluation:
    """Read a picture and return its glare; write the check picture if asked for."""
    picture = read_picture(file)
    eye = eye_of(
        picture, view=job.other_view(), position_model=job.model(), trust=job.trust
    )
    luminance = picture.luminance()
    seen = job.seen_rows(picture.rows)
    if seen is not None:
        luminance = fill_cut(luminance, eye, seen)
    rules = job.rules(picture.rows)
    zones = _zones(job, picture.rows)
    members = find_sources(luminance, eye, rules)
    result = summarise(
        luminance, eye, members, rules=rules, zones=zones, **job.summary_options()
    )
    if job.check is not None:
        blue = in_zone(eye, rules.task) if job.show_task and rules.task else None
        shown = check_picture(picture, members, colour=job.colour, task=blue)
        write_picture(shown, job.check)
    return Evaluation(luminance, eye, result, _regions(luminance, eye, job, zones))


def zone_from_below(circle: Circle, rows: int) -> Zone:
    """Zone of a circle whose middle is counted upwards, as Radiance counts pixels."""
    x, y, opening = circle
    return Zone(row=rows - 1 - y, column=x, opening=opening)


def _zones(job: Job, rows: int) -> Zones | None:
    if job.zones is not None:
        x, y, inner, outer = job.zones
        return Zones(zone_from_below((x, y, inner), rows), outer)
    if job.zone is not None:
        return Zones(zone_from_below(job.zone, rows))
    return None


def _regions(
    luminance: np.ndarray, eye: GlareView, job: Job, zones: Zones | None
) -> dict[str, RegionStatistics]:
    masks: dict[str, np.ndarray] = {}
    if job.band is not None:
        masks["band"] = band(eye, job.band)
    if job.mask is not None:
        masks["mask"] = _mask(job.mask, eye)
    if zones is not None:
        number = zones.of_pixels(eye)
        masks["z1"] = number == 1
        if zones.outer_opening is not None:
            masks["z2"] = number == 2
    return {
        name: region_statistics(luminance, eye, mask) for name, mask in masks.items()
    }


def _mask(file: Path, eye: GlareView) -> np.ndarray:
    bright = read_picture(file).luminance()
    if bright.shape != eye.shape:
        raise InputError(
            f"a mask of {bright.shape[1]} × {bright.shape[0]} pixels for a picture of"
            f" {eye.shape[1]} × {eye.shape[0]}; the same size expected",
            file=file,
        )
    marked: np.ndarray = bright > MASK_LUMINANCE
    return marked
