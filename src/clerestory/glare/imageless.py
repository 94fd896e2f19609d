"""Imageless daylight glare probability.

DGP is computed from the vertical illuminance and from luminances in a set of
directions: the sky patches visible through the windows, and the sun. Each direction
with luminance above the threshold is a separate glare source. Merging of sources and
reflections in the room are neglected.
"""

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Series, Values
from clerestory.checks import require
from clerestory.glare.index_settings import EVALGLARE, DgpCoefficients
from clerestory.glare.position_index import PositionModel, position_index
from clerestory.scene.view import View


def imageless_dgp(
    illuminance: Series,
    *,
    luminance: Float[np.ndarray, "direction time"],
    solid_angle: Float[np.ndarray, "direction columns"],
    index: Float[np.ndarray, "direction columns"],
    threshold: float = 2000.0,
    coefficients: DgpCoefficients = EVALGLARE,
) -> Series:
    """Daylight glare probability at each time step from vertical illuminance [lux].

    `luminance` is the luminance seen through the window [cd/m²], 0 for a hidden sun;
    directions with luminance above `threshold` are glare sources. `solid_angle` is the
    solid angle of the sun or the visible part of a sky patch [sr], `index` the position
    index, infinite behind the eye; both arrays have one column, or one per time step.

    Reference: Jones, N. L. (2019): Fast climate-based glare analysis and spatial
    mapping. Building Simulation, Rome. Wasilewski, S. et al. (2022): Efficient
    simulation for visual comfort evaluations. Energy and Buildings 267.

    >>> one = np.ones((1, 1))
    >>> sun = {"luminance": 1e6 * one, "solid_angle": 6.8e-5 * one, "index": 3 * one}
    >>> imageless_dgp(np.array([3000.0]), **sun).round(3).tolist()
    [0.384]
    """
    require(
        luminance.shape == (len(solid_angle), len(illuminance)),
        f"luminances of shape {luminance.shape}; ({len(solid_angle)} directions,"
        f" {len(illuminance)} steps) expected",
    )
    k = coefficients
    weight = solid_angle**k.a2 / index**k.a4
    bright = np.where(luminance > threshold, luminance, 0.0) ** k.a1
    total = weight[:, 0] @ bright if weight.shape[1] == 1 else (weight * bright).sum(0)
    level = np.maximum(np.asarray(illuminance, dtype=float), 1e-9)
    contrast = k.c2 * np.log10(1 + total / level**k.a3)
    return np.asarray(np.minimum(k.c1 * level**k.a5 + k.c3 + contrast, 1.0))


def position_of(
    direction: Directions, view: View, *, model: PositionModel = "guth"
) -> Values:
    """Position index of directions from the eye; infinite behind the eye.

    The vertical is the up vector of the view, projected perpendicular to the line of
    sight.
    """
    right = np.cross(view.direction, view.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, view.direction)
    ahead = np.clip(direction @ view.direction, -1, 1)
    above, aside = direction @ up, direction @ right
    sigma = np.arccos(ahead)
    tau = np.arctan2(np.abs(aside), above)
    index = position_index(sigma, tau, above < 0, model=model)
    return np.where(ahead > 0, index, np.inf)
