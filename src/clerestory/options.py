"""Command-line options, declared as fields of frozen dataclasses.

The options and arguments of a command are one dataclass, constructed in Python or
parsed from a command line. A field whose type is such a dataclass is a group of
options. Types shared by several commands are `Annotated` with an `Option`; all other
fields are declared by `option`.
"""

from dataclasses import MISSING, Field, dataclass, field
from typing import Any, TypeVar, dataclass_transform, get_args

_KEY = "option"
_Class = TypeVar("_Class", bound=type)


class Option:
    """Description of an option; the help text is one sentence, with units in brackets.

    Unless a name begins with two dashes, the name of the field is added as a long
    option; the name "--" prevents this addition. `metavar` is the placeholder of the
    value in the help text, `panel` the heading of a group of options.
    """

    def __init__(
        self,
        help: str,
        *names: str,
        metavar: str | None = None,
        least: float | None = None,
        most: float | None = None,
        panel: str | None = None,
    ) -> None:
        self.help, self.names, self.metavar = help, names, metavar
        self.least, self.most, self.panel = least, most, panel


@dataclass(frozen=True)
class Argument:
    """Help text and placeholder of a positional argument."""

    help: str
    metavar: str | None = None


@dataclass_transform(frozen_default=True, kw_only_default=True)
def options(group: _Class) -> _Class:
    """Turn a class of options into a frozen dataclass with keyword arguments."""
    dataclass(frozen=True, kw_only=True)(group)
    return group


def option(default: object, help: str, *names: str, **details: Any) -> Any:
    """Return a dataclass field that is an option with a default; see `Option`."""
    return field(default=default, metadata={_KEY: Option(help, *names, **details)})


def required(help: str, *names: str, **details: Any) -> Any:
    """Return a dataclass field that is a required option; see `Option`."""
    return option(MISSING, help, *names, **details)


def argument(help: str, metavar: str | None = None, *, default: Any = MISSING) -> Any:
    """Return a dataclass field that is a positional argument."""
    return field(default=default, metadata={_KEY: Argument(help, metavar)})


def description(each: "Field[Any]", hint: Any) -> tuple[Any, Option | Argument]:
    """Return the type of a field and its `Option` or `Argument`, from the type hint."""
    if _KEY in each.metadata:
        return hint, each.metadata[_KEY]
    kind, described = get_args(hint)
    return kind, described
