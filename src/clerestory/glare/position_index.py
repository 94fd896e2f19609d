"""Position index of glare sources after Guth, Iwata and Kim.

The default is Levin's fit of Guth's position index above the line of sight, and the
index of Iwata and Osterhaus below. Kim's index has one formula for all directions.
Older programs use Levin's fit alone, mirrored below the line of sight and without upper
limit.
"""

from typing import Literal, get_args

import numpy as np

from clerestory.array_types import Mask, Values
from clerestory.checks import one_of

PositionModel = Literal["guth", "kim", "levin"]

# Upper limit of the position index (evalglare)
LARGEST = 16.0


def position_index(
    sigma: Values, tau: Values, below: Mask, *, model: PositionModel = "guth"
) -> Values:
    """Position index of directions; on the line of sight 1, except in Kim's model.

    Directions are given by their angle sigma from the line of sight, and their azimuth
    tau around it from the upward vertical [rad]. Models are "guth" as in evalglare,
    "kim", and "levin" as in Radiance's glarendx.

    Reference: Guth, S. K. (1963): A method for the evaluation of discomfort glare.
    Illuminating Engineering 57. Levin, R. E. (1975): Position index in VCP
    calculations. Journal of the IES 4(2). Below the line of sight: Iwata, T. and
    Osterhaus, W. (2010): Assessment of discomfort glare in daylit offices using
    luminance distribution images. CIE Lighting Quality and Energy Efficiency. Kim, W.
    et al. (2009): The position index of a glare source at the borderline between
    comfort and discomfort (BCD) in the whole visual field. Building and Environment
    44(5).

    >>> sigma = np.radians([0.0, 30.0, 30.0])
    >>> position_index(sigma, np.zeros(3), np.array([False, False, True])).round(2)
    array([1.  , 3.35, 1.58])
    """
    one_of(model, "position model", choices=get_args(PositionModel))
    if model == "kim":
        return _kim(np.degrees(sigma), np.degrees(tau))
    if model == "levin":
        return _guth(np.degrees(sigma), np.degrees(np.minimum(tau, np.pi - tau)))
    index = np.empty(np.shape(sigma))
    above = ~below
    index[above] = _guth(np.degrees(sigma[above]), np.degrees(tau[above]))
    index[below] = _iwata(sigma[below], tau[below])
    return np.minimum(index, LARGEST)


def _guth(sigma: np.ndarray, tau: np.ndarray) -> np.ndarray:
    # Levin's fit, as in the IESNA Lighting Handbook; both angles in degrees
    slope = (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3
    bend = (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5
    return np.asarray(np.exp(sigma * (slope + sigma * bend)))


def _iwata(sigma: np.ndarray, tau: np.ndarray) -> np.ndarray:
    # Guth's index for τ = 90° at the angle atan(tan σ · √(1 + 0.3225 cos² τ))
    wide = np.sqrt(1 + 0.3225 * np.cos(tau) ** 2)
    beta = np.degrees(np.arctan(np.tan(sigma) * wide))
    return np.asarray(np.exp(6.49e-3 * beta + 21e-5 * beta * beta))


def _kim(sigma: np.ndarray, tau: np.ndarray) -> np.ndarray:
    cubic = -0.000009 * tau**3
    middle = cubic + 0.0014 * tau**2 + 0.0866 * tau + 21.633
    spread = cubic + 0.0013 * tau**2 + 0.0853 * tau + 8.772
    return np.asarray(np.exp((sigma - middle) / spread))
