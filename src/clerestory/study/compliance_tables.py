"""Tables of the study file for standards: spaces, and the standards to assess."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.documents import Number, Positive, Table
from clerestory.metrics.breeam_space_types import OFFICE, SPACE_TYPES
from clerestory.metrics.standards import ALIASES, STANDARDS
from clerestory.metrics.view_out import EYE_HEIGHT
from clerestory.study.config_tables import Named, require_one_of

_NAMES = (*STANDARDS, *ALIASES)


def _standard(value: Any) -> Any:
    if value not in _NAMES:
        names = ", ".join(f'"{name}"' for name in _NAMES)
        raise PydanticCustomError("choice", f"one of {names}")
    return value


def _space_type(value: Any) -> Any:
    if value not in SPACE_TYPES:
        names = ", ".join(f'"{name}"' for name in SPACE_TYPES)
        raise PydanticCustomError("choice", f"one of {names}")
    return value


class SpaceTable(Named):
    """A space of the building: its sensors, floor area and views."""

    name: str = Field(
        min_length=1,
        pattern=r"^[\w .-]+$",
        description="letters, digits, spaces, dots and dashes",
    )
    grids: list[str] = Field([], description="a list of names of [[sensors]]")
    corners: list[Annotated[list[Number], Field(min_length=2, max_length=2)]] = Field(
        [], description="a list of three or more corners [x, y]"
    )
    area: Positive | None = None
    views: list[str] = Field([], description="a list of names of [[view]]")
    breeam_type: Annotated[str, BeforeValidator(_space_type)] = OFFICE

    @model_validator(mode="after")
    def _one_way(self) -> "SpaceTable":
        require_one_of({'"grids"': self.grids, '"corners"': self.corners})
        if 0 < len(self.corners) < 3:
            raise PydanticCustomError(
                "rule", f'{len(self.corners)} "corners"; three or more expected'
            )
        return self


class ComplianceTable(Table):
    """Standards with which the results are compared."""

    standards: list[Annotated[str, BeforeValidator(_standard)]] = Field(
        min_length=1, description="a list of standards"
    )
    eye_height: float = Field(EYE_HEIGHT, gt=0, le=3)
