"""Vignetting of a lens as a function of the angle from its axis, and its correction."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from clerestory.checks import positive, require
from clerestory.errors import InputError
from clerestory.image.picture import Picture

# Smallest relative transmission that can be corrected
_LEAST = 0.02


@dataclass(frozen=True)
class Vignetting:
    """Relative transmission of a lens as a function of the angle θ from its axis.

    Attributes
    ----------
    coefficients : coefficients c₁, c₂, … [1/rad², …] of 1 + c₁ θ² + c₂ θ⁴ + …
    """

    coefficients: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        lowest = float(self.passed(np.linspace(0, np.pi / 2, 91)).min())
        require(
            lowest >= _LEAST,
            f"the vignetting falls to a relative transmission of {lowest:.3f}; {_LEAST}"
            " or more expected up to 90°",
        )

    def passed(self, theta: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """Relative transmission at angles from the axis [rad]."""
        square = np.asarray(theta, dtype=float) ** 2
        return np.asarray(np.polyval([*self.coefficients[::-1], 1.0], square))


def fit_vignetting(
    theta: Float[np.ndarray, " angle"],
    luminance: Float[np.ndarray, " angle"],
    *,
    terms: int = 3,
) -> Vignetting:
    """Fit the vignetting of a lens to photographs of a target of constant luminance.

    `theta` are the angles between target and lens axis [rad], `luminance` is the
    luminance of the target in each photograph, up to a factor, and `terms` is the
    number of even powers of θ.
    """
    least = terms + 2
    require(theta.size >= least, f"{theta.size} angles; {least} or more expected")
    positive(luminance, "luminance of the target")
    powers = theta[:, None] ** (2 * np.arange(terms + 1))
    fitted, *_ = np.linalg.lstsq(powers / luminance[:, None], np.ones(theta.size))
    return Vignetting(tuple((fitted[1:] / fitted[0]).tolist()))


def correct_vignetting(picture: Picture, vignetting: Vignetting) -> Picture:
    """Return a picture divided by the relative transmission of the lens."""
    if picture.view is None:
        raise InputError("picture without a view; a reprojected picture expected")
    rays = picture.view.rays(picture.columns, picture.rows)
    theta = np.arccos(np.clip(rays.direction @ picture.view.direction, -1, 1))
    passed = np.where(theta <= np.pi / 2, vignetting.passed(theta), 1.0)
    radiance = picture.radiance / passed[..., None].astype(np.float32)
    return replace(picture, radiance=radiance)
