"""High-dynamic-range pictures from exposure brackets of photographs.

Each pixel is the weighted mean of the radiances estimated from all photographs.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool

from clerestory.checks import require, same_length
from clerestory.image.camera_response import (
    LEVELS,
    ResponseCurve,
    check_bracket,
    response_named,
)
from clerestory.image.opencv import opencv
from clerestory.image.photograph import (
    Exposure,
    Photograph,
    read_exposure,
    read_photograph,
)
from clerestory.image.picture import Picture
from clerestory.progress import Progress

# Smallest and largest reliable pixel value, between noise and saturation
_DARKEST, _BRIGHTEST = 3, 252


class Merged(NamedTuple):
    """High-dynamic-range picture of relative radiance, with masks of unreliable pixels.

    Pixels in `overflow` are saturated even in the shortest exposure: their radiance is
    too low. Pixels in `underflow` are too dark even in the longest exposure.
    """

    picture: Picture
    overflow: Bool[np.ndarray, "row column"]
    underflow: Bool[np.ndarray, "row column"]


def merge_photographs(
    files: Sequence[str | Path],
    *,
    times: Sequence[float] | None = None,
    response: str = "debevec",
    align_first: bool = False,
    progress: Progress | None = None,
) -> tuple[Merged, ResponseCurve]:
    """Merge photographs from files; return the picture and the camera response.

    By default, exposure `times` [s] are read from the EXIF data. `response` is a name
    or a file, see `response_named`.
    """
    report = progress or (lambda _share, _note: None)
    photographs = [read_photograph(file) for file in files]
    if times:
        same_length(times, files, "exposure times", "photographs")
        exposures = [Exposure(time=time) for time in times]
    else:
        exposures = [read_exposure(file) for file in files]
    if align_first:
        report(0.2, "aligning")
        photographs = align(photographs)
    report(0.4, "response")
    curve = response_named(response, photographs, exposures)
    report(0.7, "merging")
    merged = merge_bracket(photographs, exposures, curve)
    report(1.0, "done")
    return merged, curve


def merge_bracket(
    photographs: Sequence[Photograph],
    exposures: Sequence[Exposure],
    response: ResponseCurve,
) -> Merged:
    """Return the high-dynamic-range picture of a bracket of photographs.

    The weight of a pixel is the difference of its value from 0 or 255, whichever is
    smaller, times the exposure, because relative noise decreases with exposure.
    """
    check_bracket(photographs, exposures)
    order = np.argsort([exposure.relative() for exposure in exposures])
    value = np.arange(LEVELS)
    trust = np.minimum(value, LEVELS - 1 - value).astype(float)
    trust[(value < _DARKEST) | (value > _BRIGHTEST)] = 0

    total = np.zeros(photographs[0].shape)
    weight = np.zeros(photographs[0].shape)
    for i in order:
        for channel in range(3):
            pixels = photographs[i][..., channel]
            total[..., channel] += (trust * response.exposure[:, channel])[pixels]
            weight[..., channel] += (trust * exposures[i].relative())[pixels]

    # Pixels unreliable in all photographs: use the shortest or longest exposure
    first, last = order[0], order[-1]
    bright = (photographs[first] > _BRIGHTEST) & (weight == 0)
    dark = (photographs[last] < _DARKEST) & (weight == 0)
    most, least = (
        _radiance(photographs[i], exposures[i], response) for i in (first, last)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        radiance = np.where(weight > 0, total / weight, np.where(bright, most, least))
    return Merged(
        Picture(radiance.astype(np.float32)), bright.any(axis=2), dark.all(axis=2)
    )


def _radiance(
    photograph: Photograph, exposure: Exposure, response: ResponseCurve
) -> np.ndarray:
    channels = [response.exposure[photograph[..., c], c] for c in range(3)]
    return np.asarray(np.stack(channels, axis=-1) / exposure.relative())


def align(photographs: Sequence[Photograph]) -> list[Photograph]:
    """Return photographs of a hand-held camera, shifted into alignment.

    Source: Ward, G. (2003): Fast, robust image registration for compositing high
    dynamic range photographs from hand-held exposures. Journal of Graphics Tools 8(2).
    Implemented by OpenCV.
    """
    require(photographs, "no photographs; two or more expected")
    images = [np.ascontiguousarray(photograph) for photograph in photographs]
    opencv().createAlignMTB().process(images, images)
    return images
