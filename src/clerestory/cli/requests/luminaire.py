"""Requests of `clerestory luminaire`: photometric files."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from clerestory.cli.command import Command
from clerestory.cli.requests.common import FigureOutput
from clerestory.options import Argument, option


@dataclass(frozen=True, kw_only=True)
class LuminaireInfo:
    """Describe photometric files: flux, power, intensities, luminous dimensions."""

    files: Annotated[list[Path], Argument("IES or EULUMDAT files.", "FILE…")]


@dataclass(frozen=True, kw_only=True)
class PlotLuminaire:
    """Draw the polar diagram, in the planes of 0° and 90° or in those given."""

    file: Annotated[Path, Argument("IES or EULUMDAT file.")]
    output: FigureOutput
    plane: Annotated[
        list[float] | None, option("Horizontal angle [°]; repeatable.")
    ] = None


HELP = "Luminaires: IES and EULUMDAT files."
COMMANDS = {
    "info": Command(LuminaireInfo, "luminaire:info", "downlight.ies panel.ldt"),
    "plot": Command(PlotLuminaire, "luminaire:plot", "downlight.ies -o polar.png"),
}
