"""Glare evaluation of picture files, with the options of evalglare."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory.checks import require
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.detection_criteria import (
    LARGEST_FACTOR,
    SourceRules,
    Threshold,
    Zone,
)
from clerestory.glare.evalglare_options import (
    Circle,
    EvalglareOptions,
    IndexOptions,
    RegionOptions,
    SourceOptions,
)
from clerestory.glare.evaluate import Evaluation, SeenRows, evaluate_picture, eye_of
from clerestory.glare.field_of_view import FieldOfView
from clerestory.glare.glare_view import GlareView
from clerestory.glare.index_settings import EVALGLARE, DgpCoefficients, IndexSettings
from clerestory.glare.luminance_statistics import (
    MASK_LUMINANCE,
    RegionStatistics,
    band,
    region_statistics,
)
from clerestory.glare.position_index import PositionModel
from clerestory.glare.uncertainty import UncertainLuminance, luminance_error
from clerestory.glare.zones import Zones
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


def evaluate_file(
    file: str | Path,
    options: EvalglareOptions | None = None,
    *,
    error: str | Path | None = None,
) -> Evaluation:
    """Return the glare evaluation of a picture file.

    `error` is the file of the standard errors of its pixels, as from `render --error`.
    """
    options = options or EvalglareOptions()
    picture = read_picture(file)
    model: PositionModel = "kim" if options.indices.position == "1" else "guth"
    view = _view(options)
    eye = eye_of(picture, view=view, position_model=model, trust=options.trust)
    zones = _zones(options.regions, picture.rows)
    found = evaluate_picture(
        picture,
        _rules(options.sources, picture.rows),
        _settings(options.indices),
        eye,
        zones=zones,
        seen=_rows_in_picture(options.indices, picture.rows),
        error=None if error is None else read_picture(error),
    )
    regions = _regions(found.luminance, eye, options.regions, zones)
    return replace(found, regions=regions)


def annual_glare_of_files(
    files: Sequence[str | Path],
    options: EvalglareOptions | None = None,
    *,
    errors: Sequence[str | Path] = (),
    progress: Progress | None = None,
) -> "xr.Dataset":
    """Return the glare indices of picture files of one view, one file per time step.

    `errors` are the files of the standard errors of the pixels, if known.
    """
    options = options or EvalglareOptions()
    settings = _settings(options.indices)
    require(
        settings.age is None and settings.given_illuminance is None,
        "--age or --illuminance with several pictures; a single picture expected",
    )
    first = read_picture(files[0])
    view = eye_of(first, view=_view(options), trust=options.trust).view

    def luminances() -> Iterator[np.ndarray | UncertainLuminance]:
        for done, file in enumerate(files):
            picture = read_picture(file)
            if errors:
                error = luminance_error(read_picture(errors[done]), picture)
                yield UncertainLuminance(picture.luminance(), error)
            else:
                yield picture.luminance()
            if progress is not None:
                progress((done + 1) / len(files), str(file))

    return annual_glare(
        luminances(),
        view,
        rules=_rules(options.sources, first.rows),
        background=settings.background,
        low_light=settings.low_light,
        coefficients=settings.coefficients,
    )


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
    require(
        -1 < below < above - 1 < rows,
        f"rows above {above} and below {below} are extrapolated in a picture of {rows}"
        " rows; captured rows between them expected",
    )
    return SeenRows(first=rows - above, last=rows - 2 - below)


def _settings(options: IndexOptions) -> IndexSettings:
    weights = EVALGLARE
    if options.weights is not None:
        *powers, c1, c2, c3 = options.weights
        weights = DgpCoefficients(c1, c2, c3, *powers)
    return IndexSettings(
        options.background,
        options.fill[0] if options.fill else options.illuminance,
        low_light=options.correction == "l+",
        age=options.age,
        coefficients=weights,
    )


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
    require(
        bright.shape == eye.shape,
        f"a mask of {bright.shape[1]} × {bright.shape[0]} pixels; the size of the"
        f" picture, {eye.shape[1]} × {eye.shape[0]}, expected",
        file=file,
    )
    return np.asarray(bright > MASK_LUMINANCE)
