"""EN 17037:2018, exposure to sunlight: points of openings, hours of sun on one day.

The sun is followed over a day between 1 February and 21 March, as if no cloud stood
before it. It counts from a least altitude on, which the standard names by country, and
where it reaches a point at the inner face of the wall: in the middle of the opening's
width, 1.2 m above the floor and 0.3 m above the sill at least. Openings of one room
add up, minutes in which several have sun count once.
"""

import numpy as np
from jaxtyping import Bool, Float

from clerestory.directions import unit
from clerestory.errors import InputError

# Height of the point above the floor and above the sill [m]
ABOVE_FLOOR, ABOVE_SILL = 1.2, 0.3

# First and last day that may be chosen
FIRST_DAY, LAST_DAY = "02-01", "03-21"

# Openings that lie flatter than this are judged at their middle
_FLAT_DEG = 15.0


def reference_point(
    corners: Float[np.ndarray, "corner 3"],
    normal: Float[np.ndarray, "3"],
    *,
    floor: float = 0.0,
    depth: float = 0.0,
) -> Float[np.ndarray, "3"]:
    """Return the point of an opening whose hours of sun count [m].

    In an opening too low for the point it is the middle of its height; in a roof's it
    is the middle of all.

    Parameters
    ----------
    corners : of the opening
    normal : unit vector into the room
    floor : height of the floor [m]
    depth : from the opening's plane to the inner face of the wall [m]

    Examples
    --------
    >>> window = np.array([[1.0, 0, 0.8], [3, 0, 0.8], [3, 0, 2.2], [1, 0, 2.2]])
    >>> inwards = np.array([0.0, 1, 0])
    >>> reference_point(window, inwards).tolist()
    [2.0, 0.0, 1.2]
    >>> reference_point(window, inwards, floor=-0.2, depth=0.1).round(3).tolist()
    [2.0, 0.1, 1.1]
    """
    if abs(normal[2]) > np.cos(np.radians(_FLAT_DEG)):
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        return np.asarray(middle + depth * normal)
    across = unit(np.cross([0.0, 0.0, 1.0], normal))
    slope = np.cross(normal, across)
    wide, high = corners @ across, corners @ slope
    low, top = float(corners[:, 2].min()), float(corners[:, 2].max())
    height = max(floor + ABOVE_FLOOR, low + ABOVE_SILL)
    if height >= top:
        height = (low + top) / 2
    along = high.min() + (height - low) / slope[2]
    point = (wide.min() + wide.max()) / 2 * across + along * slope
    return np.asarray(point + (float(corners[0] @ normal) + depth) * normal)


def hours_of_sun(
    reached: Bool[np.ndarray, "opening step"], *, step_minutes: float = 1.0
) -> tuple[Float[np.ndarray, " opening"], float]:
    """Return the hours of sun of every opening, and of the room that has them all.

    Parameters
    ----------
    reached : whether the sun reaches each opening's point

    Raises
    ------
    InputError : steps of no length

    Examples
    --------
    >>> morning, noon = [True] * 90 + [False] * 90, [False] * 60 + [True] * 120
    >>> each, room = hours_of_sun(np.array([morning, noon]))
    >>> each.tolist(), room
    ([1.5, 2.0], 3.0)
    """
    if not step_minutes > 0:
        raise InputError(f"steps of {step_minutes:g} minutes; more than 0 expected")
    share = step_minutes / 60
    return reached.sum(axis=1) * share, float(reached.any(axis=0).sum() * share)
