"""View grids in the study file: positions and directions for annual glare."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.study.config_tables import Named, Place, require_rule
from clerestory.study.file_fields import InputFile

# Largest number of positions of a view grid; each takes about a minute
MOST_POSITIONS = 10_000

# Height of the eyes of a seated person above the floor [m]
SEATED = 1.2

_FULL_TURN = 360


def _directions(value: Any) -> Any:
    # Whole degrees between directions, so that azimuths are exact in tables
    if type(value) is not int or not 1 <= value <= _FULL_TURN or _FULL_TURN % value:
        raise PydanticCustomError("choice", "a divisor of 360, such as 4, 8 or 12")
    return value


class ViewGridTable(Named):
    """View grid: positions and horizontal view directions for annual glare."""

    name: str = Field(
        pattern=r"^[\w .-]+$", description="letters, digits, spaces, dots and dashes"
    )
    grid: str = ""
    file: InputFile | None = Field(
        None, description="a file of positions, x y z a line"
    )
    places: list[Place] = Field(
        default_factory=list, description="a list of positions [x, y, z]"
    )
    spacing: float | None = Field(None, gt=0, description="metres")
    floor: list[Place] = Field(
        default_factory=list, description="a list of three or more corners [x, y, z]"
    )
    eye_heights: list[Annotated[float, Field(gt=0, le=100)]] = Field(
        default_factory=list, description="a list of heights above the floor in metres"
    )
    directions: Annotated[int, BeforeValidator(_directions)] = 8
    first_azimuth_deg: float = Field(0.0, ge=-360, le=360)
    samples: int | None = Field(None, ge=1, le=1 << 20)
    sun_samples: int | None = Field(None, ge=1, le=1 << 12)
    tolerance: float = Field(0.005, gt=0, le=0.1)
    most_directions: int = Field(6000, ge=1024, le=1 << 17)
    by_state: bool = False
    picture_resolution: int = Field(200, ge=0, le=4096)

    @model_validator(mode="after")
    def _one_source_of_positions(self) -> "ViewGridTable":
        keys = {
            "grid": self.grid,
            "file": self.file,
            "places": self.places,
            "spacing": self.spacing,
        }
        given = [f'"{key}"' for key, value in keys.items() if value]
        expected = 'one of "grid", "file", "places" and "spacing" expected'
        require_rule(
            len(given) == 1, f"{' and '.join(given) or 'no positions'}; {expected}"
        )
        require_rule(
            not self.floor or self.spacing,
            '"floor" without "spacing"; the distance between positions expected',
        )
        require_rule(
            len(self.floor) in (0, *range(3, MOST_POSITIONS)),
            f'"floor" has {len(self.floor)} corners; three or more expected',
        )
        twice = len(set(self.eye_heights)) < len(self.eye_heights)
        require_rule(
            not twice, '"eye_heights" has a height twice; different ones expected'
        )
        return self
