"""Entry point of `clerestory`: runs a command, prints errors, returns the exit status.

Exit status: 0 done, 1 failed, 2 bad input; 130, 143 or 129 interrupted by SIGINT,
SIGTERM or SIGHUP. Errors and warnings are one line each on the error stream.
"""

import importlib
import os
import re
import shlex
import sys
import traceback
import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import typer

from clerestory import __version__
from clerestory.cli.command import COMMAND_LINE
from clerestory.cli.interruption import Interruption, interruptible
from clerestory.cli.program import program
from clerestory.errors import ClerestoryError, ClerestoryWarning
from clerestory.files import is_file
from clerestory.warning_log import WarningLog

TRACEBACK = "CLERESTORY_TRACEBACK"

# Exit status that Typer returns after `KeyboardInterrupt`
_SIGINT = 130

# Largest number of characters of an error message, with its path
_LONGEST = 500

# Parts of a message that can quote a file
_QUOTED = re.compile(r"\"[^\"]*\"?|(?<!\w)'[^']*'?")
_VALUE = re.compile(r"\bis [^;]+")

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
    log = WarningLog()
    with warnings.catch_warnings():
        warnings.simplefilter("always", ClerestoryWarning)
        warnings.showwarning = partial(_show_warning, log)
        try:
            with interruptible() as received:
                status = _run(given, words)
            return _interrupted(received) if status == _SIGINT else int(status or 0)
        except (KeyboardInterrupt, typer.Abort):
            return _interrupted(received)
        except Exception as error:
            # Mitsuba and Dr.Jit convert `KeyboardInterrupt` to other errors
            if received.happened:
                return _interrupted(received)
            return _failed(error, words)
        finally:
            for line in log.repeated():
                typer.echo(f"warning: {line}", err=True)


def _run(given: list[str], words: list[str]) -> int | None:
    # The programs of `compat` read their words themselves
    if given[:1] == ["compat"] and given[1:] and not given[1].startswith("-"):
        compat = importlib.import_module("clerestory.cli.compat")
        return int(compat.run_compat(given[1], given[2:]))
    status: int | None = program(words)(
        words, prog_name="clerestory", standalone_mode=False
    )
    return status


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


def _show_warning(
    log: WarningLog, message: Warning | str, *_place: Any, **_more: Any
) -> None:
    # Show the first warning of each kind; the others are counted
    text = _one_line(str(message))
    if log.add(text):
        typer.echo(f"warning: {text}", err=True)


def _failed(error: Exception, words: list[str]) -> int:
    # Print an error; return the exit status
    if isinstance(error, ClerestoryError):
        return _fail(_own_text(error, words), error.exit_status, error)
    if isinstance(error, _UsageError):
        return _usage(error)
    kind = type(error).__name__
    text = f"unexpected {kind}: {error}; set {TRACEBACK}=1 for the traceback"
    return _fail(text, 1, error)


def _usage(error: Any) -> int:
    # Print a usage error of Typer in one line that refers to the help of the command
    if type(error).__name__ == "NoArgsIsHelpError":
        error.show()
        return int(error.exit_code)
    path = error.ctx.command_path if getattr(error, "ctx", None) else "clerestory"
    text = f"{_one_line(error.format_message())} (see {path} --help)"
    return _fail(text, int(error.exit_code), error)


def _own_text(error: ClerestoryError, words: list[str]) -> str:
    # Message of an error. Quoted words are removed if they are from a file that only
    # another file names, outside of the folders of the files on the command line
    file = getattr(error, "file", None)
    if file is None or not is_file(file):
        return str(error)
    named = (Path(part) for word in words for part in word.split("=")[-1:])
    folders = [Path.cwd(), *(path.resolve().parent for path in named if is_file(path))]
    if any(Path(file).resolve().is_relative_to(folder) for folder in folders):
        return str(error)
    message = getattr(error, "message", "")
    place = str(error).removesuffix(message)
    fault = _VALUE.sub("is …", _QUOTED.sub("…", message.partition(";")[0]))
    return f"{place}{fault} (words of files outside the project are hidden)"


def _fail(text: str, status: int, error: BaseException) -> int:
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)
    line = _one_line(text)
    if len(line) > _LONGEST:
        line = f"{line[: _LONGEST // 3]}…{line[-_LONGEST // 2 :]}"
    typer.echo(line, err=True)
    return status


def _interrupted(received: Interruption) -> int:
    typer.echo("interrupted; run again to resume", err=True)
    return received.status()


def _one_line(text: str) -> str:
    return " ".join(text.split())
