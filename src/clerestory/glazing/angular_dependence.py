"""How panes pass on light at other angles than those they were measured at.

Files hold transmittance and reflectance along the normal. For uncoated glass the
refractive index and the absorption follow from the two, and Fresnel's equations
give the rest. For coated glass the angular course of clear or of bronze glass is
borrowed, whichever the transmittance is nearer to; that is a regression, good to a
few hundredths for common coatings.

References: R. A. Furler, ASHRAE Transactions 97 (2), 1991 (uncoated glass);
E. U. Finlayson, D. K. Arasteh, C. Huizenga, M. D. Rubin, M. S. Reilly, WINDOW 4.0:
Documentation of Calculation Procedures, LBL-33943, 1993 (coefficients for coated
glass).
"""

import numpy as np
from jaxtyping import Float

# Polynomials in the cosine, lowest power first (LBL-33943): transmittance
# over that at the normal, and reflectance likewise.
_CLEAR_T = (-0.0015, 3.355, -3.84, 1.46, 0.0288)
_CLEAR_R = (0.999, -0.563, 2.043, -2.532, 1.054)
_BRONZE_T = (-0.002, 2.813, -2.341, -0.05725, 0.599)
_BRONZE_R = (0.997, -1.868, 6.513, -7.862, 3.225)

# Coated panes that pass more than this behave like clear glass (LBL-33943).
_CLEAR_ABOVE = 0.645


def uncoated(
    cosine: Float[np.ndarray, "*#batch"],
    *,
    transmittance: Float[np.ndarray, "*#batch"],
    reflectance: Float[np.ndarray, "*#batch"],
) -> tuple[Float[np.ndarray, "*both"], Float[np.ndarray, "*both"]]:
    """Transmittance and reflectance of unpolarised light by a homogeneous pane.

    Parameters
    ----------
    cosine : of the angle between light and normal
    transmittance, reflectance : of the same pane along the normal

    Examples
    --------
    >>> clear = {"transmittance": np.array(0.83), "reflectance": np.array(0.075)}
    >>> t, r = uncoated(np.array(1.0), **clear)
    >>> round(float(t), 9), round(float(r), 9)
    (0.83, 0.075)
    """
    t0, r0, cosine = np.broadcast_arrays(transmittance, reflectance, cosine)

    # Reflectance of one face along the normal, from both measured shares
    beta = t0**2 - r0**2 + 2 * r0 + 1
    root = np.sqrt(np.maximum(beta**2 - 4 * (2 - r0) * r0, 0))
    face = (beta - root) / (2 * (2 - r0))
    index = (1 + np.sqrt(face)) / (1 - np.sqrt(face))

    # What is left after one passage, longer where light is oblique
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
    cosine: Float[np.ndarray, "*#batch"],
    *,
    transmittance: Float[np.ndarray, "*#batch"],
    reflectance: Float[np.ndarray, "*#batch"],
) -> tuple[Float[np.ndarray, "*both"], Float[np.ndarray, "*both"]]:
    """Transmittance and reflectance of a coated pane, by the course of clear or bronze.

    Parameters
    ----------
    cosine : of the angle between light and normal
    transmittance, reflectance : of the same pane along the normal

    Examples
    --------
    >>> low_e = {"transmittance": np.array(0.6), "reflectance": np.array(0.1)}
    >>> t, r = coated(np.array(0.5), **low_e)
    >>> round(float(t), 3), round(float(r), 3)
    (0.51, 0.154)
    """
    clear = np.asarray(transmittance) > _CLEAR_ABOVE
    tau = np.where(clear, _polynomial(_CLEAR_T, cosine), _polynomial(_BRONZE_T, cosine))
    rho = np.where(clear, _polynomial(_CLEAR_R, cosine), _polynomial(_BRONZE_R, cosine))
    rho = rho - tau
    t = np.asarray(np.clip(tau * transmittance, 0, 1))
    r = np.asarray(np.clip(reflectance * (1 - rho) + rho, 0, 1))
    return _bounded(t, r)


def _slab(
    rho: Float[np.ndarray, "*#batch"], left: Float[np.ndarray, "*#batch"]
) -> tuple[Float[np.ndarray, "*both"], Float[np.ndarray, "*both"]]:
    # Geometric series of inter-reflections between the two faces of a slab
    series = 1 - (left * rho) ** 2
    t = np.where(series > 0, left * (1 - rho) ** 2 / np.where(series > 0, series, 1), 0)
    return t, np.asarray((1 + left * t) * rho)


def _polynomial(
    coefficients: tuple[float, ...], x: Float[np.ndarray, "*#batch"]
) -> Float[np.ndarray, "*#batch"]:
    return np.asarray(np.polynomial.polynomial.polyval(x, coefficients))


def _bounded(
    t: Float[np.ndarray, "*#batch"], r: Float[np.ndarray, "*#batch"]
) -> tuple[Float[np.ndarray, "*both"], Float[np.ndarray, "*both"]]:
    # Regressions and noisy measurements may make light: the larger share gives way
    excess = np.maximum(t + r - 1, 0)
    return np.where(t >= r, t - excess, t), np.where(t >= r, r, r - excess)
