"""Entry point of `clerestory`: runs a command, prints errors, returns the exit status.

Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted. Errors and warnings are one
line each on the error stream.
"""

import os
import shlex
import sys
import traceback
import warnings
from collections.abc import Sequence
from typing import Any

import typer

from clerestory import __version__
from clerestory.cli.command import COMMAND_LINE
from clerestory.cli.program import program
from clerestory.errors import ClerestoryError, ClerestoryWarning

TRACEBACK = "CLERESTORY_TRACEBACK"
INTERRUPTED = 130

# Options that take all words up to the next option
_GREEDY = ("--scene", "--window")

# Base class of usage errors; Typer does not export this class
_UsageError: type[Exception] = next(
    cls for cls in typer.BadParameter.__mro__ if cls.__name__ == "ClickException"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default `sys.argv`; return the exit status."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    words = spread(given)
    if words == ["--version"]:
        typer.echo(f"clerestory {__version__}")
        return 0
    COMMAND_LINE.set(shlex.join(["clerestory", *given]))
    with warnings.catch_warnings():
        warnings.simplefilter("always", ClerestoryWarning)
        warnings.showwarning = _show_warning
        try:
            status = program(words)(
                words, prog_name="clerestory", standalone_mode=False
            )
            return _interrupted() if status == INTERRUPTED else int(status or 0)
        except ClerestoryError as error:
            return _fail(str(error), error.exit_status, error)
        except (KeyboardInterrupt, typer.Abort):
            return _interrupted()
        except _UsageError as error:
            return _usage(error)
        except Exception as error:  # unexpected errors
            kind = type(error).__name__
            text = f"unexpected {kind}: {error}; set {TRACEBACK}=1 for the traceback"
            return _fail(text, 1, error)


def spread(words: list[str]) -> list[str]:
    """Repeat --scene or --window before each of the files that follow it.

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
    # Print a usage error of Typer in one line that refers to the help of the command
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
