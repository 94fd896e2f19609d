"""Pictures of radiance or irradiance, with their view.

Row 0 is at the top. Pixel values are absolute: readers divide by the exposures and
colour corrections in a file.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float32

from clerestory.argument_types import checked_fields
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.checks import one_of, positive, require
from clerestory.colorimetry import rgb_from_xyz
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.scene.view import View
from clerestory.spectral.colour_temperature import tristimulus
from clerestory.spectral.functions import integral, spectral_function

Quantity = Literal["radiance", "irradiance"]


# Largest value of a pixel; larger ones overflow when multiplied
_LARGEST = 1e15


@checked_fields
@dataclass(frozen=True, eq=False)
class Picture:
    """Radiance or irradiance of every pixel of a view.

    Attributes
    ----------
    radiance : radiance per band [W/(m²·sr)]; in an irradiance picture (as by rpict -i),
        irradiance of the visible surface [W/m²]
    view : view of the picture, if known
    header : other header lines of the file, such as commands and notes
    pixel_aspect : ratio of height to width of a pixel
    quantity : "radiance" or "irradiance"
    bands : spectral bands of the channels; picture files contain the RGB of `rgb`

    Raises
    ------
    InputError : wrong shape, a pixel that is not finite, or a pixel aspect ≤ 0

    Examples
    --------
    >>> grey = Picture(np.ones((2, 3, 3), dtype=np.float32))
    >>> grey.rows, grey.columns, round(float(grey.luminance()[0, 0]), 3)
    (2, 3, 179.0)
    """

    radiance: Float32[np.ndarray, "row column band"]
    view: View | None = None
    header: tuple[str, ...] = ()
    pixel_aspect: float = 1.0
    quantity: Quantity = "radiance"
    bands: Bands = RGB

    __repr__ = brief

    def __post_init__(self) -> None:
        values = np.asarray(self.radiance, dtype=np.float32)
        bands = len(self.bands)
        require(
            values.ndim == 3 and values.shape[2] == bands and values.size > 0,
            f"pixels of shape {values.shape}; (rows, columns, {bands}) expected",
        )
        if not np.isfinite([values.min(), values.max()]).all():
            row, column, _ = np.argwhere(~np.isfinite(values))[0]
            raise InputError(
                f"the pixel in row {row}, column {column} is not finite;"
                " finite numbers expected"
            )
        positive(self.pixel_aspect, "pixel aspect")
        one_of(self.quantity, "quantity of a picture", choices=get_args(Quantity))
        object.__setattr__(self, "radiance", values)

    @property
    def rows(self) -> int:
        """Number of pixel rows."""
        return int(self.radiance.shape[0])

    @property
    def columns(self) -> int:
        """Number of pixel columns."""
        return int(self.radiance.shape[1])

    @property
    def rgb(self) -> Float32[np.ndarray, "row column 3"]:
        """Pixel values in Radiance's red, green and blue.

        Light in wavelength intervals is converted by the CIE 1931 observer; colours
        outside the gamut are desaturated. Light in weighting functions is grey.
        """
        bands = self.bands
        if bands == RGB:
            return self.radiance
        if bands.limits_nm is None:
            require(bands.weightings, f"picture in the bands {bands}; {RGB} expected")
            level = photometric(self)[..., None] / LUMINOUS_EFFICACY
            return np.repeat(level, 3, axis=-1).astype(np.float32)
        xyz = tristimulus(np.moveaxis(self.radiance, -1, 0), bands)
        white = float(integral(spectral_function("y")))
        return np.moveaxis(rgb_from_xyz(xyz / white), 0, -1).astype(np.float32)

    def luminance(self) -> Float32[np.ndarray, "row column"]:
        """Luminance of every pixel [cd/m²]."""
        require(
            self.quantity == "radiance",
            "an irradiance picture has no luminance; use illuminance",
        )
        return photometric(self)

    def illuminance(self) -> Float32[np.ndarray, "row column"]:
        """Illuminance of the surface visible in every pixel [lux]."""
        require(
            self.quantity == "irradiance",
            "a radiance picture has no illuminance; use luminance",
        )
        return photometric(self)


def photometric(picture: Picture) -> Float32[np.ndarray, "row column"]:
    """Luminance [cd/m²] or illuminance [lux] of every pixel."""
    values = picture.radiance
    if max(values.max(), -values.min()) > _LARGEST:
        row, column, _ = np.argwhere(np.abs(values) > _LARGEST)[0]
        raise InputError(
            f"the pixel in row {row}, column {column} exceeds {_LARGEST:.0e};"
            " smaller numbers expected"
        )
    return picture.bands.photometric(values)


def photometric_unit(picture: Picture) -> str:
    """Return the unit of `photometric`: cd/m² or lux."""
    return "cd/m²" if picture.quantity == "radiance" else "lux"


def same_size(pixels: np.ndarray, like: np.ndarray, what: str) -> None:
    """Require that `pixels` and `like` have equal numbers of rows and columns."""
    (rows, columns), size = pixels.shape[:2], like.shape[:2]
    require(
        (rows, columns) == size,
        f"{what} has {columns} × {rows} pixels; {size[1]} × {size[0]} expected",
    )
