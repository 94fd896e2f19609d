"""JSON and TOML files as pydantic models, with error messages of one line.

A message gives the path of the item, its value and the expected value, such as
`rooms[0].units is "Parsecs"; "Meters" or "Feet" expected`.
"""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    Strict,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails

from clerestory.errors import InputError
from clerestory.files import read_text

# Numbers that are not booleans or text
Number = Annotated[float, Strict()]
Positive = Annotated[Number, Field(gt=0)]

Document = TypeVar("Document", bound=BaseModel)

# Expected value for each type of pydantic error, with the limits in {…}
_EXPECTED = {
    "bool_parsing": "true or false",
    "bool_type": "true or false",
    "dict_type": "an object",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "a whole number",
    "list_type": "a list",
    "model_type": "an object",
    "string_type": "text",
    "too_short": "a list of {min_length} or more",
    "too_long": "a list of at most {max_length}",
    "tuple_type": "a list",
}

# Number of characters of a value that a message repeats
_SHOWN = 40


class Table(BaseModel):
    """A table of which all keys are known."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Item(Table):
    """A JSON object of which only some members are read; `null` means missing."""

    model_config = ConfigDict(extra="ignore")

    @model_validator(mode="before")
    @classmethod
    def _without_null(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        return {key: member for key, member in value.items() if member is not None}


def read_json(path: str | Path, model: type[Document]) -> Document:
    """Return the document in a JSON file."""
    return parse_json(read_text(path), model, file=path)


def parse_json(
    text: str | bytes, model: type[Document], *, file: str | Path
) -> Document:
    """Return the document in a JSON text; `file` is for error messages."""
    return validated(_parsed(text, json.loads, "JSON", file), model, file=file)


def read_toml(path: str | Path, model: type[Document]) -> Document:
    """Return the document in a TOML file; messages count tables from 1."""
    value = _parsed(read_text(path), tomllib.loads, "TOML", path)
    return validated(value, model, file=path, first=1)


def _parsed(text: Any, parse: Callable[[Any], Any], kind: str, file: str | Path) -> Any:
    try:
        return parse(text)
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", None)
        reason = getattr(error, "msg", None) or str(error)
        raise InputError(f"not {kind}: {reason}", file=file, line=line) from error


def validated(
    value: Any, model: type[Document], *, file: str | Path, first: int = 0
) -> Document:
    """Return a value as a model; messages count elements of lists from `first`."""
    try:
        return model.model_validate(value)
    except ValidationError as error:
        details = error.errors(include_url=False)[0]
        raise InputError(_message(details, first), file=file) from error


def _message(details: ErrorDetails, first: int) -> str:
    kind, limits = details["type"], details.get("ctx", {})
    place = "".join(
        f"[{part + first}]" if isinstance(part, int) else f".{part}"
        for part in details["loc"]
    ).lstrip(".")
    if kind == "missing":
        return f"{place} is missing"
    if kind == "extra_forbidden":
        return f"{place}: unknown key"
    expected = _EXPECTED.get(kind, details["msg"].removeprefix("Input should be "))
    if kind == "literal_error":
        expected = str(limits["expected"]).replace("'", '"')
    shown = json.dumps(details["input"], default=str, ensure_ascii=False)
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}…"
    return f"{place or 'the root'} is {shown}; {expected.format(**limits)} expected"
