"""Target standard error of the DGP of a rendered picture.

The standard error is that of `evaluate_glare`, with the detection of glare sources.
Paths are distributed over the pixels by their contributions to the variance of DGP to
first order, as in `glare.dgp_error`: pixels of glare sources, and of large vertical
illuminance at the eye.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Image
from clerestory.checks import require, within
from clerestory.engine.pixel_goals import PixelEstimates, PixelGoal
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.dgp_error import dgp_slopes
from clerestory.glare.glare_view import glare_view
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.luminance_evaluation import evaluate_luminance
from clerestory.glare.sources import SourceSearch
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.scene.view import View

# Smallest share of the vertical illuminance at the eye that a view covers
_COVERED = 0.99


@checked_fields
@dataclass(frozen=True)
class DgpError(PixelGoal):
    """Target standard error of DGP, for `render`; the view is a fisheye of 180°.

    DGP is that of `evaluate_glare` with its default rules.

    Raises
    ------
    InputError : a target outside of 0.0001…0.5

    Examples
    --------
    >>> DgpError(0.01).name
    'the standard error of DGP 0.01'
    """

    target: float

    def __post_init__(self) -> None:
        within(self.target, "standard error of DGP", least=1e-4, most=0.5)

    @property
    def name(self) -> str:
        """Name and value of the target, for messages."""
        return f"the standard error of DGP {self.target:g}"

    def check_view(self, view: View, columns: int, rows: int) -> None:
        """Require that the view covers the hemisphere in front of the eye."""
        covered = float(glare_view(view, columns, rows).eye_weight.sum()) / np.pi
        require(
            covered > _COVERED,
            f"the view covers {covered:.0%} of the vertical illuminance at the eye; a"
            " fisheye view of 180° (-vta, -vth) expected for DGP",
        )

    def error(self, pixels: PixelEstimates) -> float:
        """Return the standard error of DGP relative to the target."""
        luminance, error = _luminance(pixels)
        eye = glare_view(pixels.view, *luminance.shape[::-1])
        search = SourceSearch(eye, SourceRules())
        found = UncertainLuminance(luminance, error)
        _, result, _ = evaluate_luminance(found, search, IndexSettings())
        return float(result.errors["dgp"]) / self.target

    def contributions(self, pixels: PixelEstimates) -> Float[np.ndarray, "row column"]:
        """Return the contribution of each pixel to the variance of DGP."""
        luminance, error = _luminance(pixels)
        eye = glare_view(pixels.view, *luminance.shape[::-1])
        k, threshold = IndexSettings().coefficients, SourceRules().threshold

        def glare(level: Image) -> Image:
            return np.asarray(np.where(level > threshold, level, 0) ** k.a1)

        by_source = eye.solid_angle / eye.position_index**k.a4
        total = np.sum(by_source * glare(luminance), keepdims=True)
        illuminance = eye.illuminance(luminance[None])
        by_level, by_glare = dgp_slopes(illuminance[:, None], total, k)
        change = glare(luminance + error) - glare(np.maximum(luminance - error, 0))
        deviation = (
            by_level * eye.eye_weight * error + by_glare * by_source * change / 2
        )
        return np.asarray(np.square(deviation))


def _luminance(pixels: PixelEstimates) -> tuple[Image, Image]:
    # Luminance and its standard error; errors of the bands are fully correlated
    bands = pixels.bands
    error = bands.photometric(np.sqrt(pixels.variance))
    return np.asarray(bands.photometric(pixels.value)), np.asarray(error)
