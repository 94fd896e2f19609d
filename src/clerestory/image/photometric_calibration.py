"""Photometric calibration of pictures by the illuminance measured at the camera."""

import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.checks import positive, require
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.image.arithmetic import scale
from clerestory.image.picture import Picture
from clerestory.scene.view import solid_angles

# Relative change of illuminance during a bracket above which a warning is given
_DRIFT = 0.10

# A picture that yields a smaller fraction of the measured illuminance is clipped
_COMPLETE = 0.80


class Calibration(NamedTuple):
    """A picture in absolute radiance, and the factor by which it was scaled.

    `illuminance` is the mean illuminance measured at the camera [lux], and `drift` the
    relative change of illuminance during the bracket.
    """

    picture: Picture
    factor: float
    illuminance: float
    drift: float


def eye_illuminance(picture: Picture) -> float:
    """Illuminance on the plane perpendicular to the view direction [lux]."""
    return float((picture.luminance() * _projected_solid_angles(picture)).sum())


def _projected_solid_angles(picture: Picture) -> Float[np.ndarray, "row column"]:
    # Solid angle of each pixel [sr] times the cosine of its angle to the view direction
    view = picture.view
    if view is None:
        raise InputError("the picture has no view; a hemispherical view expected")
    size = picture.columns, picture.rows
    cosine = np.maximum(view.rays(*size).direction @ view.direction, 0)
    return np.asarray(solid_angles(view, *size) * cosine)


def calibrate(picture: Picture, *, before: float, after: float) -> Calibration:
    """Return a hemispherical picture, scaled to the measured illuminance.

    `before` and `after` are illuminances at the lens [lux], before and after the
    exposure bracket. A change by more than 10 % gives a warning.
    """
    positive([before, after], "measured illuminance", unit="lux")
    found = eye_illuminance(picture)
    require(found > 0, "the picture is black; a picture of a lit scene expected")
    measured = (before + after) / 2
    drift = abs(after - before) / measured
    if drift > _DRIFT:
        warnings.warn(
            f"the illuminance changed by {drift:.0%} during the bracket"
            f" ({before:g} to {after:g} lux); less than {_DRIFT:.0%} expected",
            ClerestoryWarning,
            stacklevel=2,
        )
    factor = measured / found
    return Calibration(scale(picture, factor), factor, measured, drift)


def overflow(picture: Picture, illuminance: float) -> float:
    """Fraction of the measured illuminance that is missing in a calibrated picture.

    The picture must not be calibrated by `illuminance` [lux] itself, but for example by
    a luminance meter. A large fraction indicates that the sun, or a reflection of the
    sun, is clipped; more than a fifth gives a warning.
    """
    positive(illuminance, "measured illuminance", unit="lux")
    held = eye_illuminance(picture)
    missing = 1 - held / illuminance
    if held < _COMPLETE * illuminance:
        warnings.warn(
            f"the picture yields {held:.0f} of {illuminance:g} lux measured; its"
            f" brightest pixels, of {float(picture.luminance().max()):.3g} cd/m², are"
            " probably clipped",
            ClerestoryWarning,
            stacklevel=2,
        )
    return missing


def replace_overflow(
    picture: Picture, illuminance: float, *, brightest: float
) -> Picture:
    """Raise clipped pixels until the picture yields the measured illuminance [lux].

    All pixels of the luminance `brightest` [cd/m²] or more are set to one common
    luminance. The result has the correct illuminance but not the correct luminance
    distribution; use it only if a shorter exposure is not available.
    """
    held = eye_illuminance(picture)
    luminance = picture.luminance()
    clipped = luminance >= brightest
    require(
        clipped.any(),
        f"no pixel of {brightest:g} cd/m² or more; the brightest has"
        f" {float(luminance.max()):g} cd/m²",
    )
    weight = _projected_solid_angles(picture)[clipped]
    now = float((weight * luminance[clipped]).sum())
    level = (illuminance - held + now) / float(weight.sum())
    require(
        level > float(luminance[clipped].min()),
        f"the picture already yields {held:.0f} lux; less than the measured"
        f" {illuminance:g} lux expected",
    )
    radiance = picture.radiance.copy()
    radiance[clipped] *= (level / luminance[clipped])[:, None].astype(np.float32)
    return replace(picture, radiance=radiance)
