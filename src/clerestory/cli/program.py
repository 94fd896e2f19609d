"""Commands and groups of `clerestory`, loaded on demand."""

import importlib
from types import ModuleType
from typing import Annotated

import typer

from clerestory import __version__
from clerestory.cli.command import commands_of

# Module of requests for each command outside groups, in the order of the help
_TOP = {
    "new": "study",
    "run": "study",
    "demo": "study",
    "report": "study",
    "view": "study",
    "render": "render",
    "irradiance": "render",
    "illum": "render",
    "glare": "glare",
    "metrics": "study",
    "compare": "study",
    "calibrate": "calibration",
    "optimise": "calibration",
    "import": "study",
    "recipe": "study",
    "doctor": "study",
    "multiply": "render",
    "compat": "compat",
}
_GROUPS = ("trace", "sky", "bsdf", "glazing", "gonio", "luminaire", "picture")


def program(words: list[str] | None = None) -> typer.Typer:
    """Return the Typer application; with `words`, only what a command line needs.

    If the first word names a command or a group, only that one is loaded. Otherwise,
    groups are added without their commands.
    """
    app = typer.Typer(
        name="clerestory",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode="markdown",  # "rich" deletes units in square brackets
        help="Annual daylight simulation of rooms with complex fenestration.",
    )
    app.callback()(_version_option)
    first = words[0] if words else ""
    alone = first in _TOP or first in _GROUPS
    for name, module in _TOP.items():
        if name == first or not alone:
            commands_of(_requests(module))[name].add_to(app)
    for group in _GROUPS:
        if group == first or not alone:
            _add_group(app, group, empty=words is not None and not alone)
    return app


def _add_group(app: typer.Typer, name: str, *, empty: bool) -> None:
    requests = _requests(name)
    group = typer.Typer(no_args_is_help=True, help=requests.HELP)
    for command in () if empty else commands_of(requests).values():
        command.add_to(group, group=name)
    app.add_typer(group, name=name)


def _requests(module: str) -> ModuleType:
    return importlib.import_module(f"clerestory.cli.requests.{module}")


def _show_version(wanted: bool | None) -> None:
    if wanted:
        typer.echo(f"clerestory {__version__}")
        raise typer.Exit


def _version_option(
    version: Annotated[
        bool | None,
        typer.Option(
            "--version",
            callback=_show_version,
            is_eager=True,
            help="Print the version.",
        ),
    ] = None,
) -> None:
    """Annual daylight simulation of rooms with complex fenestration."""
