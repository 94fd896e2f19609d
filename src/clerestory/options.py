"""Options of commands, described by the fields of frozen dataclasses.

A request is a dataclass whose fields are `Annotated` with an `Option` or an `Argument`.
Python calls its constructor; a command line fills it from the words of a command. A
field that is itself such a dataclass is a group of options.
"""

from dataclasses import dataclass, fields
from typing import Any


@dataclass(frozen=True)
class Option:
    """Description of an option.

    Attributes
    ----------
    help : one sentence, with the unit in brackets
    names : on the command line; `--field-name` is added if none begins with two dashes,
        and a bare "--" says that there is no long name
    metavar : what stands for the value in the help
    least, most : limits of the value
    panel : heading in the help
    """

    help: str
    names: tuple[str, ...] = ()
    metavar: str | None = None
    least: float | None = None
    most: float | None = None
    panel: str | None = None


@dataclass(frozen=True)
class Argument:
    """Description of a positional argument; `metavar` stands for it in the help."""

    help: str
    metavar: str | None = None


def option(
    help: str,
    *names: str,
    metavar: str | None = None,
    least: float | None = None,
    most: float | None = None,
    panel: str | None = None,
) -> Option:
    """Return the description of an option; its names follow the help text."""
    return Option(help, names, metavar, least, most, panel)


def keywords(group: object) -> dict[str, Any]:
    """Return the fields of a dataclass as keyword arguments.

    >>> keywords(Argument("The study.", "STUDY"))
    {'help': 'The study.', 'metavar': 'STUDY'}
    """
    return {field.name: getattr(group, field.name) for field in fields(group)}  # type: ignore[arg-type]
