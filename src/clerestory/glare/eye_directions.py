"""Directions as seen by an eye: angles, position indices and places in a fisheye."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Directions, Mask, Values
from clerestory.brief_repr import brief
from clerestory.checks import has_shape, not_negative, same_length
from clerestory.constants import SUN_DIAMETER
from clerestory.directions import unit
from clerestory.glare.field_of_view import FieldOfView, in_field
from clerestory.glare.glare_view import angles_from
from clerestory.glare.position_index import PositionModel, position_index
from clerestory.scene.projection import PROJECTIONS
from clerestory.scene.view import View

_FISHEYE = PROJECTIONS["angular"]

# Solid angle of the sun's disc [sr]
SUN_SOLID_ANGLE = 2 * np.pi * (1 - np.cos(SUN_DIAMETER / 2))


@dataclass(frozen=True, eq=False)
class SunDisc:
    """The sun's disc at each time step, as seen from a view point.

    `luminance` is that of the disc through the window [cd/m²], `solid_angle` that of
    its visible part [sr], 0 where it is hidden; the whole disc has `SUN_SOLID_ANGLE`.
    """

    direction: Float[np.ndarray, "step 3"]
    luminance: Float[np.ndarray, " step"]
    solid_angle: Float[np.ndarray, " step"]

    __repr__ = brief

    def __post_init__(self) -> None:
        has_shape(self.direction, (len(self.luminance), 3), "direction of the sun")
        same_length(self.solid_angle, self.luminance, "solid angles", "luminances")
        not_negative(self.luminance, "luminance of the sun", unit="cd/m2")
        not_negative(self.solid_angle, "solid angle of the sun", unit="sr")

    def select(self, steps: slice | Int[np.ndarray, " some"]) -> "SunDisc":
        """Return the disc at some time steps."""
        return SunDisc(
            self.direction[steps], self.luminance[steps], self.solid_angle[steps]
        )


class EyeDirections(NamedTuple):
    """Directions as seen by an eye that looks along the line of sight of a view.

    `cosine` is that of the angle `sigma` from the line of sight, 0 behind the eye;
    `searched` tells whether a direction is ahead and in the field of view. `place` is
    to the right and up in an angular fisheye picture [rad].
    """

    ahead: Mask
    searched: Mask
    cosine: Values
    sigma: Values
    position_index: Values
    place: Float[np.ndarray, "direction 2"]


def seen_by(
    view: View,
    direction: Directions,
    *,
    model: PositionModel = "guth",
    field: FieldOfView | None = None,
) -> EyeDirections:
    """Return directions as seen by the eye of a view, of any projection."""
    cosine, sigma, tau = angles_from(view, direction)
    local = direction @ _axes(view).T
    below = local[:, 1] < 0
    searched = ahead = cosine > 0
    if field is not None:
        searched = ahead & in_field(sigma, tau, below, field=field)
    index = position_index(sigma, tau, below, model=model)
    place = np.stack(_FISHEYE.to_plane(local), axis=-1)
    return EyeDirections(
        ahead, searched, np.where(ahead, cosine, 0), sigma, index, place
    )


def directions_at(view: View, place: Float[np.ndarray, "direction 2"]) -> Directions:
    """Return the directions at places of an angular fisheye picture [rad]."""
    local, _ = _FISHEYE.to_direction(*place.T)
    return np.asarray(local @ _axes(view))


def _axes(view: View) -> Float[np.ndarray, "3 3"]:
    # Rows: right, up, forward
    right = unit(np.cross(view.direction, view.up))
    return np.stack([right, np.cross(right, view.direction), view.direction])
