"""The whole command line: `clerestory …` with all its groups and commands."""

from typing import Annotated

import typer

from clerestory import __version__
from clerestory.cli import bsdf, glazing, gonio, luminaire, picture, sky, trace
from clerestory.cli.compare import compare
from clerestory.cli.doctor import doctor
from clerestory.cli.glare import EXAMPLE as glare_example
from clerestory.cli.glare import glare
from clerestory.cli.illum import illum
from clerestory.cli.import_model import import_model
from clerestory.cli.metrics import metrics
from clerestory.cli.multiply import multiply
from clerestory.cli.new import new
from clerestory.cli.picture_capture import calibrate, merge, reproject
from clerestory.cli.render import render
from clerestory.cli.report import report
from clerestory.cli.run import demo, run
from clerestory.cli.start import main, new_app

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
app.command(
    epilog="Example: clerestory new office --scene materials.rad room.rad"
    " --window glazing.rad --bsdf blind.xml --weather oslo.epw"
)(new)
app.command(epilog="Example: clerestory run study.toml --out results")(run)
app.command(epilog="Example: clerestory demo my_first_study")(demo)
app.command(epilog="Example: clerestory report study_results")(report)
app.command(
    epilog="Example: clerestory render --scene materials.rad room.rad --view"
    " desk.vf --sky 'gensky 9 21 12 +s -a 48 -o -11 -m -15' -o noon.hdr"
)(render)
app.command(
    epilog="Example: clerestory illum --scene materials.rad room.rad --panes window.rad"
    " --sky 'gensky 9 21 12 +s' -o lamps.rad"
)(illum)
app.command(epilog=f"Example: {glare_example}")(glare)
app.command(epilog="Example: clerestory metrics results -o metrics.csv")(metrics)
app.command(epilog="Example: clerestory compare measured.csv study_results -o found")(
    compare
)
app.command(
    "import", epilog="Example: clerestory import room.hbjson --weather oslo.epw -o room"
)(import_model)
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
