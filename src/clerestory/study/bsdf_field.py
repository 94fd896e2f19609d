"""Field of study files for a BSDF: a file, or the name of a built-in product."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from clerestory.errors import InputError
from clerestory.library.bsdf_source import is_library_name, library_layers
from clerestory.study.config_tables import input_file

BSDF = "a BSDF file (.xml), or library:NAME"


def _bsdf_file(value: Any, info: Any) -> Any:
    # The name of a built-in BSDF is not a path; it is checked with the study
    if not isinstance(value, str) or not is_library_name(value):
        return input_file(value, info)
    try:
        library_layers(value)
    except InputError as problem:
        message = {"message": str(problem)}
        raise PydanticCustomError("rule", "{message}", message) from None
    return Path(value)


BsdfFile = Annotated[Path, BeforeValidator(_bsdf_file)]
