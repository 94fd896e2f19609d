"""Global tone mapping: linear, and the response curve of a film.

The result is display-referred: red, green and blue, linear, 0 black and 1 white. See
`visibility_matching` for the mapping that preserves visibility.
"""

import numpy as np
from jaxtyping import Float32

from clerestory.errors import InputError
from clerestory.image.picture import Picture, photometric

Display = Float32[np.ndarray, "row column 3"]

# Reflectance of the card that photographers expose for, and that the log average
# luminance is shown as: Reinhard et al., "Photographic tone reproduction for digital
# images", ACM Trans. Graphics 21 (2002), eq. 2
_KEY = 0.18

# Hable, "Uncharted 2: HDR lighting", Game Developers Conference 2010: shoulder, linear
# strength and angle, toe strength, numerator and denominator, and linear white
_A, _B, _C, _D, _E, _F, _WHITE = 0.15, 0.50, 0.10, 0.20, 0.02, 0.30, 11.2

# His exposure before the curve
_BIAS = 2.0


def key_luminance(picture: Picture) -> float:
    """Luminance that an automatic exposure shows as white [cd/m²].

    The logarithmic average of what is not black becomes middle grey, 18 %.

    >>> grey = Picture(np.full((1, 1, 3), 1 / 179, dtype=np.float32))
    >>> round(key_luminance(grey), 3)
    5.556
    """
    values = photometric(picture)
    lit = values[values > values.max(initial=0) * 1e-6].astype(float)
    return float(np.exp(np.log(lit).mean()) / _KEY) if lit.size else 1.0


def linear(picture: Picture, *, white: float | None = None) -> Display:
    """Display values proportional to radiance.

    Parameters
    ----------
    picture : what to show
    white : luminance shown as white [cd/m²], or illuminance [lux]; brighter is cut.
        Automatic if not given: `key_luminance`
    """
    return _exposed(picture, white)


def filmic(picture: Picture, *, white: float | None = None) -> Display:
    """Display values along the curve of a film: soft in shadows and highlights.

    Parameters
    ----------
    picture : what to show
    white : luminance that a linear mapping would show as white [cd/m²]; some five
        times as much is white on the curve. Automatic if not given: `key_luminance`

    References
    ----------
    J. Hable, "Uncharted 2: HDR lighting", Game Developers Conference 2010
    """
    shown: np.ndarray = _curve(_BIAS * np.maximum(_exposed(picture, white), 0)) / (
        _curve(np.array(_WHITE))
    )
    return shown.astype(np.float32)


def _curve(x: np.ndarray) -> np.ndarray:
    # Values far beyond white are all white; squares must stay finite
    x = np.minimum(x, 1e4)
    top = x * (_A * x + _C * _B) + _D * _E
    shown: np.ndarray = top / (x * (_A * x + _B) + _D * _F) - _E / _F
    return shown


def _exposed(picture: Picture, white: float | None) -> Display:
    if white is not None and not 0 < white < np.inf:
        raise InputError(f"white at {white:g} cd/m²; a positive luminance expected")
    level = key_luminance(picture) if white is None else white
    # The luminance of radiance 1 W/(m²·sr) in each channel is the picture's own
    one = photometric(Picture(np.ones((1, 1, 3), dtype=np.float32)))[0, 0]
    return picture.rgb * np.float32(one / level)
