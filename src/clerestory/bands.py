"""Spectral bands: the parts of the spectrum in which light is computed.

Radiance's red, green and blue are one set of bands. Arrays have a channel axis with one
channel per band, or a single channel whose values apply to every band, as in a room of
grey materials. A value of one in every band is white light of 179 lm/W.
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
    names : unique names of the bands
    efficacy : luminance [cd/m²] per radiance [W/(m²·sr)] in each band [lm/W]; None if
        unknown
    limits_nm : shortest and longest wavelength of each band [nm]; None if the bands are
        not wavelength intervals, such as RGB

    Raises
    ------
    InputError : no band, a repeated name, a negative efficacy, limits that do not
        increase, or efficacies or limits that are not one per band

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
            raise InputError(f"band names {self.names} repeat; unique names expected")
        for what, given in (("efficacies", self.efficacy), ("limits", self.limits_nm)):
            if given is not None and len(given) != len(self.names):
                raise InputError(
                    f"{len(given)} {what} for {len(self)} bands; one per band expected"
                )
        efficacy = np.array(self.efficacy or (1.0,))
        if not (np.all(efficacy >= 0) and 0 < efficacy.sum() < np.inf):
            raise InputError(
                f"luminous efficacies {self.efficacy}; numbers of 0 or more, not all"
                " zero, expected"
            )
        for shortest, longest in self.limits_nm or ():
            if not 0 < shortest < longest < np.inf:
                raise InputError(
                    f"a band from {shortest:g} to {longest:g} nm; increasing limits"
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
        InputError : the luminous efficacy is unknown
        """
        if self.efficacy is None:
            raise InputError(
                f"the luminous efficacy of the bands {self} is unknown; bands with"
                " photometric weights expected"
            )
        return np.array(self.efficacy)

    @property
    def shares(self) -> Float[np.ndarray, " band"]:
        """Fraction of the luminance of white light in each band; the sum is one."""
        return np.asarray(self.weights / self.weights.sum())

    def photometric(
        self, values: Float[np.ndarray, "*batch"], *, axis: int = -1
    ) -> Float[np.ndarray, "..."]:
        """Luminance [cd/m²] of radiance, or illuminance [lux] of irradiance.

        Parameters
        ----------
        values : radiance [W/(m²·sr)] or irradiance [W/m²]
        axis : index of the channel axis (one channel per band, or one for all bands)
        """
        return weighted_sum(values, self.weights, axis=axis)


def weighted_sum(
    values: Float[np.ndarray, "*batch"],
    weights: Float[np.ndarray, " band"],
    *,
    axis: int = -1,
) -> Float[np.ndarray, "..."]:
    """Weighted sum of the channels; a single channel applies to every band.

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
    """Return the bands of a file that does not name them.

    Three bands are Radiance's red, green and blue; a single one applies to all three.
    """
    if count in (1, len(RGB)):
        return RGB
    return Bands(tuple(f"band {k + 1}" for k in range(count)))


def common_bands(parts: Iterable[tuple[Bands, int]]) -> Bands:
    """Return the bands of a product or sum, from the bands and channels of its parts.

    A part with one channel has the same value in every band and is compatible with any
    bands. If all parts have one channel, the bands of the last part are returned.

    Raises
    ------
    MatrixError : two parts with several channels have different bands
    """
    pairs = list(parts)
    several = [bands for bands, channels in pairs if channels > 1]
    for bands in several[1:]:
        if bands != several[0]:
            raise MatrixError(
                f"one operand has the bands {several[0]}, another has {bands};"
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
