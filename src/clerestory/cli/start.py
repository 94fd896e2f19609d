"""Where `clerestory …` starts: run one command, and turn what goes wrong into words.

Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted. Errors and warnings are one
line each on the error stream. A group or command named below is loaded alone; all the
others together take seconds.
"""

import importlib
import os
import sys
import traceback
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import typer

from clerestory.errors import ClerestoryError, ClerestoryWarning

TRACEBACK = "CLERESTORY_TRACEBACK"
INTERRUPTED = 130

# Options that take every word up to the next option
_GREEDY = ("--scene", "--window")

# Groups that are whole in a module of their own
_GROUPS = {
    name: f"clerestory.cli.{name}"
    for name in ("trace", "sky", "bsdf", "glazing", "gonio")
}


@dataclass(frozen=True)
class Command:
    """A command of its own, and where to find it.

    Attributes
    ----------
    module : of `clerestory.cli`
    function : in it
    example : of its use
    """

    module: str
    function: str
    example: str

    def add_to(self, app: typer.Typer, name: str) -> None:
        """Load the command and add it to a program."""
        module = importlib.import_module(f"clerestory.cli.{self.module}")
        app.command(name, epilog=f"Example: clerestory {name} {self.example}".rstrip())(
            getattr(module, self.function)
        )


# In the order of the help
COMMANDS = {
    "new": Command(
        "new",
        "new",
        "office --scene materials.rad room.rad --window glazing.rad --bsdf blind.xml"
        " --weather oslo.epw",
    ),
    "run": Command("run", "run", "study.toml --out results"),
    "demo": Command("run", "demo", "my_first_study"),
    "report": Command("report", "report", "study_results"),
    "render": Command(
        "render",
        "render",
        "--scene materials.rad room.rad --view desk.vf"
        " --sky 'gensky 9 21 12 +s -a 48 -o -11 -m -15' -o noon.hdr",
    ),
    "illum": Command(
        "illum",
        "illum",
        "--scene materials.rad room.rad --panes window.rad"
        " --sky 'gensky 9 21 12 +s' -o lamps.rad",
    ),
    "glare": Command("glare", "glare", "desk.hdr --detail --check found.hdr"),
    "metrics": Command("metrics", "metrics", "results -o metrics.csv"),
    "compare": Command("compare", "compare", "measured.csv study_results -o found"),
    "import": Command(
        "import_model", "import_model", "room.hbjson --weather oslo.epw -o room"
    ),
    "doctor": Command("doctor", "doctor", ""),
    "multiply": Command("multiply", "multiply", "V.mtx blind.xml D.mtx S.smx -o E.mtx"),
}

# Typer's base of usage errors, which it does not export
_UsageError: type[Exception] = next(
    cls for cls in typer.BadParameter.__mro__ if cls.__name__ == "ClickException"
)


def new_app() -> typer.Typer:
    """Return the program without any command."""
    return typer.Typer(
        name="clerestory",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode="markdown",  # else units in brackets vanish from the help
        help="Annual daylight behind complex fenestration.",
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Parameters
    ----------
    arguments : those after the program's name; of this process if not given
    """
    words = spread(list(sys.argv[1:] if arguments is None else arguments))
    with warnings.catch_warnings():
        warnings.simplefilter("always", ClerestoryWarning)
        warnings.showwarning = _show_warning
        try:
            status = _app_for(words)(
                words, prog_name="clerestory", standalone_mode=False
            )
            return _interrupted() if status == INTERRUPTED else int(status or 0)
        except ClerestoryError as error:
            return _fail(str(error), error.exit_status, error)
        except (KeyboardInterrupt, typer.Abort):
            return _interrupted()
        except _UsageError as error:
            return _usage(error)
        except Exception as error:  # the last line of defence
            kind = type(error).__name__
            text = f"unexpected {kind}: {error}; set {TRACEBACK}=1 to see where"
            return _fail(text, 1, error)


def _app_for(words: list[str]) -> typer.Typer:
    # The group or command that the first word names, or the whole program
    first = words[0] if words else ""
    app = new_app()
    if first in _GROUPS:
        app.add_typer(importlib.import_module(_GROUPS[first]).app, name=first)
    elif first in COMMANDS:
        app.callback()(_program)
        COMMANDS[first].add_to(app, first)
    else:
        app = importlib.import_module("clerestory.cli.main").app
    return app


def _program() -> None:
    # With it, a program of one command still wants the command's name
    pass


def spread(words: list[str]) -> list[str]:
    """Repeat an option that takes several files before each of them.

    >>> spread(["--scene", "a.rad", "b.rad", "-o", "V.mtx"])
    ['--scene', 'a.rad', '--scene', 'b.rad', '-o', 'V.mtx']
    """
    result: list[str] = []
    option = ""
    for word in words:
        if word.startswith("-"):
            option = word if word in _GREEDY else ""
            result += [] if option else [word]
        else:
            result += [option, word] if option else [word]
    return result


def _show_warning(message: Warning | str, *_place: Any, **_more: Any) -> None:
    typer.echo(f"warning: {_one_line(str(message))}", err=True)


def _usage(error: Any) -> int:
    # Typer's own complaints: one line, and where help is found
    if type(error).__name__ == "NoArgsIsHelpError":
        error.show()
        return int(error.exit_code)
    path = error.ctx.command_path if getattr(error, "ctx", None) else "clerestory"
    text = f"{_one_line(error.format_message())} (see {path} --help)"
    return _fail(text, int(error.exit_code), error)


def _fail(text: str, status: int, error: BaseException) -> int:
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)
    typer.echo(_one_line(text), err=True)
    return status


def _interrupted() -> int:
    typer.echo("interrupted; run again to resume", err=True)
    return INTERRUPTED


def _one_line(text: str) -> str:
    return " ".join(text.split())
