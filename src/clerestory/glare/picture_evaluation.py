"""Glare evaluation of picture files, with the options of evalglare."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.errors import InputError
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.check_picture import Colour, check_picture
from clerestory.glare.cropped_picture import SeenRows, fill_cut
from clerestory.glare.detection_criteria import (
    LARGEST_FACTOR,
    SourceRules,
    Threshold,
    Zone,
)
from clerestory.glare.dgp import EVALGLARE, DgpCoefficients
from clerestory.glare.evalglare_options import (
    Circle,
    EvalglareOptions,
    IndexOptions,
    RegionOptions,
    SourceOptions,
)
from clerestory.glare.evaluate import eye_of, summarise
from clerestory.glare.field_of_view import FieldOfView
from clerestory.glare.glare_view import GlareView
from clerestory.glare.pgsv import contrast_pgsv, pgsv, saturation_pgsv
from clerestory.glare.region_statistics import (
    MASK_LUMINANCE,
    RegionStatistics,
    band,
    region_statistics,
)
from clerestory.glare.result import Glare
from clerestory.glare.sources import Members, find_sources, in_zone
from clerestory.glare.zones import Zones
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture
from clerestory.progress import Progress
from clerestory.radiance.view_text import parse_view, read_view
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

# Default thresholds of evalglare: ratio to the mean luminance of the task; luminance
# [cd/m²] if there is no task
_TASK_FACTOR, _LUMINANCE = 5.0, 2000.0

_FIELDS: dict[str | None, FieldOfView | None] = {
    None: None,
    "1": "total",
    "2": "binocular",
}


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Glare evaluation of one picture.

    Attributes
    ----------
    picture : evaluated picture
    luminance : luminance of the pixels [cd/m²]
    eye : pixel quantities of the view
    members : pixels of the glare sources
    result : glare sources and indices
    regions : luminance statistics of the requested regions, by name
    task : task zone
    """

    picture: Picture
    luminance: np.ndarray
    eye: GlareView
    members: Members
    result: Glare
    regions: dict[str, RegionStatistics]
    task: Zone | None

    def check_picture(
        self, *, colour: Colour | None = None, show_task: bool = False
    ) -> Picture:
        """Return the picture with coloured sources and optionally a blue task zone."""
        blue = in_zone(self.eye, self.task) if show_task and self.task else None
        return check_picture(self.picture, self.members, colour=colour, task=blue)

    def window_votes(self) -> dict[str, float]:
        """Return the predicted glare sensation votes of the window in the mask."""
        if "mask" not in self.regions:
            return {}
        window = self.regions["mask"]
        common = {
            "window": window.average,
            "window_solid_angle": window.solid_angle,
            "average": self.result.average,
        }
        level = self.result.illuminance
        return {
            "pgsv_con": contrast_pgsv(**common),
            "pgsv_sat": saturation_pgsv(level),
            "pgsv": pgsv(**common, illuminance=level, task=self.result.reference),
        }


def evaluate_file(
    file: str | Path, options: EvalglareOptions | None = None
) -> Evaluation:
    """Return the glare evaluation of a picture file."""
    options = options or EvalglareOptions()
    picture = read_picture(file)
    eye = eye_of(
        picture,
        view=_view(options),
        position_model="kim" if options.indices.position == "1" else "guth",
        trust=options.trust,
    )
    luminance = picture.luminance()
    rows = _rows_in_picture(options.indices, picture.rows)
    if rows is not None:
        luminance = fill_cut(luminance, eye, rows)
    rules = _rules(options.sources, picture.rows)
    zones = _zones(options.regions, picture.rows)
    members = find_sources(luminance, eye, rules)
    result = summarise(
        luminance,
        eye,
        members,
        rules=rules,
        zones=zones,
        **_index_keywords(options.indices),
    )
    regions = _regions(luminance, eye, options.regions, zones)
    return Evaluation(picture, luminance, eye, members, result, regions, rules.task)


def annual_glare_of_files(
    files: Sequence[str | Path],
    options: EvalglareOptions | None = None,
    *,
    progress: Progress | None = None,
) -> "xr.Dataset":
    """Return the glare indices of picture files of one view, one file per time step.

    Raises
    ------
    InputError : an option applies to single pictures only, or pictures differ in size
    """
    options = options or EvalglareOptions()
    keywords = _index_keywords(options.indices)
    given, age = keywords.pop("given_illuminance"), keywords.pop("age")
    if age is not None or given is not None:
        raise InputError(
            "--age or --illuminance with several pictures; a single picture expected"
        )
    first = read_picture(files[0])
    view = eye_of(first, view=_view(options), trust=options.trust).view

    def luminances() -> Iterator[np.ndarray]:
        for done, file in enumerate(files):
            yield read_picture(file).luminance()
            if progress is not None:
                progress((done + 1) / len(files), str(file))

    rules = _rules(options.sources, first.rows)
    return annual_glare(luminances(), view, rules=rules, **keywords)


def _view(options: EvalglareOptions) -> View | None:
    if options.view is None:
        return None
    is_text = options.view.lstrip().startswith("-")
    return parse_view(options.view) if is_text else read_view(options.view)


def _rules(options: SourceOptions, rows: int) -> SourceRules:
    level, kind = _threshold(options)
    return SourceRules(
        threshold=level,
        threshold_kind=kind,
        task=None if options.task is None else _zone(options.task, rows),
        merge_angle=options.merge_angle,
        peak_luminance=options.peak if options.split_peaks else None,
        smooth=options.smooth,
        smallest=options.smallest,
        field_of_view=_FIELDS[options.field],
    )


def _threshold(options: SourceOptions) -> tuple[float, Threshold]:
    # Numbers up to 100 are ratios to a mean luminance
    value = options.threshold
    if value is None:
        value = _LUMINANCE if options.task is None else _TASK_FACTOR
    if value > LARGEST_FACTOR:
        return value, "luminance"
    return value, "times_mean" if options.task is None else "times_task"


def _rows_in_picture(options: IndexOptions, rows: int) -> SeenRows | None:
    # Captured rows of a cropped picture; None if the picture is complete
    if options.fill is None:
        return None
    _, above, below = options.fill
    if not -1 < below < above - 1 < rows:
        raise InputError(
            f"extrapolated above row {above} and below row {below}, of {rows} rows;"
            " captured rows between them expected"
        )
    return SeenRows(first=rows - above, last=rows - 2 - below)


def _index_keywords(options: IndexOptions) -> dict[str, Any]:
    # Keyword arguments of `summarise`
    return {
        "given_illuminance": options.fill[0] if options.fill else options.illuminance,
        "background": options.background,
        "low_light": options.correction == "l+",
        "age": options.age,
        "coefficients": _coefficients(options),
    }


def _coefficients(options: IndexOptions) -> DgpCoefficients:
    if options.weights is None:
        return EVALGLARE
    a1, a2, a3, a4, a5, c1, c2, c3 = options.weights
    return DgpCoefficients(c1=c1, c2=c2, c3=c3, a1=a1, a2=a2, a3=a3, a4=a4, a5=a5)


def _zone(circle: Circle, rows: int) -> Zone:
    # Options count rows from below, as in Radiance
    x, y, opening = circle
    return Zone(row=rows - 1 - y, column=x, opening=opening)


def _zones(options: RegionOptions, rows: int) -> Zones | None:
    if options.zones is not None:
        x, y, inner, outer = options.zones
        return Zones(_zone((x, y, inner), rows), outer)
    if options.zone is not None:
        return Zones(_zone(options.zone, rows))
    return None


def _regions(
    luminance: np.ndarray, eye: GlareView, options: RegionOptions, zones: Zones | None
) -> dict[str, RegionStatistics]:
    masks: dict[str, np.ndarray] = {}
    if options.band is not None:
        masks["band"] = band(eye, options.band)
    if options.mask is not None:
        masks["mask"] = _mask(options.mask, eye)
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
            f"a mask of {bright.shape[1]} × {bright.shape[0]} pixels; the size of the"
            f" picture, {eye.shape[1]} × {eye.shape[0]}, expected",
            file=file,
        )
    marked: np.ndarray = bright > MASK_LUMINANCE
    return marked
