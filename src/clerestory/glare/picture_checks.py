"""Quality checks of pictures: projection, clipping, photometric scale."""

import numpy as np

from clerestory.checks import require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.image.denoise import is_denoised
from clerestory.image.picture import Picture
from clerestory.scene.view import View

# Criteria of a fisheye picture (evalglare): largest luminance of black pixels [cd/m²],
# and smallest fraction of black pixels in the corners
_BLACK, _BLACK_CORNERS = 7.0, 0.70

# Largest relative deviation of the aspect ratio of a picture
_ASPECT = 0.02

# Largest radiance for which sums do not overflow [W/(m²·sr)]; the sun has 10⁷
_LARGEST = 1e30

# Criteria of a photograph without photometric scale: smallest fraction of clipped
# pixels, and largest deviation of their radiance from 1
_CLIPPED, _WHITE = 1e-3, 5e-3


def check_photometry(picture: Picture, view: View, *, trust: bool) -> None:
    """Raise `InputError` for a picture that cannot be evaluated.

    With `trust`, projection, photometric scale and denoising are not checked.
    """
    require(
        picture.quantity == "radiance",
        f"a picture of {picture.quantity}; a picture of radiance expected",
    )
    lowest, highest = float(picture.radiance.min()), float(picture.radiance.max())
    for value, valid in ((lowest, lowest >= 0), (highest, highest <= _LARGEST)):
        if not valid:
            row, column = np.argwhere(picture.radiance == value)[0][:2]
            raise InputError(
                f"the pixel in row {row}, column {column} has the radiance {value:g}; 0"
                f" to {_LARGEST:g} W/(m²·sr) expected (the sun has 1e7)"
            )
    if trust:
        return
    require(
        not is_denoised(picture),
        "the picture is denoised, so its luminance errors are unknown; the picture"
        " before denoising expected",
    )
    _check_shape(picture, view)
    luminance = picture.luminance()
    _check_corners(luminance, view)
    _check_scale(luminance)


def _check_shape(picture: Picture, view: View) -> None:
    require(
        abs(picture.pixel_aspect - 1) <= _ASPECT,
        f"pixels are {picture.pixel_aspect:g} times as high as wide; square pixels"
        " expected",
    )
    expected = view.aspect() * picture.columns
    require(
        abs(picture.rows / expected - 1) <= max(_ASPECT, 1.5 / expected),
        f"{picture.columns} × {picture.rows} pixels for the {view.kind} view of"
        f" {view.horizontal:g}° × {view.vertical:g}°; {expected:.0f} rows or another"
        " view expected",
    )


def _check_corners(luminance: np.ndarray, view: View) -> None:
    # A fisheye picture is black outside of the image circle
    if view.kind != "perspective":
        return
    rows, columns = luminance.shape
    row, column = np.ogrid[:rows, :columns]
    apart = np.hypot(row - rows // 2, column - columns // 2)
    corners = luminance[apart > (rows // 2 + columns // 2) / 2]
    if corners.size and (corners < _BLACK).mean() > _BLACK_CORNERS:
        raise InputError(
            f"{(corners < _BLACK).mean():.0%} of the corners are black: a fisheye"
            " picture with a perspective view; -vta or -vth expected"
        )


def _check_scale(luminance: np.ndarray) -> None:
    # In a photograph without photometric scale, clipped pixels have a radiance of 1
    top = float(luminance.max())
    clipped = float((luminance >= top * (1 - 1e-6)).mean())
    white = abs(top / LUMINOUS_EFFICACY - 1) < _WHITE
    require(
        not (white and _CLIPPED < clipped < 1 - _CLIPPED),
        f"{clipped:.1%} of the pixels have the largest value of {top:.4g} cd/m²: a"
        " clipped photograph without luminance calibration; a calibrated one expected",
    )
