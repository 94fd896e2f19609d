"""Error messages of study files: key, line, value and expected value."""

import json
import math
import re
import tomllib
import types
from pathlib import Path
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from clerestory.errors import InputError
from clerestory.study.toml_lines import key_lines, line_of

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


def parse_toml(text: str, *, file: Path) -> dict[str, Any]:
    """Return the tables of a TOML text."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        reason = str(error)
        place = re.search(r" \(at line (\d+), column \d+\)$", reason)
        line = int(place[1]) if place else len(text.splitlines())
        reason = re.sub(r" \(at .*\)$", "", reason)
        raise InputError(f"not valid TOML: {reason}", file=file, line=line) from error


def input_error(
    error: ValidationError, *, model: type[BaseModel], text: str, file: Path
) -> InputError:
    """Return an InputError for the first pydantic error in the file."""
    lines = key_lines(text)

    def place(details: ErrorDetails) -> float:
        return line_of(details["loc"], lines) or math.inf

    complaints = sorted(error.errors(), key=place)
    first = complaints[0]
    message = _message(first, model)
    if len(complaints) > 1:
        message += f" (and {len(complaints) - 1} more)"
    return InputError(message, file=file, line=line_of(first["loc"], lines))


def _message(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, where, value = details["type"], details["loc"], details["input"]
    key = ".".join(str(part) for part in where if isinstance(part, str))
    if kind == "missing":
        return f'key "{key}" is missing; {_description(model, where)} expected'
    if kind == "extra_forbidden":
        names = ", ".join(_keys(_model_at(model, where[:-1])))
        return f'unknown key "{key}"; one of {names} expected'
    if kind == "rule":
        table = f"[{key}]: " if key else ""
        return f"{table}{details['msg']}"
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


def _model_at(model: type[BaseModel], where: tuple[str | int, ...]) -> type[BaseModel]:
    # Table class at a path of keys
    for part in where:
        if isinstance(part, str):
            model = _table_of(_field(model, part).annotation) or model
    return model


def _description(model: type[BaseModel], where: tuple[str | int, ...]) -> str:
    names = [part for part in where if isinstance(part, str)]
    field = _field(_model_at(model, tuple(names[:-1])), names[-1])
    return field.description or "a value"


def _field(model: type[BaseModel], key: str) -> Any:
    fields = model.model_fields
    return next(field for name, field in fields.items() if key in (name, field.alias))


def _table_of(annotation: Any) -> type[BaseModel] | None:
    # Table class in an annotation such as list[WindowTable]
    if get_origin(annotation) in (list, types.UnionType):
        annotation = get_args(annotation)[0]
    is_table = isinstance(annotation, type) and issubclass(annotation, BaseModel)
    return annotation if is_table else None
