"""Objects of EnergyPlus' input, and files of them: IDF text or epJSON.

An object has a class, a name and fields in the order of EnergyPlus' data dictionary,
with the names of epJSON. Fields without value keep their default.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import final

from clerestory.checks import require
from clerestory.escaping import header_line, radiance_name
from clerestory.files import write_text

Value = str | float | int | None

# Digits of numbers; EnergyPlus reads at most some 100 characters for each field
_DIGITS = 9


@final
@dataclass(frozen=True)
class InputObject:
    """An object of EnergyPlus' input.

    Attributes
    ----------
    kind : class, such as "WindowMaterial:Gap"
    name : name of the object
    fields : values by field name, in the order of the data dictionary
    values : numbers of a list that follows the fields, such as those of a matrix
    """

    kind: str
    name: str
    fields: Mapping[str, Value]
    values: tuple[float, ...] = ()


def write_objects(
    path: str | Path, objects: Iterable[InputObject], *, comment: str = ""
) -> None:
    """Write objects to a file, epJSON if it ends so and else IDF text.

    Raises
    ------
    InputError : two objects of one class have names that differ in case only
    OutputError : the file cannot be written
    """
    listed = list(objects)
    names = [(one.kind, one.name.casefold()) for one in listed]
    double = next((name for name in names if names.count(name) > 1), None)
    require(
        double is None, f"two objects {double}; different names expected", file=path
    )
    if Path(path).suffix.lower() == ".epjson":
        write_text(path, f"{json.dumps(as_json(listed), indent=1)}\n")
    else:
        write_text(path, as_idf(listed, comment=comment))


def as_idf(objects: Iterable[InputObject], *, comment: str = "") -> str:
    """Return objects as IDF text.

    >>> gas = InputObject("WindowMaterial:Gas", "air", {"gas_type": "Air"})
    >>> print(as_idf([gas]), end="")
    WindowMaterial:Gas,
      air,                       !- name
      Air;                       !- gas_type
    """
    parts = [f"! {header_line(comment)}\n"] if comment else []
    return "\n".join([*parts, *(_idf_object(one) for one in objects)])


def _idf_object(one: InputObject) -> str:
    rows = list(_rows(one))
    while rows[-1][0] == "":  # the last fields may be left out
        rows.pop()
    marks = "," * (len(rows) - 1) + ";"
    lines = [f"{one.kind},"]
    for (text, note), mark in zip(rows, marks, strict=True):
        lines.append(f"  {text + mark:26} !- {note}" if note else f"  {text}{mark}")
    return "\n".join(lines) + "\n"


def _rows(one: InputObject) -> Iterator[tuple[str, str]]:
    yield one.name, "name"
    for name, value in one.fields.items():
        yield _text(value), name
    for number in one.values:
        yield _text(number), ""


def _text(value: Value) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else f"{value:.{_DIGITS}g}"


def as_json(objects: Iterable[InputObject]) -> dict[str, dict[str, object]]:
    """Return objects as the members of an epJSON document."""
    document: dict[str, dict[str, object]] = {}
    for one in objects:
        members: dict[str, object] = {
            name: value for name, value in one.fields.items() if value is not None
        }
        if one.values:
            members["values"] = [{"value": float(_text(n))} for n in one.values]
        document.setdefault(one.kind, {})[one.name] = members
    return document


def object_name(text: str) -> str:
    """Return a name that EnergyPlus reads, without comma, semicolon and "!".

    >>> object_name("clear, 3 mm; low-e")
    'clear=2C=203=20mm=3B=20low-e'
    """
    return radiance_name(text).replace(",", "=2C")
