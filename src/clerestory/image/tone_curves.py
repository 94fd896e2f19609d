"""Global tone mapping, linear or by a film response curve.

Results are display-referred: linear red, green and blue from 0 (black) to 1 (white).
The module `visibility_matching` contains the tone mapping that preserves visibility.
"""

import numpy as np
from jaxtyping import Float32

from clerestory.checks import positive
from clerestory.image.picture import Picture, photometric

Display = Float32[np.ndarray, "row column 3"]

# Display value of the log-average luminance, the reflectance of a grey card: Reinhard
# et al., "Photographic tone reproduction for digital images", ACM Trans. Graphics 21
# (2002), eq. 2
_KEY = 0.18

# Hable, "Uncharted 2: HDR lighting", Game Developers Conf. 2010: shoulder strength;
# linear strength and angle; toe strength, numerator and denominator; linear white
_A, _B, _C, _D, _E, _F, _WHITE = 0.15, 0.50, 0.10, 0.20, 0.02, 0.30, 11.2

# Factor applied before the film response curve, as in Hable
_BIAS = 2.0


def key_luminance(picture: Picture) -> float:
    """Luminance that automatic exposure maps to white [cd/m²].

    The geometric mean of all pixels that are not black is mapped to 18 % grey.

    >>> grey = Picture(np.full((1, 1, 3), 1 / 179, dtype=np.float32))
    >>> round(key_luminance(grey), 3)
    5.556
    """
    values = photometric(picture)
    lit = values[values > values.max(initial=0) * 1e-6].astype(float)
    return float(np.exp(np.log(lit).mean()) / _KEY) if lit.size else 1.0


def linear(picture: Picture, *, white: float | None = None) -> Display:
    """Display values proportional to radiance.

    `white` is the luminance [cd/m²] or illuminance [lux] shown as 1; the default is
    `key_luminance`.
    """
    level = key_luminance(picture) if white is None else white
    positive(level, "luminance of white", unit="cd/m²")
    # Luminance of the radiance 1 W/(m²·sr) in each channel
    one = photometric(Picture(np.ones((1, 1, 3), dtype=np.float32)))[0, 0]
    return picture.rgb * np.float32(one / level)


def filmic(picture: Picture, *, white: float | None = None) -> Display:
    """Display values by a film response curve, with compressed shadows and highlights.

    `white` is the luminance that a linear mapping would show as white [cd/m²]; the
    curve reaches white at about five times this value. The default is `key_luminance`.
    """
    exposed = _BIAS * np.maximum(linear(picture, white=white), 0)
    return np.asarray(_curve(exposed) / _curve(np.array(_WHITE)), dtype=np.float32)


def _curve(x: np.ndarray) -> np.ndarray:
    # Limit values far above white, so that squares remain finite
    x = np.minimum(x, 1e4)
    top = x * (_A * x + _C * _B) + _D * _E
    shown: np.ndarray = top / (x * (_A * x + _B) + _D * _F) - _E / _F
    return shown
