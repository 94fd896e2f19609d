"""Overrides of keys of a study file, with the line of each key for error messages.

An override is a table with the structure of the study file. Tables are merged, and any
other value replaces that of the study. A table in place of a list of tables, such as
`window.south.bsdf`, changes the table of that name; without a name, as `window.bsdf`,
it changes all tables of the list. A table with a key `rule` replaces the whole table,
since the keys of a control rule depend on the rule.
"""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

from clerestory.escaping import printable
from clerestory.toml_lines import KeyPath

_RULE = "rule"


@dataclass(frozen=True)
class LinedTables:
    """Tables of a TOML file, and the line number of each key."""

    tables: Mapping[str, Any]
    lines: Mapping[KeyPath, int]

    def part(self, *path: str | int, at: KeyPath = ()) -> "LinedTables":
        """Return a table at a path, or any value, then as the only value at path `at`.

        >>> study = LinedTables({"a": [1, 2]}, {("a",): 1, ("a", 1): 1})
        >>> study.part("a", 1, at=("b", "c"))
        LinedTables(tables={'b': {'c': 2}}, lines={('b', 'c'): 1})
        """
        value: Any = self.tables
        for key in path:
            value = value[key]
        for key in reversed(at):
            value = {key: value}
        inside = {p: n for p, n in self.lines.items() if p[: len(path)] == path}
        lines = {(*at, *p[len(path) :]): n for p, n in inside.items()}
        return LinedTables(value, lines)

    def overridden(self, change: "LinedTables") -> "LinedTables":
        """Return the tables with the keys of another table in place of their own."""
        made = deepcopy(dict(self.tables)), dict(self.lines)
        _merge(*made, (), change.tables, (), change.lines)
        return LinedTables(*made)

    def replaced(self, words: Mapping[str, str | float]) -> "LinedTables":
        """Return the tables with values in place of `{name}` in all texts.

        A text that is `{name}` alone becomes the value, which may be a number.

        >>> study = LinedTables({"file": "blind_{tilt}.xml"}, {})
        >>> study.replaced({"tilt": 45}).tables
        {'file': 'blind_45.xml'}
        """
        return LinedTables(_replaced(self.tables, words), self.lines)

    def mentions(self, name: str) -> bool:
        """Whether a text in the tables contains `{name}`."""
        return any(f"{{{name}}}" in text for text in _texts(self.tables))


def _merge(
    table: dict[str, Any],
    lines: dict[KeyPath, int],
    path: KeyPath,
    change: Mapping[str, Any],
    source: KeyPath,
    source_lines: Mapping[KeyPath, int],
) -> None:
    # Override keys of the table at `path` by those of the table at `source`
    for key, value in change.items():
        here, there, old = (*path, key), (*source, key), table.get(key)
        parts: list[tuple[dict[str, Any], KeyPath, Mapping[str, Any], KeyPath]] = []
        if isinstance(value, Mapping) and isinstance(old, dict) and _RULE not in value:
            parts = [(old, here, value, there)]
        elif isinstance(value, Mapping) and are_tables(old):
            parts = [
                (old[number], (*here, number), own, own_source)
                for number, own, own_source in _of_tables(old, value, there)
            ]
        else:
            table[key] = deepcopy(value)
            for known in [p for p in lines if p[: len(here)] == here]:
                del lines[known]
            for p, number in source_lines.items():
                if p[: len(there)] == there:
                    lines[(*here, *p[len(there) :])] = number
        for own, own_path, own_change, own_source in parts:
            _merge(own, lines, own_path, own_change, own_source, source_lines)


def are_tables(values: Any) -> TypeGuard[list[dict[str, Any]]]:
    """Whether a value is a list of tables."""
    listed = isinstance(values, list) and bool(values)
    return listed and all(isinstance(value, dict) for value in values)


def _of_tables(
    tables: list[Any], change: Mapping[str, Any], source: KeyPath
) -> Iterator[tuple[int, Mapping[str, Any], KeyPath]]:
    # Index of each changed table of a list, its override, and the path of the override
    labels = [_label(table) for table in tables]
    named = [key for key in change if key in labels]
    if named and all(isinstance(own, Mapping) for own in change.values()):
        for name in named:
            yield labels.index(name), change[name], (*source, name)
        return
    for number in range(len(tables)):
        yield number, change, source


def _label(table: Mapping[str, Any]) -> str:
    # Name of a table, by default the stem of the name of its file
    file = table.get("file", table.get("bsdf", ""))
    stem = printable(Path(file).stem) if isinstance(file, str) else ""
    return str(table.get("name") or stem)


def _replaced(value: Any, words: Mapping[str, str | float]) -> Any:
    if isinstance(value, Mapping):
        return {key: _replaced(own, words) for key, own in value.items()}
    if isinstance(value, list):
        return [_replaced(own, words) for own in value]
    if not isinstance(value, str):
        return value
    for name, word in words.items():
        if value == f"{{{name}}}":
            return word
        value = value.replace(f"{{{name}}}", str(word))
    return value


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        parts = value.values() if isinstance(value, Mapping) else value
        for part in parts:
            yield from _texts(part)
