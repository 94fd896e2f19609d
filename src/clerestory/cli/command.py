"""Commands, each declared by a *request*: a dataclass of options with `@command`.

The module that handles a request is imported when the command is called, so that
printing help imports only the modules of requests.
"""

import importlib
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from contextvars import ContextVar
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, TypeVar, dataclass_transform, get_type_hints

import typer

from clerestory.file_lock import locked
from clerestory.options import Argument, Option, description, options

# The command line being run, as recorded in the headers of files
COMMAND_LINE: ContextVar[str] = ContextVar("COMMAND_LINE", default="clerestory")

_KEY = "command"
_Request = TypeVar("_Request", bound=type)


@dataclass(frozen=True)
class Command:
    """Definition of a command of the command line.

    The docstring of the class `request` is the help text. `served_by` names the handler
    "module:function" in `clerestory.cli`, which takes a request and returns the exit
    status or None. `example` has example arguments. The help does not list `alias`.
    """

    request: type
    served_by: str
    example: str
    name: str
    alias: str

    def add_to(self, app: typer.Typer, *, group: str = "") -> None:
        """Add the command to a Typer application."""
        words = " ".join(filter(None, ("clerestory", group, self.name, self.example)))
        for name in filter(None, (self.name, self.alias)):
            added = app.command(
                name, epilog=f"Example: {words}", hidden=name == self.alias
            )
            added(self._function())

    def _function(self) -> Callable[..., int | None]:
        # Typer derives the options of a command from the signature of its function
        def call(**given: object) -> int | None:
            module, _, function = self.served_by.partition(":")
            served_by = importlib.import_module(f"clerestory.cli.{module}")
            request = _assemble(self.request, given)
            with _output_locked(given.get("output") or given.get("annual")):
                status: int | None = getattr(served_by, function)(request)
            return status

        parameters = list(_parameters(self.request))
        call.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        call.__annotations__ = {p.name: p.annotation for p in parameters}
        call.__doc__ = self.request.__doc__
        return call


@dataclass_transform(frozen_default=True, kw_only_default=True)
def command(
    served_by: str, example: str = "", *, name: str = "", alias: str = ""
) -> Callable[[_Request], _Request]:
    """Return a decorator that makes a class of options the request of a command.

    Without `name`, the command has the name of its handler function; see `Command`.
    """

    def declare(group: _Request) -> _Request:
        title = name or served_by.partition(":")[2]
        setattr(group, _KEY, Command(group, served_by, example, title, alias))
        return options(group)

    return declare


def commands_of(requests: ModuleType) -> dict[str, Command]:
    """Return the commands declared in a module of requests, by name."""
    kept = (getattr(each, _KEY, None) for each in vars(requests).values())
    return {each.name: each for each in kept if isinstance(each, Command)}


def _parameters(request: Any) -> Iterator[inspect.Parameter]:
    # One parameter with Typer annotation per option, including nested option groups
    for each, hint in _fields(request):
        if is_dataclass(hint):
            yield from _parameters(hint)
            continue
        kind, described = description(each, hint)
        required = each.default is MISSING
        yield inspect.Parameter(
            each.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if required else each.default,
            annotation=Annotated[kind, _typer_info(each.name, described)],
        )


def _assemble(request: Any, given: Mapping[str, object]) -> Any:
    # Request, with its nested option groups, from option values by name
    values = {
        each.name: _assemble(hint, given) if is_dataclass(hint) else given[each.name]
        for each, hint in _fields(request)
    }
    return request(**values)


def _output_locked(output: object) -> AbstractContextManager[None]:
    # Lock of the file or folder to write, in a folder that exists
    if isinstance(output, Path) and output.parent.is_dir():
        return locked(output)
    return nullcontext()


def _fields(request: Any) -> list[tuple[Field[Any], Any]]:
    hints = get_type_hints(request, include_extras=True)
    return [(each, hints[each.name]) for each in fields(request)]


def _typer_info(name: str, described: Option | Argument) -> Any:
    if isinstance(described, Argument):
        return typer.Argument(help=described.help, metavar=described.metavar)
    # The name "--" marks an option without a long name
    names = tuple(each for each in described.names if each != "--")
    if not any(each.startswith("--") for each in described.names):
        names = (f"--{name.replace('_', '-')}", *names)
    return typer.Option(
        *names,
        help=described.help,
        metavar=described.metavar,
        min=described.least,
        max=described.most,
        rich_help_panel=described.panel,
    )
