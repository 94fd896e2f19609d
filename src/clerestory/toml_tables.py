"""TOML files with tables checked by pydantic.

Every error names the line, the key, its value and the expected value.
"""

import json
import math
import re
import tomllib
import types
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.toml_lines import key_lines, line_of


class Table(BaseModel):
    """A table of a TOML file; unknown keys and wrong types are errors."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False
    )


Model = TypeVar("Model", bound=BaseModel)

# Expected value for each type of pydantic error, with the limits in {…}
_EXPECTED = {
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "finite_number": "a number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "list_type": "a list in [ ]",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "too_short": "at least one",
}


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Raises
    ------
    InputError : the file cannot be read or is not TOML, with the line
    """
    return _parsed(read_text(path), path)


def read_table(
    model: type[Model], path: str | Path, context: dict[str, Any] | None = None
) -> Model:
    """Return the contents of a TOML file as a pydantic model.

    Parameters
    ----------
    context : values for the validators of the model

    Raises
    ------
    InputError : the file cannot be read, is not TOML, or a key is missing, unknown or
        wrong; with the line, and the valid choices
    """
    text = read_text(path)
    tables = _parsed(text, path)
    try:
        return model.model_validate(tables, context=context)
    except ValidationError as error:
        lines = key_lines(text)

        def place(details: ErrorDetails) -> float:
            return line_of(details["loc"], lines) or math.inf

        first, *others = sorted(error.errors(), key=place)
        message = _message(first, model)
        if others:
            message += f" (and {len(others)} more)"
        line = line_of(first["loc"], lines)
        raise InputError(message, file=path, line=line) from error


def _parsed(text: str, path: str | Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        reason = str(error)
        place = re.search(r" \(at line (\d+), column \d+\)$", reason)
        line = int(place[1]) if place else len(text.splitlines())
        reason = re.sub(r" \(at .*\)$", "", reason)
        raise InputError(f"not TOML: {reason}", file=path, line=line) from error
    except (ValueError, RecursionError) as error:
        message = "not TOML: a number is too long, or values are nested too deeply"
        raise InputError(message, file=path) from error


def _message(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, where, value = details["type"], details["loc"], details["input"]
    key = ".".join(str(part) for part in where if isinstance(part, str))
    if kind == "missing":
        return f'key "{key}" is missing; {_description(model, where)} expected'
    if kind == "extra_forbidden":
        table = _model_at(model, where[:-1])
        names = ", ".join(_keys(table)) if table else "the documented keys"
        return f'unknown key "{key}"; one of {names} expected'
    if kind == "rule":
        return f"[{key}]: {details['msg']}" if key else str(details["msg"])
    return f'key "{key}": got {_shown(value)}; {_expected(details, model)} expected'


def _expected(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, limits = details["type"], details.get("ctx", {})
    if kind == "literal_error":
        return str(limits["expected"]).replace("'", '"')
    if kind in _EXPECTED:
        return _EXPECTED[kind].format(**limits)
    if kind == "string_pattern_mismatch":
        return _description(model, details["loc"])
    return details["msg"]


def _shown(value: Any) -> str:
    # Value in the file, abbreviated
    shown = json.dumps(value, default=str, ensure_ascii=False)
    return shown if len(shown) <= 60 else shown[:57] + "…"


def _keys(model: type[BaseModel]) -> list[str]:
    fields = model.model_fields.items()
    return [field.alias or name for name, field in fields if not field.exclude]


def _model_at(
    model: type[BaseModel] | None, where: tuple[str | int, ...]
) -> type[BaseModel] | None:
    # Table class at a path of keys; None for tables with keys of any name
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
    # Table class in an annotation such as list[WindowTable]
    if get_origin(annotation) in (list, types.UnionType):
        annotation = get_args(annotation)[0]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return None
