"""Table of the study file for sensitivities to materials."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from clerestory.documents import Table

_EXPECTED = 'a list of names of materials, or "all"'


def _materials(value: Any) -> Any:
    # Accept "all", or a list of distinct names
    names = value if isinstance(value, list) else []
    texts = all(isinstance(name, str) and name for name in names)
    if value != "all" and not (names and texts and len(set(names)) == len(names)):
        raise PydanticCustomError("choice", _EXPECTED)
    return value


class SensitivityTable(Table):
    """Materials whose reflectance or transmissivity is changed, and the change."""

    materials: Annotated[list[str] | Literal["all"], BeforeValidator(_materials)] = (
        Field(description=_EXPECTED)
    )
    step: float = Field(
        0.05, gt=0, le=0.5, description="a change above 0, up to 0.5, such as 0.05"
    )
    glare: bool = False
