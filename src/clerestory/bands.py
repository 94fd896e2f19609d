"""Spectral bands in which radiance is computed, such as Radiance's RGB.

Arrays have a channel axis with one channel per band, or a single channel that applies
to all bands, as in a scene of grey materials. White light has the same radiance in
every band and a luminous efficacy of 179 lm/W.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.brief_repr import brief
from clerestory.checks import require, same_length
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError, MatrixError


@final
@checked_fields
@dataclass(frozen=True)
class Bands:
    """A set of spectral bands.

    Attributes
    ----------
    names : unique names of the bands
    efficacy : luminous efficacy of each band: luminance [cd/m²] per radiance
        [W/(m²·sr)], in lm/W; None if unknown
    limits_nm : shortest and longest wavelength of each band [nm]; None for bands that
        are not wavelength intervals, such as RGB
    weightings : name of the weighting function of each band, such as "melanopic", see
        `clerestory.spectral.band_sets`; None for wavelength intervals and RGB

    Examples
    --------
    >>> round(float(RGB.photometric(np.array([1.0, 1.0, 1.0]))), 6)
    179.0
    """

    names: tuple[str, ...]
    efficacy: tuple[float, ...] | None = None
    limits_nm: tuple[tuple[float, float], ...] | None = None
    weightings: tuple[str, ...] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        distinct = len(set(self.names)) == len(self.names) > 0
        message = f"band names are {self.names}; one or more different names expected"
        require(distinct, message)
        for what, given in (
            ("efficacies", self.efficacy),
            ("limits", self.limits_nm),
            ("weighting functions", self.weightings),
        ):
            same_length(self.names if given is None else given, self, what, "bands")
        efficacy = np.array(self.efficacy or (1.0,))
        require(
            np.all(efficacy >= 0) and 0 < efficacy.sum() < np.inf,
            f"luminous efficacies are {self.efficacy}; numbers of 0 or more, not all"
            " zero, expected",
        )
        for shortest, longest in self.limits_nm or ():
            require(
                0 < shortest < longest < np.inf,
                f"a band is from {shortest:g} to {longest:g} nm; increasing limits"
                " expected",
            )

    def __len__(self) -> int:
        return len(self.names)

    def __str__(self) -> str:
        return ", ".join(self.names)

    def __getitem__(self, chosen: slice) -> "Bands":
        """Return consecutive bands."""
        return Bands(
            self.names[chosen],
            self.efficacy and self.efficacy[chosen],
            self.limits_nm and self.limits_nm[chosen],
            self.weightings and self.weightings[chosen],
        )

    @property
    def weights(self) -> Float[np.ndarray, " band"]:
        """Luminous efficacy of each band [lm/W]."""
        if self.efficacy is None:
            raise InputError(
                f"the luminous efficacy of the bands {self} is unknown; bands with"
                " known luminous efficacy expected"
            )
        return np.array(self.efficacy)

    @property
    def shares(self) -> Float[np.ndarray, " band"]:
        """Fraction of the luminance of white light in each band; the sum is one."""
        return np.asarray(self.weights / self.weights.sum())

    def photometric(
        self, values: Float[np.ndarray, "*batch"], *, axis: int = -1
    ) -> Float[np.ndarray, "..."]:
        """Convert radiance to luminance [cd/m²], or irradiance to illuminance [lux]."""
        return weighted_sum(values, self.weights, axis=axis)


def weighted_sum(
    values: Float[np.ndarray, "*batch"],
    weights: Float[np.ndarray, " band"],
    *,
    axis: int = -1,
) -> Float[np.ndarray, "..."]:
    """Sum of the channels, weighted by band; a single channel applies to every band.

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
    """Return the bands of a file without band names, from the number of channels.

    One channel (grey) or three channels are taken as Radiance's RGB.
    """
    if count in (1, len(RGB)):
        return RGB
    return Bands(tuple(f"band {k + 1}" for k in range(count)))


def common_bands(parts: Iterable[tuple[Bands, int]]) -> Bands:
    """Return the common bands of the operands of a product or sum.

    Each operand is given by its bands and its number of channels. An operand with one
    channel is compatible with any bands. If all operands have one channel, the bands of
    the last operand are returned.
    """
    pairs = list(parts)
    several = [bands for bands, channels in pairs if channels > 1]
    for bands in several[1:]:
        require(
            bands == several[0],
            f"one operand has the bands {several[0]}, another has {bands}; the same"
            " bands expected",
            error=MatrixError,
        )
    return several[0] if several else pairs[-1][0]


# Radiance's RGB with its luminance weights (color.h: CIE_rf, CIE_gf, CIE_bf)
RGB = Bands(
    ("red", "green", "blue"),
    tuple(LUMINOUS_EFFICACY * share for share in (0.265, 0.670, 0.065)),
)

# A single band of visible light
GREY = Bands(("visible",), (LUMINOUS_EFFICACY,))
