"""The command line: `clerestory …`.

Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted. Errors and warnings
are one line each on the error stream.
"""

import os
import sys
import traceback
import warnings
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from clerestory import __version__
from clerestory.cli import bsdf, glazing, gonio, luminaire, picture, sky, trace
from clerestory.cli.doctor import doctor
from clerestory.cli.glare import glare
from clerestory.cli.metrics import metrics
from clerestory.cli.multiply import multiply
from clerestory.cli.picture_capture import calibrate, merge, reproject
from clerestory.cli.render import render
from clerestory.cli.run import demo, report, run
from clerestory.errors import ClerestoryError, ClerestoryWarning

TRACEBACK = "CLERESTORY_TRACEBACK"
INTERRUPTED = 130

# Options that take every word up to the next option
_GREEDY = ("--scene", "--window")

# Typer's base of usage errors, which it does not export
_UsageError: type[Exception] = next(
    cls for cls in typer.BadParameter.__mro__ if cls.__name__ == "ClickException"
)

app = typer.Typer(
    name="clerestory",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # else units in brackets vanish from the help
    help="Annual daylight behind complex fenestration.",
)
app.add_typer(trace.app, name="trace")
app.add_typer(sky.app, name="sky")
app.add_typer(bsdf.app, name="bsdf")
app.add_typer(glazing.app, name="glazing")
app.add_typer(gonio.app, name="gonio")
app.add_typer(luminaire.app, name="luminaire")
app.add_typer(picture.app, name="picture")
picture.app.command(
    epilog="Example: clerestory picture merge bracket_*.jpg -o scene.hdr"
)(merge)
picture.app.command(
    epilog="Example: clerestory picture reproject scene.hdr --lens equisolid"
    " --circle 2736 1824 1793 -o fisheye.hdr"
)(reproject)
picture.app.command(
    epilog="Example: clerestory picture calibrate fisheye.hdr --before 1520 --after 1490"
    " -o desk.hdr"
)(calibrate)
app.command(epilog="Example: clerestory run study.toml --out results")(run)
app.command(epilog="Example: clerestory demo my_first_study")(demo)
app.command(epilog="Example: clerestory report study_results")(report)
app.command(
    epilog="Example: clerestory render --scene materials.rad room.rad --view"
    " desk.vf --sky 'gensky 9 21 12 +s -a 48 -o -11 -m -15' -o noon.hdr"
)(render)
app.command(epilog="Example: clerestory glare desk.hdr --detail --check found.hdr")(
    glare
)
app.command(epilog="Example: clerestory metrics results -o metrics.csv")(metrics)
app.command(epilog="Example: clerestory doctor")(doctor)
app.command(epilog="Example: clerestory multiply V.mtx blind.xml D.mtx S.smx -o E.mtx")(
    multiply
)


def _show_version(wanted: bool | None) -> None:
    if wanted:
        typer.echo(f"clerestory {__version__}")
        raise typer.Exit


@app.callback()
def clerestory(
    version: Annotated[
        bool | None,
        typer.Option(
            "--version",
            callback=_show_version,
            is_eager=True,
            help="Say which version this is.",
        ),
    ] = None,
) -> None:
    """Annual daylight behind complex fenestration: BSDFs, matrices, error bars."""


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
            status = app(words, prog_name="clerestory", standalone_mode=False)
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
