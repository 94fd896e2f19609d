"""Requests of `clerestory luminaire`: photometric files."""

from dataclasses import dataclass
from pathlib import Path

from clerestory.cli.command import Command
from clerestory.cli.requests.common import FigureOutput
from clerestory.options import argument, option


@dataclass(frozen=True, kw_only=True)
class LuminaireInfo:
    """Describe photometric files: flux, power, intensities, luminous dimensions."""

    files: list[Path] = argument("IES or EULUMDAT files.", "FILE…")


@dataclass(frozen=True, kw_only=True)
class PlotLuminaire:
    """Draw the polar diagram in given planes; default: 0° and 90°."""

    file: Path = argument("IES or EULUMDAT file.")
    output: FigureOutput
    plane: list[float] | None = option(
        None, "Horizontal angle of a plane [°]; repeatable."
    )


HELP = "Luminaires: IES and EULUMDAT files."
COMMANDS = {
    "info": Command(LuminaireInfo, "luminaire:info", "downlight.ies panel.ldt"),
    "plot": Command(PlotLuminaire, "luminaire:plot", "downlight.ies -o polar.png"),
}
