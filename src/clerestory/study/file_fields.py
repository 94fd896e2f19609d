"""Fields of study files for input files, relative to the folder of the study."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import InputError
from clerestory.files import is_file


def input_file(value: Any, info: Any) -> Any:
    """Return the path of a file that must exist, given relative to the study."""
    if not isinstance(value, str) or not value:
        raise PydanticCustomError("file", "the name of a file in quotes")
    path: Path = (info.context or {}).get("folder", Path()) / value
    if not is_file(path):
        raise PydanticCustomError("file", "the name of a file that exists")
    return path


InputFile = Annotated[Path, BeforeValidator(input_file)]


def file_or_name(check: Callable[[str], object]) -> BeforeValidator:
    """Return the validator of a file, or of a name in the built-in library.

    `check` raises InputError for unknown names, which begin with "library:".
    """

    def field(value: Any, info: Any) -> Path:
        # A name is not a path; it is checked with the study
        if not isinstance(value, str) or not value.startswith(LIBRARY_PREFIX):
            path: Path = input_file(value, info)
            return path
        try:
            check(value)
        except InputError as problem:
            message = {"message": str(problem)}
            raise PydanticCustomError("rule", "{message}", message) from None
        return Path(value)

    return BeforeValidator(field)
