"""`clerestory luminaire`: what photometric files say, and their polar diagrams."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.errors import InputError
from clerestory.files import replace_file
from clerestory.formats.photometry.luminaire import Luminaire
from clerestory.formats.photometry.read import read_luminaire
from clerestory.report.luminaire_plot import polar_figure

app = typer.Typer(no_args_is_help=True, help="Luminaires: IES and EULUMDAT files.")

_PICTURES = (".png", ".svg", ".pdf")

# Keywords worth a line, and what they are called here
_SHOWN = {"MANUFAC": "maker", "LUMINAIRE": "luminaire", "LAMP": "lamp"}


@app.command(epilog="Example: clerestory luminaire info downlight.ies panel.ldt")
def info(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE…", help="IES or EULUMDAT files.")
    ],
) -> None:
    """Say what photometric files hold: flux, power, intensities, the shining body."""
    for file in files:
        for line in _lines(file, read_luminaire(file)):
            typer.echo(line)


@app.command(epilog="Example: clerestory luminaire plot downlight.ies -o polar.png")
def plot(
    file: Annotated[Path, typer.Argument(help="IES or EULUMDAT file.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Picture: .png, .svg or .pdf.")
    ],
    plane: Annotated[
        list[float] | None,
        typer.Option("--plane", help="Horizontal angle [°]; may be repeated."),
    ] = None,
) -> None:
    """Draw the polar diagram, in the planes of 0° and 90° or in those named."""
    kind = output.suffix.lower()
    if kind not in _PICTURES:
        raise InputError(
            f"picture {output.name!r}; a name in {', '.join(_PICTURES)} expected"
        )
    figure = polar_figure(read_luminaire(file), planes_deg=plane or (0.0, 90.0))
    with replace_file(output) as stream:
        figure.savefig(stream, format=kind[1:], dpi=150)


def _lines(file: Path, luminaire: Luminaire) -> list[str]:
    shape, flux = luminaire.shape, luminaire.flux()
    lines = [f"{file}: {luminaire.name}"]
    for keyword, word in _SHOWN.items():
        if luminaire.keywords.get(keyword):
            lines.append(f"  {word}: {luminaire.keywords[keyword]}")
    light = f"  flux: {flux:.0f} lm"
    if luminaire.lamp_lumens:
        share = flux / luminaire.lamp_lumens
        light += f", {share:.1%} of the {luminaire.lamp_lumens:.0f} lm of its lamps"
    if luminaire.watts > 0:
        light += f"; {luminaire.watts:g} W, {flux / luminaire.watts:.0f} lm/W"
    horizontal, vertical = luminaire.intensity.shape
    lines.append(light)
    lines.append(
        f"  intensity: type {luminaire.photometry}, up to"
        f" {luminaire.intensity.max():.0f} cd; {horizontal} horizontal × {vertical}"
        " vertical angles"
    )
    lines.append(f"  body: {shape.kind} {shape.x:g} × {shape.y:g} × {shape.z:g} m")
    return lines
