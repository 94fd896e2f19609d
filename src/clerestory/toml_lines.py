"""Line numbers of the keys of a TOML file.

`tomllib` does not report line numbers. This scanner joins lines until `tomllib` accepts
them as one statement, and records the keys that the statement sets.
"""

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

# Path of a key: names of tables and keys, with indices for arrays
KeyPath = tuple[str | int, ...]

# Number of lines after which a statement is tried only at lines with these ends
_SHORT, _CLOSING = 20, ("]", "}", '"""', "'''")


def key_lines(text: str) -> dict[KeyPath, int]:
    r"""Return the line number of every key and table of a valid TOML text.

    Paths are tuples of table and key names, with indices for arrays of tables.

    >>> key_lines('a = 1\n[[window]]\nfile = "south.rad"\n')[("window", 0, "file")]
    3
    """
    lines = text.splitlines()
    found: dict[KeyPath, int] = {}
    elements: dict[KeyPath, int] = {}
    table: KeyPath = ()
    number = 0
    while number < len(lines):
        start, line = number, lines[number].strip()
        number += 1
        if not line or line.startswith("#"):
            continue
        if line.startswith("["):
            table = _table(line, elements)
            for parent in (table[:-1], table):
                found.setdefault(parent, start + 1)
            continue

        # Join lines until they are a complete statement
        parsed, number = _statement(lines, start)
        for path in _paths(parsed or {}):
            found.setdefault(table + path, start + 1)
    return found


def _statement(lines: list[str], start: int) -> tuple[dict[str, Any] | None, int]:
    # The statement that begins on a line, and the index of the line after it. A long
    # statement ends on a line that closes a bracket or a text
    for end in range(start + 1, len(lines) + 1):
        if end - start < _SHORT or lines[end - 1].rstrip().endswith(_CLOSING):
            parsed = _parse("\n".join(lines[start:end]))
            if parsed is not None:
                return parsed, end
    return None, len(lines)


def line_of(path: KeyPath, lines: Mapping[KeyPath, int]) -> int | None:
    """Line number of a key, or else of the innermost table that contains it."""
    while path and path not in lines:
        path = path[:-1]
    return lines[path] if path else None


def _parse(statement: str) -> dict[str, Any] | None:
    try:
        return tomllib.loads(statement)
    except tomllib.TOMLDecodeError:
        return None


def _table(header: str, elements: dict[KeyPath, int]) -> KeyPath:
    # Path of a [table] or of the next element of an [[array of tables]]
    names = next(_chain(tomllib.loads(header)))
    path: KeyPath = ()
    for name in names[:-1]:
        path = (*path, name)
        path = (*path, elements[path]) if path in elements else path
    path = (*path, names[-1])
    if header.startswith("[["):
        elements[path] = elements.get(path, -1) + 1
        return (*path, elements[path])
    return path


def _chain(tree: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    # Names in a table header, which tomllib parses into nested dictionaries
    for name, branch in tree.items():
        inner = branch[0] if isinstance(branch, list) else branch
        rest = next(_chain(inner), ())
        yield (name, *rest)


def _paths(tree: Any) -> Iterator[KeyPath]:
    # Key paths of a table or array, including nested keys
    branches: list[tuple[str | int, Any]] = []
    if isinstance(tree, dict):
        branches = list(tree.items())
    elif isinstance(tree, list):
        branches = list(enumerate(tree))
    for name, branch in branches:
        yield (name,)
        yield from ((name, *rest) for rest in _paths(branch))
