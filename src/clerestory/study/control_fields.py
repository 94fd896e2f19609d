"""Fields of control rules in the study file: states, thresholds and slat tilts."""

import itertools
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, ValidationInfo
from pydantic_core import PydanticCustomError

from clerestory.control.profile_angle import blocking_states

# Largest tilt of a slat [°], and profile angles at which tilts are compared [rad]
_LARGEST_TILT = 90.0
_PROFILES = np.radians(np.arange(-89.9, 90, 0.1))


def _state(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise PydanticCustomError("choice", "the number or the name of a state")
    return value


def _levels(value: Any) -> Any:
    # One threshold, or an increasing list: one threshold per change of shade state
    levels = value if isinstance(value, list) else [value]
    numbers = all(isinstance(x, int | float) for x in levels)
    if not levels or not numbers or any(isinstance(x, bool) for x in levels):
        raise PydanticCustomError("choice", "a number, or a list of them")
    if any(later <= first for first, later in itertools.pairwise(levels)):
        raise PydanticCustomError("choice", "numbers in rising order")
    return levels


def _tilts(value: Any, info: ValidationInfo) -> Any:
    # Tilts, each of which blocks sunlight that all tilts before it transmit
    given = value if isinstance(value, list) else [value]
    raised = int(given[:1] == ["raised"])
    slats = given[raised:]
    if not all(type(x) in (int, float) and abs(x) <= _LARGEST_TILT for x in slats):
        raise PydanticCustomError(
            "choice", 'tilts from -90 to 90 degrees, optionally after "raised",'
        )
    width, spacing = (info.data.get(key) for key in ("slat_width", "slat_spacing"))
    if slats and width and spacing:
        acting = blocking_states(
            _PROFILES, tilts=np.radians(slats), width=width, spacing=spacing
        )
        idle = np.setdiff1d(np.arange(len(slats)), acting)
        if len(idle):
            raise PydanticCustomError(
                "choice",
                "tilts, each of which blocks sunlight that all states before it"
                f" transmit (state {idle[0] + raised} does not),",
            )
    return value


StateChoice = Annotated[int | str, BeforeValidator(_state)]
Tilts = Annotated[list[float | str], BeforeValidator(_tilts)]
Levels = Annotated[list[float], BeforeValidator(_levels)]
