"""Readers of JSON and TOML files as pydantic models, with one-line error messages.

A message gives the line in TOML files, the key path, the value found and the expected
value, such as `study.toml:27: trace.samples is "many"; a whole number expected`.
"""

import json
import re
import sys
import tomllib
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    Strict,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from clerestory.checks import distinct
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.toml_lines import KeyPath, key_lines, line_of

# Numbers; booleans and numbers in quotes are invalid
Number = Annotated[float, Strict()]
Positive = Annotated[Number, Field(gt=0)]

Document = TypeVar("Document", bound=BaseModel)

# Text of the expected value for each type of pydantic error; {…} is a limit
_EXPECTED = {
    "bool_parsing": "true or false",
    "bool_type": "true or false",
    "dict_type": "a table",
    "finite_number": "a finite number",
    "float_type": "a number",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "int_from_float": "a whole number",
    "int_type": "a whole number",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "list_type": "a list in [ ]",
    "model_attributes_type": "a table",
    "model_type": "a table",
    "string_type": "text in quotes",
    "too_long": "a list of at most {max_length}",
    "too_short": "a list of at least {min_length}",
    "tuple_type": "a list in [ ]",
}

# Largest number of characters of a value in a message
_SHOWN = 60

# Deepest nesting of tables and lists
_DEEPEST = 100

# Largest whole number; floating-point numbers end at 1.8e308
_LARGEST = 10**300


class Table(BaseModel):
    """Base class of TOML tables; unknown keys and values of wrong type are invalid."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False
    )


class Item(Table):
    """Base class of JSON objects; unknown members are ignored, `null` means missing."""

    model_config = ConfigDict(extra="ignore", strict=False)

    @model_validator(mode="before")
    @classmethod
    def _without_null(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        return {key: member for key, member in value.items() if member is not None}


def read_json(path: str | Path, model: type[Document]) -> Document:
    """Return the content of a JSON file as a model."""
    return parse_json(read_text(path), model, file=path)


def parse_json(
    text: str | bytes, model: type[Document], *, file: str | Path
) -> Document:
    """Return the content of a JSON text as a model; `file` is for error messages."""
    return validated(json_value(text, file=file), model, file=file)


def json_value(text: str | bytes, *, file: str | Path) -> Any:
    """Return the content of a JSON text as Python objects.

    Raises
    ------
    InputError : the text is not JSON; the message states the line
    """
    try:
        with located(file=file):
            return _not_too_deep(json.loads(text, object_pairs_hook=_unique))
    except json.JSONDecodeError as error:
        line = error.lineno
        raise InputError(f"not JSON: {error.msg}", file=file, line=line) from error
    except (ValueError, RecursionError) as error:
        message = "not JSON: a number is too long, or values are nested too deeply"
        raise InputError(message, file=file) from error


def _unique(members: list[tuple[str, Any]]) -> dict[str, Any]:
    # Return a JSON object, unless it has a key twice
    found = dict(members)
    if len(found) < len(members):
        distinct((key for key, _ in members), "members of an object")
    return found


def _not_too_deep(value: Any) -> Any:
    # Refuse tables and lists that are nested too deeply, and numbers that are too large
    level = [value]
    for _ in range(_DEEPEST):
        nested = (each for each in level if isinstance(each, dict | list))
        if any(isinstance(each, int) and abs(each) > _LARGEST for each in level):
            raise ValueError
        members = (n.values() if isinstance(n, dict) else n for n in nested)
        level = [member for each in members for member in each]
    if level:
        raise RecursionError
    return value


def read_toml(
    path: str | Path, model: type[Document], context: dict[str, Any] | None = None
) -> Document:
    """Return the content of a TOML file as a model; messages count tables from 1.

    Parameters
    ----------
    context : values that the validators of the model use

    Raises
    ------
    InputError : the file cannot be read or is not TOML, a key is missing or unknown,
        or a value is invalid; the message states the line and the valid choices
    """
    text = read_text(path)
    value, lines = toml_tables(text, file=path), key_lines(text)
    return validated(value, model, file=path, context=context, lines=lines)


def toml_tables(text: str, *, file: str | Path) -> dict[str, Any]:
    """Return the content of a TOML text as nested dictionaries.

    Raises
    ------
    InputError : the text is not TOML; the message states the line
    """
    try:
        tables: dict[str, Any] = _not_too_deep(tomllib.loads(text))
        return tables
    except tomllib.TOMLDecodeError as error:
        reason = str(error)
        place = re.search(r" \(at line (\d+), column \d+\)$", reason)
        line = int(place[1]) if place else len(text.splitlines())
        reason = re.sub(r" \(at .*\)$", "", reason)
        raise InputError(f"not TOML: {reason}", file=file, line=line) from error
    except (ValueError, RecursionError) as error:
        message = "not TOML: a number is too long, or values are nested too deeply"
        raise InputError(message, file=file) from error


def validated(
    value: Any,
    model: type[Document],
    *,
    file: str | Path,
    context: dict[str, Any] | None = None,
    lines: Mapping[KeyPath, int] | None = None,
) -> Document:
    """Return a value as a model; an error message states the first fault in the file.

    Parameters
    ----------
    lines : line number of each key of a TOML file, whose tables are counted from 1
    """
    try:
        return model.model_validate(value, context=context)
    except ValidationError as error:
        known, first_table = lines or {}, 0 if lines is None else 1
        found = [(line_of(each["loc"], known), each) for each in error.errors()]
        found.sort(key=lambda pair: pair[0] or sys.maxsize)
        line, first = found[0]
        message = _message(first, model, first_table)
        if len(found) > 1:
            message += f" (and {len(found) - 1} more)"
        raise InputError(message, file=file, line=line) from error


def _message(details: ErrorDetails, model: type[BaseModel], first: int) -> str:
    kind, where = details["type"], details["loc"]
    place = "".join(
        f"[{part + first}]" if isinstance(part, int) else f".{part}" for part in where
    ).lstrip(".")
    if kind == "missing":
        return f"{place} is missing; {_description(model, where)} expected"
    if kind == "extra_forbidden":
        table = _model_at(model, where[:-1])
        names = ", ".join(_keys(table)) if table else "the documented keys"
        return f'unknown key "{place}"; one of {names} expected'
    if kind == "rule":
        return f"[{place}]: {details['msg']}" if place else str(details["msg"])
    shown = json.dumps(details["input"], default=str, ensure_ascii=False)
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}…"
    return f"{place or 'the file'} is {shown}; {_expected(details, model)} expected"


def _expected(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, limits = details["type"], details.get("ctx", {})
    if kind == "literal_error":
        return str(limits["expected"]).replace("'", '"')
    if kind in _EXPECTED:
        return _EXPECTED[kind].format(**limits)
    if kind == "string_pattern_mismatch":
        return _description(model, details["loc"])
    return details["msg"].removeprefix("Input should be ")


def _keys(model: type[BaseModel]) -> list[str]:
    fields = model.model_fields.items()
    return [field.alias or name for name, field in fields if not field.exclude]


def _model_at(
    model: type[BaseModel] | None, where: tuple[str | int, ...]
) -> type[BaseModel] | None:
    # Model of the table at a path of keys; None for a table with arbitrary keys
    for part in where:
        if isinstance(part, str):
            field = _field(model, part)
            model = None if field is None else _table_of(field.annotation)
    return model


def _description(model: type[BaseModel], where: tuple[str | int, ...]) -> str:
    names = [part for part in where if isinstance(part, str)]
    field = _field(_model_at(model, tuple(names[:-1])), names[-1])
    return (field and field.description) or "a value"


def _field(model: type[BaseModel] | None, key: str) -> FieldInfo | None:
    fields = {} if model is None else model.model_fields
    return next((f for name, f in fields.items() if key in (name, f.alias)), None)


def _table_of(annotation: object) -> type[BaseModel] | None:
    # Model of the table in a type annotation such as list[WindowTable]
    if get_origin(annotation) in (list, tuple, types.UnionType):
        annotation = get_args(annotation)[0]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return None
