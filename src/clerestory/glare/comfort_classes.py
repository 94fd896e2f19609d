"""Annual glare metrics, and glare classes of EN 17037 and EN 14501.

A DGP of NaN, as in dark time steps, counts as no glare.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.checks import require, within
from clerestory.glare.dgp import DGP

# DGP above which glare is perceptible, disturbing and intolerable
LIMITS = DGP.thresholds

# Largest permitted fraction of the occupied time with DGP above a limit
EXCEEDANCE = 0.05

Protection = Literal["high", "medium", "minimum", "none"]

# Glare control classes of EN 14501:2005. Rows: normal-normal transmittance up to 0, up
# to 0.05, up to 0.10, above; columns: normal-diffuse transmittance below 0.02, 0.04,
# 0.08, above
_EN14501 = ((4, 3, 2, 2), (3, 2, 1, 1), (1, 1, 0, 0), (0, 0, 0, 0))
_DIRECT = (0.0, 0.05, 0.10)
_DIFFUSE = (0.02, 0.04, 0.08)


def exceeded_dgp(
    dgp: Float[np.ndarray, "*batch time"], share: float = EXCEEDANCE
) -> Values:
    """DGP that is exceeded in at most the fraction `share` of the time steps.

    >>> float(exceeded_dgp(np.linspace(0, 1, 101)).round(3))
    0.95
    """
    steps = dgp.shape[-1]
    require(steps, "no occupied steps; at least one expected")
    require(0 <= share < 1, f"fraction of steps is {share:g}; 0 to below 1 expected")
    above = int(np.floor(share * steps + 1e-9))
    rated = np.nan_to_num(dgp, nan=0.0)
    return np.asarray(np.sort(rated, axis=-1)[..., steps - 1 - above])


def protection_level(exceeded: float) -> Protection:
    """Level of protection from glare after EN 17037:2018, annex E.

    `exceeded` is the DGP that is exceeded in at most 5 % of the occupied time.

    >>> protection_level(0.38), protection_level(0.5)
    ('medium', 'none')
    """
    levels: tuple[Protection, ...] = get_args(Protection)
    return levels[int(np.searchsorted(LIMITS, exceeded, side="left"))]


def glare_autonomy(
    dgp: Float[np.ndarray, "*batch time"], limit: float = LIMITS[1]
) -> Values:
    """Glare autonomy: fraction of the occupied steps with DGP below a limit.

    Reference: Jones, N. L. (2019), as in `imageless`.

    >>> float(glare_autonomy(np.array([0.2, np.nan, 0.39, 0.6])))
    0.75
    """
    return np.asarray((~(dgp >= limit)).mean(axis=-1))


def glare_control_class(*, normal_normal: float, normal_diffuse: float) -> int:
    """Glare control class of a shading fabric after EN 14501:2005, 0 to 4.

    The class table was taken from publications of fabric manufacturers and not compared
    with the standard. The finer table of the 2021 edition is not implemented. Both
    arguments are visible transmittances.

    >>> glare_control_class(normal_normal=0.03, normal_diffuse=0.05)
    1
    """
    within((normal_normal, normal_diffuse), "transmittance", least=0, most=1)
    row = int(np.searchsorted(_DIRECT, normal_normal, side="left"))
    column = int(np.searchsorted(_DIFFUSE, normal_diffuse, side="right"))
    return _EN14501[row][column]
