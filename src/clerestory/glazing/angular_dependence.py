"""Angular dependence of the transmittance and reflectance of panes.

Product files contain values at normal incidence. For uncoated glass they determine the
refractive index and absorption, from which Fresnel's equations give values at other
angles. Coated glass follows regressions for clear glass (transmittance above 0.645) or
bronze glass, which are accurate to a few hundredths for most coatings.

References: R. A. Furler, ASHRAE Transactions 97 (2), 1991 (uncoated glass); E. U.
Finlayson, D. K. Arasteh, C. Huizenga, M. D. Rubin, M. S. Reilly, WINDOW 4.0:
Documentation of Calculation Procedures, LBL-33943, 1993 (coated glass).
"""

import numpy as np
from jaxtyping import Float
from numpy.polynomial.polynomial import polyval

from clerestory.array_types import Values

# Mutually broadcastable arrays
_Broadcast = Float[np.ndarray, "*#batch"]

# Transmittance and reflectance relative to normal incidence: polynomials in the cosine
# of the angle of incidence, lowest power first (LBL-33943).
_CLEAR_T = (-0.0015, 3.355, -3.84, 1.46, 0.0288)
_CLEAR_R = (0.999, -0.563, 2.043, -2.532, 1.054)
_BRONZE_T = (-0.002, 2.813, -2.341, -0.05725, 0.599)
_BRONZE_R = (0.997, -1.868, 6.513, -7.862, 3.225)

# Transmittance above which coated panes follow clear glass (LBL-33943).
_CLEAR_ABOVE = 0.645


def uncoated(
    cosine: _Broadcast, *, transmittance: _Broadcast, reflectance: _Broadcast
) -> tuple[Values, Values]:
    """Transmittance and reflectance of a homogeneous pane for unpolarised light.

    `transmittance` and `reflectance` are values at normal incidence.
    """
    t0, r0, cosine = np.broadcast_arrays(transmittance, reflectance, cosine)

    # Reflectance of one face at normal incidence, and refractive index
    beta = t0**2 - r0**2 + 2 * r0 + 1
    root = np.sqrt(np.maximum(beta**2 - 4 * (2 - r0) * r0, 0))
    face = (beta - root) / (2 * (2 - r0))
    index = (1 + np.sqrt(face)) / (1 - np.sqrt(face))

    # Internal transmittance of the oblique path
    passes = (t0 > 0) & (face > 0) & (r0 > face)
    ratio = (r0 - face) / np.where(passes, t0 * face, 1)
    inner = np.sqrt(1 - (1 - cosine**2) / index**2)
    left = np.where(passes, np.where(passes, ratio, 1) ** (1 / inner), 0)

    shares = [
        _slab(np.asarray(rho**2), left)
        for rho in (
            (index * cosine - inner) / (index * cosine + inner),
            (cosine - index * inner) / (cosine + index * inner),
        )
    ]
    t, r = (np.asarray(np.mean(pair, axis=0)) for pair in zip(*shares, strict=True))
    idle = (face == 0) | (t0 == 1)
    return _bounded(np.where(idle, t0, t), np.where(idle, r0, r))


def coated(
    cosine: _Broadcast, *, transmittance: _Broadcast, reflectance: _Broadcast
) -> tuple[Values, Values]:
    """Transmittance and reflectance of a coated pane; see `uncoated`."""
    clear = np.asarray(transmittance) > _CLEAR_ABOVE
    tau, rho = (
        np.where(clear, polyval(cosine, one), polyval(cosine, other))
        for one, other in ((_CLEAR_T, _BRONZE_T), (_CLEAR_R, _BRONZE_R))
    )
    rho = rho - tau
    t = np.asarray(np.clip(tau * transmittance, 0, 1))
    r = np.asarray(np.clip(reflectance * (1 - rho) + rho, 0, 1))
    return _bounded(t, r)


def _slab(rho: _Broadcast, left: _Broadcast) -> tuple[Values, Values]:
    # Transmittance and reflectance of a slab: geometric series of interreflections
    series = 1 - (left * rho) ** 2
    t = np.where(series > 0, left * (1 - rho) ** 2 / np.where(series > 0, series, 1), 0)
    return t, np.asarray((1 + left * t) * rho)


def _bounded(t: _Broadcast, r: _Broadcast) -> tuple[Values, Values]:
    # Reduce the larger value if T + R exceeds 1
    excess = np.maximum(t + r - 1, 0)
    return np.where(t >= r, t - excess, t), np.where(t >= r, r, r - excess)
