"""Requests of `clerestory luminaire`: photometric files."""

from pathlib import Path

from clerestory.cli.command import command
from clerestory.cli.requests.common import FigureOutput
from clerestory.options import argument, option

HELP = "Luminaires: IES and EULUMDAT files."


@command("luminaire:info", "downlight.ies panel.ldt")
class LuminaireInfo:
    """Describe photometric files: flux, power, intensities, luminous dimensions."""

    files: list[Path] = argument("IES or EULUMDAT files.", "FILE…")


@command("luminaire:plot", "downlight.ies -o polar.png")
class PlotLuminaire:
    """Draw the polar diagram in given planes; default: 0° and 90°."""

    file: Path = argument("IES or EULUMDAT file.")
    output: FigureOutput
    plane: list[float] | None = option(None, "Horizontal angle [°]; repeatable.")
