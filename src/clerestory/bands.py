"""Spectral bands: the parts of the spectrum in which light is computed.

Radiance's red, green and blue are one set of bands. Arrays of light have an axis of
channels, one for each band; a single channel stands for all bands alike, as in a room
of grey materials. A value of one in every band is white light of 179 lm/W.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError, MatrixError


@final
@dataclass(frozen=True)
class Bands:
    """A set of spectral bands.

    Attributes
    ----------
    names : of the bands, all different
    efficacy : luminance [cd/m²] per radiance [W/(m²·sr)] in each band [lm/W]; None if
        it is not known
    limits_nm : shortest and longest wavelength of each band [nm]; None where the bands
        are no intervals, such as RGB

    Raises
    ------
    InputError : no band, a name that occurs twice, a negative efficacy, limits that do
        not grow, or another number of any of them

    Examples
    --------
    >>> round(float(RGB.photometric(np.array([1.0, 1.0, 1.0]))), 6)
    179.0
    """

    names: tuple[str, ...]
    efficacy: tuple[float, ...] | None = None
    limits_nm: tuple[tuple[float, float], ...] | None = None

    def __post_init__(self) -> None:
        if not self.names or len(set(self.names)) < len(self.names):
            raise InputError(f"bands named {self.names}; different names expected")
        for what, given in (("efficacies", self.efficacy), ("limits", self.limits_nm)):
            if given is not None and len(given) != len(self.names):
                raise InputError(
                    f"{len(given)} {what} of {len(self)} bands; one per band expected"
                )
        efficacy = np.array(self.efficacy or (1.0,))
        if not (np.all(efficacy >= 0) and 0 < efficacy.sum() < np.inf):
            raise InputError(
                f"luminous efficacies {self.efficacy}; numbers from 0, not all zero,"
                " expected"
            )
        for shortest, longest in self.limits_nm or ():
            if not 0 < shortest < longest < np.inf:
                raise InputError(
                    f"a band from {shortest:g} to {longest:g} nm; limits that grow"
                    " expected"
                )

    def __len__(self) -> int:
        return len(self.names)

    def __str__(self) -> str:
        return ", ".join(self.names)

    @property
    def weights(self) -> Float[np.ndarray, " band"]:
        """Luminous efficacy of each band [lm/W].

        Raises
        ------
        InputError : it is not known
        """
        if self.efficacy is None:
            raise InputError(
                f"the luminous efficacy of the bands {self} is not known; bands with"
                " photometric weights expected"
            )
        return np.array(self.efficacy)

    @property
    def shares(self) -> Float[np.ndarray, " band"]:
        """Share of each band in the luminance of white light; their sum is one."""
        return np.asarray(self.weights / self.weights.sum())

    def photometric(
        self, values: Float[np.ndarray, "*batch"], *, axis: int = -1
    ) -> Float[np.ndarray, "..."]:
        """Luminance [cd/m²] of radiance, or illuminance [lux] of irradiance.

        Parameters
        ----------
        values : radiance [W/(m²·sr)] or irradiance [W/m²]
        axis : of the channels, one per band, or one that stands for all of them
        """
        return weighted_sum(values, self.weights, axis=axis)


def weighted_sum(
    values: Float[np.ndarray, "*batch"],
    weights: Float[np.ndarray, " band"],
    *,
    axis: int = -1,
) -> Float[np.ndarray, "..."]:
    """Sum of the channels under weights; a single channel stands for all bands.

    >>> weighted_sum(np.array([[1.0, 2.0]]), np.array([0.5, 0.25, 0.25]), axis=0)
    array([1., 2.])
    """
    axis %= values.ndim
    before, after = values.shape[:axis], values.shape[axis + 1 :]
    factor = weights.astype(values.dtype)
    if values.shape[axis] == 1:
        factor = factor.sum(keepdims=True)
    if not after:
        return np.asarray(values @ factor)
    table = values.reshape(*before, values.shape[axis], math.prod(after))
    return np.asarray((factor @ table).reshape(*before, *after))


def unnamed_bands(count: int) -> Bands:
    """Return the bands of a file that does not say which they are.

    Three are Radiance's red, green and blue; one stands for all three.
    """
    if count in (1, len(RGB)):
        return RGB
    return Bands(tuple(f"band {k + 1}" for k in range(count)))


def common_bands(parts: Iterable[tuple[Bands, int]]) -> Bands:
    """Return the bands of a product or sum, from the bands and channels of its parts.

    A part of one channel has the same value in all bands, and fits any others. Where
    all parts have one channel, the bands are those of the last one.

    Raises
    ------
    MatrixError : two parts have channels of different bands
    """
    pairs = list(parts)
    several = [bands for bands, channels in pairs if channels > 1]
    for bands in several[1:]:
        if bands != several[0]:
            raise MatrixError(
                f"one part is in the bands {several[0]}, another in {bands};"
                " the same bands expected"
            )
    return several[0] if several else pairs[-1][0]


# Red, green and blue of Radiance's primaries (color.h: CIE_rf, CIE_gf, CIE_bf).
RGB = Bands(
    ("red", "green", "blue"),
    tuple(LUMINOUS_EFFICACY * share for share in (0.265, 0.670, 0.065)),
)

# Visible light as a whole.
GREY = Bands(("visible",), (LUMINOUS_EFFICACY,))
