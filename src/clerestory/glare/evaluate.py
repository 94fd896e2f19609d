"""Glare evaluation of a picture, as in evalglare."""

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.glare.cropped_picture import SeenRows, fill_cut
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.dgp import EVALGLARE, DgpCoefficients
from clerestory.glare.glare_view import GlareView, glare_view
from clerestory.glare.index import Background
from clerestory.glare.picture_checks import check_photometry
from clerestory.glare.position_index import PositionModel
from clerestory.glare.result import Glare
from clerestory.glare.sources import (
    Members,
    find_sources,
    reference_luminance,
    tabulate,
)
from clerestory.glare.zones import Zones, cut_along
from clerestory.image.picture import Picture
from clerestory.scene.view import View

_Luminance = Float[np.ndarray, "row column"]


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
) -> Glare:
    """Return the glare sources and indices of a picture, as in evalglare 3.06.

    Parameters
    ----------
    rules : criteria of glare source detection
    view : view of the picture; default: from the picture's header
    given_illuminance : measured vertical illuminance, used for DGP [lux]
    background : definition of the background luminance, see `EyePhotometry`
    zones : zones along whose borders sources are divided
    low_light, age, coefficients : corrections and coefficients of DGP, see `Glare`
    position_model : model of the position index
    seen : captured rows of a cropped picture; the missing rows are extrapolated
    trust : whether to omit the checks of projection and photometric scale

    Raises
    ------
    InputError : the picture has no view, does not fit the view, or has no photometric
        scale

    Examples
    --------
    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> pixels = np.full((160, 160, 3), 2.0, dtype=np.float32)
    >>> pixels[50:60, 75:85] = 60.0
    >>> result = evaluate_glare(Picture(pixels, view=eye))
    >>> round(result.illuminance), round(result.dgp, 3), result.sources.count
    (1462, 0.263, 1)
    """
    rules = rules or SourceRules()
    eye = eye_of(picture, view=view, position_model=position_model, trust=trust)
    luminance = picture.luminance()
    if seen is not None:
        luminance = fill_cut(luminance, eye, seen)
    members = find_sources(luminance, eye, rules)
    return summarise(
        luminance,
        eye,
        members,
        rules=rules,
        zones=zones,
        given_illuminance=given_illuminance,
        background=background,
        low_light=low_light,
        age=age,
        coefficients=coefficients,
    )


def eye_of(
    picture: Picture,
    *,
    view: View | None = None,
    position_model: PositionModel = "guth",
    trust: bool = False,
) -> GlareView:
    """Check a picture and return the pixel quantities of the view."""
    seen = view or picture.view
    if seen is None:
        raise InputError(
            "the picture has no view; a VIEW= line in its header, or a view as an"
            " argument, expected"
        )
    eye = glare_view(seen, picture.columns, picture.rows, model=position_model)
    check_photometry(picture, seen, trust=trust)
    return eye


def summarise(
    luminance: _Luminance,
    eye: GlareView,
    members: Members,
    *,
    rules: SourceRules,
    zones: Zones | None = None,
    given_illuminance: float | None = None,
    background: Background = "cie",
    low_light: bool = False,
    age: float | None = None,
    coefficients: DgpCoefficients = EVALGLARE,
) -> Glare:
    """Return the glare of a picture whose glare source pixels are `members`."""
    zone_of = None
    if zones is not None:
        members, zone_of = cut_along(members, zones.of_pixels(eye))
    sources = tabulate(members, luminance, eye, zone=zone_of)
    values = np.ascontiguousarray(luminance, dtype=float).ravel()
    average = float(eye.solid_angle.ravel() @ values) / eye.total_solid_angle
    return Glare(
        sources=sources.larger_than(rules.smallest),
        illuminance=float(eye.eye_weight.ravel() @ values),
        given_illuminance=given_illuminance,
        average=average,
        reference=(
            reference_luminance(luminance, eye, rules.task) if rules.task else average
        ),
        brightest=float((luminance * eye.valid).max()),
        solid_angle=eye.total_solid_angle,
        background_kind=background,
        low_light=low_light,
        age=age,
        coefficients=coefficients,
    )
