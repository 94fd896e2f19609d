"""Commands defined by requests: a dataclass of options and a handler function.

The module of the handler is imported when the command is called, so that printing help
imports only the requests.
"""

import importlib
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from typing import Annotated, Any, get_type_hints

import typer

from clerestory.options import Argument, Option, description


@dataclass(frozen=True)
class Command:
    """Definition of a command.

    Attributes
    ----------
    request : dataclass of the options; its docstring is the help text
    served_by : handler "module:function" in `clerestory.cli`, which takes the request
        and returns the exit status or None
    example : example of the arguments
    """

    request: type
    served_by: str
    example: str = ""
    hidden: bool = False

    def add_to(self, app: typer.Typer, name: str, *, group: str = "") -> None:
        """Add the command to a Typer application."""
        words = " ".join(filter(None, ("clerestory", group, name, self.example)))
        app.command(name, epilog=f"Example: {words}", hidden=self.hidden)(
            self._function()
        )

    def _function(self) -> Callable[..., int | None]:
        # Typer derives the options from the signature
        def call(**given: object) -> int | None:
            module, _, function = self.served_by.partition(":")
            served_by = importlib.import_module(f"clerestory.cli.{module}")
            status: int | None = getattr(served_by, function)(
                assemble(self.request, given)
            )
            return status

        parameters = list(option_parameters(self.request))
        call.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        call.__annotations__ = {p.name: p.annotation for p in parameters}
        call.__doc__ = self.request.__doc__
        return call


def option_parameters(request: Any) -> Iterator[inspect.Parameter]:
    """Yield a parameter with Typer annotation per field, nested requests expanded.

    Examples
    --------
    >>> from clerestory.options import option
    >>> @dataclass(frozen=True)
    ... class Sun:
    ...     size: float = option(0.533, "Diameter [°].", metavar="DEG")
    >>> [(p.name, p.default) for p in option_parameters(Sun)]
    [('size', 0.533)]
    """
    for each, hint in _fields(request):
        if is_dataclass(hint):
            yield from option_parameters(hint)
            continue
        kind, described = description(each, hint)
        required = each.default is MISSING
        yield inspect.Parameter(
            each.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if required else each.default,
            annotation=Annotated[kind, _typer_info(each.name, described)],
        )


def assemble(request: Any, given: Mapping[str, object]) -> Any:
    """Return a request with the given values by name, including nested requests."""
    values = {
        each.name: assemble(hint, given) if is_dataclass(hint) else given[each.name]
        for each, hint in _fields(request)
        if is_dataclass(hint) or each.name in given
    }
    return request(**values)


def _fields(request: Any) -> list[tuple[Field[Any], Any]]:
    hints = get_type_hints(request, include_extras=True)
    return [(each, hints[each.name]) for each in fields(request)]


def _typer_info(name: str, described: Option | Argument) -> Any:
    if isinstance(described, Argument):
        return typer.Argument(help=described.help, metavar=described.metavar)
    # The name "--" marks an option without long name
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
