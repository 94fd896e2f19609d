"""The whole command line: `clerestory …` with all its groups and commands."""

from typing import Annotated

import typer

from clerestory import __version__
from clerestory.cli import bsdf, glazing, gonio, luminaire, picture, sky, trace
from clerestory.cli.picture_capture import calibrate, merge, reproject
from clerestory.cli.start import COMMANDS, main, new_app

__all__ = ["app", "main"]

app = new_app()
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
    epilog="Example: clerestory picture calibrate fisheye.hdr --before 1520"
    " --after 1490 -o desk.hdr"
)(calibrate)
for name, command in COMMANDS.items():
    command.add_to(app, name)


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
