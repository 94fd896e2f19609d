"""Photometric calibration of pictures by the illuminance measured at the camera."""

import warnings
from typing import NamedTuple

import numpy as np

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.image.arithmetic import scale
from clerestory.image.picture import Picture
from clerestory.scene.view import solid_angles

# Change of the illuminance during a bracket that causes a warning
_DRIFT = 0.10

# Share of the measured illuminance that a picture must reach not to be clipped
_COMPLETE = 0.80


class Calibration(NamedTuple):
    """A calibrated picture and how it came about.

    Attributes
    ----------
    picture : in true radiances
    factor : by which it was scaled
    illuminance : on the camera, as measured [lux]
    drift : change of the illuminance during the bracket over its mean
    """

    picture: Picture
    factor: float
    illuminance: float
    drift: float


def eye_illuminance(picture: Picture) -> float:
    """Illuminance on the plane across the line of sight by all that it faces [lux].

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
        raise InputError("a picture without a view; one of a hemisphere expected")
    size = picture.columns, picture.rows
    cosine = np.maximum(view.rays(*size).direction @ view.direction, 0)
    return float((picture.luminance() * solid_angles(view, *size) * cosine).sum())


def calibrate(picture: Picture, *, before: float, after: float) -> Calibration:
    """Return the picture scaled to give the measured illuminance.

    Parameters
    ----------
    picture : of a whole hemisphere, without vignetting
    before, after : illuminance beside the lens, before and after the bracket [lux]

    Raises
    ------
    InputError : illuminances that are not positive, a black picture

    Warns
    -----
    ClerestoryWarning : the light changed by more than a tenth during the bracket
    """
    for value in (before, after):
        if not 0 < value < np.inf:
            raise InputError(f"measured illuminance {value:g} lux; above 0 expected")
    found = eye_illuminance(picture)
    if not found > 0:
        raise InputError("a black picture; one of a lit scene expected")
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
    """Share of the measured illuminance that a calibrated picture does not hold.

    The picture must have been calibrated by other means than this illuminance, such as
    a luminance meter. A large share means that the sun, or its mirror image, is
    clipped.

    Parameters
    ----------
    illuminance : measured on the camera [lux]

    Raises
    ------
    InputError : an illuminance that is not positive

    Warns
    -----
    ClerestoryWarning : a fifth or more of the light is missing
    """
    if not 0 < illuminance < np.inf:
        raise InputError(f"measured illuminance {illuminance:g} lux; above 0 expected")
    held = eye_illuminance(picture)
    missing = 1 - held / illuminance
    if held < _COMPLETE * illuminance:
        warnings.warn(
            f"the picture holds {held:.0f} of {illuminance:g} lux measured: its"
            f" brightest pixels, of {float(picture.luminance().max()):.3g} cd/m², are"
            " clipped",
            ClerestoryWarning,
            stacklevel=2,
        )
    return missing


def replace_overflow(
    picture: Picture, illuminance: float, *, brightest: float
) -> Picture:
    """Return the picture with clipped pixels raised to give the measured illuminance.

    All pixels from a luminance up get one common luminance. A remedy for want of a
    shorter exposure: the sum is right, not how it is spread.

    Parameters
    ----------
    illuminance : measured on the camera [lux]
    brightest : luminance from which pixels count as clipped [cd/m²]

    Raises
    ------
    InputError : no pixel is that bright, or the picture holds all the light already
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
            f"the picture holds {held:.0f} of {illuminance:g} lux measured; less"
            " expected"
        )
    radiance = picture.radiance.copy()
    radiance[clipped] *= (level / luminance[clipped])[:, None].astype(np.float32)
    return Picture(
        radiance, view, picture.header, picture.pixel_aspect, picture.quantity
    )
