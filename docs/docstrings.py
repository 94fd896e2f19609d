"""Docstrings of the house for Sphinx: `name : meaning`, with types in the signature.

Sections are those of numpydoc, but a colon parts the name from what it means. Sphinx's
own readers would take the meaning for a type.
"""

import re
from collections.abc import Iterator

# Sections whose entries are names with meanings
_LISTS = ("Parameters", "Attributes", "Raises")
_ENTRY = re.compile(r"^(?P<names>[\w*.…]+(?:, ?[\w*.…]+)*) : (?P<meaning>.*)$")


def convert(
    _app: object, _kind: str, _name: str, _value: object, _options: object, lines: list
) -> None:
    """Rewrite the lines of a docstring in place as reStructuredText."""
    lines[:] = list(_converted(lines))


def _converted(lines: list[str]) -> Iterator[str]:
    section = ""
    number = 0
    while number < len(lines):
        line = lines[number]
        following = lines[number + 1] if number + 1 < len(lines) else ""
        if line and following and set(following) == {"-"}:
            section = line.strip()
            yield from ("", f".. rubric:: {section}", "")
            number += 2
            continue
        entry = _ENTRY.match(line) if section in _LISTS else None
        if entry:
            names = ", ".join(f"``{n.strip()}``" for n in entry["names"].split(","))
            yield from ("", names, f"    {entry['meaning']}")
        else:
            yield line
        number += 1
