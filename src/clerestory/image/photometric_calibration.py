"""Photometric calibration of pictures by the illuminance measured at the camera."""

import warnings
from typing import NamedTuple

import numpy as np

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.image.arithmetic import scale
from clerestory.image.picture import Picture
from clerestory.scene.view import solid_angles

# Relative change of illuminance during a bracket that causes a warning
_DRIFT = 0.10

# Fraction of the measured illuminance below which a picture is considered clipped
_COMPLETE = 0.80


class Calibration(NamedTuple):
    """A calibrated picture and its calibration factor.

    Attributes
    ----------
    picture : picture in absolute radiance
    factor : factor by which the picture was scaled
    illuminance : mean of the measured illuminances at the camera [lux]
    drift : relative change of the illuminance during the bracket
    """

    picture: Picture
    factor: float
    illuminance: float
    drift: float


def eye_illuminance(picture: Picture) -> float:
    """Illuminance on the plane perpendicular to the view direction [lux].

    Raises
    ------
    InputError : the picture has no view

    Examples
    --------
    >>> from clerestory.scene.view import View
    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> flat = Picture(np.full((90, 90, 3), 1 / 179, np.float32), view=eye)
    >>> round(eye_illuminance(flat), 2)
    3.14
    """
    view = picture.view
    if view is None:
        raise InputError("picture without a view; a hemispherical view expected")
    size = picture.columns, picture.rows
    cosine = np.maximum(view.rays(*size).direction @ view.direction, 0)
    return float((picture.luminance() * solid_angles(view, *size) * cosine).sum())


def calibrate(picture: Picture, *, before: float, after: float) -> Calibration:
    """Return the picture scaled to the measured illuminance.

    Parameters
    ----------
    picture : picture of a whole hemisphere, corrected for vignetting
    before, after : illuminance measured at the lens before and after the bracket [lux]

    Raises
    ------
    InputError : an illuminance is not positive, or the picture is black

    Warns
    -----
    ClerestoryWarning : the illuminance changed by more than 10 % during the bracket
    """
    for value in (before, after):
        if not 0 < value < np.inf:
            raise InputError(f"measured illuminance {value:g} lux; above 0 expected")
    found = eye_illuminance(picture)
    if not found > 0:
        raise InputError("black picture; a picture of a lit scene expected")
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

    The picture must have been calibrated independently of this illuminance, such as by
    a luminance meter. A large fraction indicates that the sun, or its mirror image, is
    clipped.

    Parameters
    ----------
    illuminance : illuminance measured at the camera [lux]

    Raises
    ------
    InputError : the illuminance is not positive

    Warns
    -----
    ClerestoryWarning : more than a fifth of the illuminance is missing
    """
    if not 0 < illuminance < np.inf:
        raise InputError(f"measured illuminance {illuminance:g} lux; above 0 expected")
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
    """Return the picture with clipped pixels raised to the measured illuminance.

    All pixels at or above a given luminance are set to one common luminance. The result
    has the correct illuminance but not the correct luminance distribution; use it only
    if a shorter exposure is not available.

    Parameters
    ----------
    illuminance : illuminance measured at the camera [lux]
    brightest : luminance from which pixels are considered clipped [cd/m²]

    Raises
    ------
    InputError : no pixel is that bright, or the illuminance already matches
    """
    view = picture.view
    held = eye_illuminance(picture)
    luminance = picture.luminance()
    clipped = luminance >= brightest
    if view is None or not clipped.any():
        raise InputError(
            f"no pixel of {brightest:g} cd/m² or more; the brightest has"
            f" {float(luminance.max()):g} cd/m²"
        )
    size = picture.columns, picture.rows
    cosine = np.maximum(view.rays(*size).direction @ view.direction, 0)
    weight = (solid_angles(view, *size) * cosine)[clipped]
    now = float((weight * luminance[clipped]).sum())
    level = (illuminance - held + now) / float(weight.sum())
    if not level > float(luminance[clipped].min()):
        raise InputError(
            f"the picture yields {held:.0f} of {illuminance:g} lux measured; less"
            " expected"
        )
    radiance = picture.radiance.copy()
    radiance[clipped] *= (level / luminance[clipped])[:, None].astype(np.float32)
    return Picture(
        radiance, view, picture.header, picture.pixel_aspect, picture.quantity
    )
