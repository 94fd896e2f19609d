"""Glare evaluation of a picture, as in evalglare."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field

from clerestory.array_types import Image
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.glare.check_picture import Colour, check_picture
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.glare_view import GlareView, glare_view
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import Glare
from clerestory.glare.luminance_evaluation import evaluate_luminance
from clerestory.glare.luminance_statistics import RegionStatistics
from clerestory.glare.pgsv import contrast_pgsv, pgsv, saturation_pgsv
from clerestory.glare.picture_checks import check_photometry
from clerestory.glare.position_index import PositionModel
from clerestory.glare.sources import (
    Members,
    SourceSearch,
    in_zone,
    warn_if_coarse,
)
from clerestory.glare.uncertainty import (
    UncertainLuminance,
    luminance_error,
)
from clerestory.glare.zones import Zones
from clerestory.image.picture import Picture
from clerestory.scene.view import View


@dataclass(frozen=True)
class SeenRows:
    """First and last captured row of a cropped picture, counted from the top."""

    first: int
    last: int

    def __post_init__(self) -> None:
        require(
            0 <= self.first <= self.last,
            f"captured rows are {self.first} to {self.last}; 0 ≤ first ≤ last expected",
        )


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Glare evaluation of one picture, with statistics of the requested regions."""

    picture: Picture
    rules: SourceRules
    luminance: Image
    eye: GlareView
    members: Members
    result: Glare
    regions: Mapping[str, RegionStatistics] = field(default_factory=dict)

    __repr__ = brief

    def check_picture(
        self, *, colour: Colour | None = None, show_task: bool = False
    ) -> Picture:
        """Return the picture with coloured sources and optionally a blue task zone."""
        task = self.rules.task if show_task else None
        blue = None if task is None else in_zone(self.eye, task)
        return check_picture(self.picture, self.members, colour=colour, task=blue)

    def window_votes(self) -> dict[str, float]:
        """Return the glare sensation votes (PGSV) of the window marked by the mask."""
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


def evaluate_glare(
    picture: Picture,
    *,
    rules: SourceRules | None = None,
    view: View | None = None,
    given_illuminance: float | None = None,
    background: Background = "cie",
    zones: Zones | None = None,
    low_light: bool = False,
    age: float | None = None,
    coefficients: DgpCoefficients = EVALGLARE,
    position_model: PositionModel = "guth",
    seen: SeenRows | None = None,
    trust: bool = False,
    error: Picture | None = None,
) -> Glare:
    """Return the glare sources and indices of a picture, as in evalglare 3.06.

    Parameters
    ----------
    rules : criteria of glare source detection
    view : view of the picture; default: from the picture's header
    given_illuminance : measured vertical illuminance, used for DGP [lux]
    background : definition of the background luminance: "cie": (Ev − Edir)/π;
        "average": mean luminance outside of the sources; "illuminance": Ev/π
    zones : zones whose borders divide glare sources
    low_light : whether DGP is corrected for low vertical illuminance
    age : age of the observer for the correction of DGP [years]; None for no correction
    coefficients : coefficients of DGP
    position_model : model of the position index
    seen : captured rows of a cropped picture; the missing rows are extrapolated
    trust : whether to omit the checks of projection and photometric scale
    error : standard error of each pixel, as of a `Rendering`; gives the standard errors
        of the indices

    Raises
    ------
    InputError : the picture has no view, does not fit the view, or has no photometric
        scale

    Examples
    --------
    >>> import numpy as np
    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> pixels = np.full((160, 160, 3), 2.0, dtype=np.float32)
    >>> pixels[50:60, 75:85] = 60.0
    >>> result = evaluate_glare(Picture(pixels, view=eye))
    >>> round(result.illuminance), round(result.dgp, 3), result.sources.count
    (1462, 0.263, 1)
    """
    rules = rules or SourceRules()
    settings = IndexSettings(
        background, given_illuminance, low_light, age, coefficients
    )
    eye = eye_of(picture, view=view, position_model=position_model, trust=trust)
    return evaluate_picture(
        picture, rules, settings, eye, zones=zones, seen=seen, error=error
    ).result


def evaluate_picture(
    picture: Picture,
    rules: SourceRules,
    settings: IndexSettings,
    eye: GlareView,
    *,
    zones: Zones | None = None,
    seen: SeenRows | None = None,
    error: Picture | None = None,
) -> Evaluation:
    """Return the glare evaluation of a picture already checked by `eye_of`."""
    images = [picture.luminance()]
    if error is not None:
        images.append(luminance_error(error, picture))
    if seen is not None:
        images = [fill_cut(image, eye, seen) for image in images]
    warn_if_coarse(eye, rules, name="the picture")
    luminance = images[0] if error is None else UncertainLuminance(*images)
    search = SourceSearch(eye, rules)
    members, result, poor = evaluate_luminance(luminance, search, settings, zones=zones)
    if poor is not None:
        warnings.warn(poor.words(), ClerestoryWarning, stacklevel=2)
    return Evaluation(picture, rules, images[0], eye, members, result)


def eye_of(
    picture: Picture,
    *,
    view: View | None = None,
    position_model: PositionModel = "guth",
    trust: bool = False,
) -> GlareView:
    """Check a picture and return the pixel quantities of its view."""
    seen = view or picture.view
    if seen is None:
        raise InputError(
            "the picture has no view; a VIEW= line in its header, or a view as an"
            " argument, expected"
        )
    eye = glare_view(seen, picture.columns, picture.rows, model=position_model)
    check_photometry(picture, seen, trust=trust)
    return eye


def fill_cut(luminance: Image, eye: GlareView, seen: SeenRows) -> Image:
    """Return the luminance [cd/m²], with missing rows set to the nearest captured row.

    As in evalglare -I, a column is extrapolated upwards only if the pixel of its first
    captured row is within the field of view.
    """
    require(
        seen.last < len(luminance),
        f"last captured row {seen.last} in a picture of {len(luminance)} rows; a"
        " smaller number expected",
    )
    filled = luminance.copy()
    filled[: seen.first] = luminance[seen.first] * eye.valid[seen.first]
    filled[seen.last + 1 :] = luminance[seen.last]
    return filled
