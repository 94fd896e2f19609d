"""Requests of `clerestory glazing`: stacks of panes and shades."""

from pathlib import Path
from typing import Literal

from clerestory.cli.command import command
from clerestory.cli.requests.common import Quiet, Seed
from clerestory.options import argument, option

HELP = "Stacks of panes, gaps and shades."


@command("glazing:stack", "clear.dat blind.xml -o system.xml")
class StackLayers:
    """Combine layers into one BSDF, and print its transmittance and reflectance."""

    layer: list[Path] = argument(
        "Layers from outdoors to indoors: .json, .dat, .xml, library:NAME;"
        " or one .toml.",
        "LAYER…",
    )
    output: Path | None = option(None, "BSDF file to write.", "-o")
    gap: float = option(12.7, "Thickness of all gaps [mm].", least=0.01)
    gas: str = option("air", "Gas in the gaps, such as argon=0.9,air=0.1.")
    basis: Literal["full", "half", "quarter"] = option("full", "Klems basis.")
    standard: Literal["nfrc", "en410"] = option("nfrc", "Standard for averages.")
    bands: bool = option(False, "Combine band averages instead of wavelengths.")
    spectral: str = option(
        "", "Spectral bands of the BSDF: 20, 81 or melanopic+photopic.", metavar="BANDS"
    )
    tree: int | None = option(
        None, "Tensor tree of 2^N cells per axis, by random walks.", least=1, most=6
    )
    walkers: int = option(256, "Random walks per incident cell, for --tree.", least=8)
    thermal: bool = option(False, "Also print U-value, SHGC and temperatures.")
    energyplus: Path | None = option(
        None, "Complex fenestration state of EnergyPlus to write: .idf or .epJSON."
    )
    seed: Seed = 1
    quiet: Quiet = False


@command("glazing:info", "clear.dat")
class GlazingInfo:
    """Describe products; list the products of a folder."""

    file: list[Path] = argument(
        "Product files, folders of them, or library:NAME.", "FILE…"
    )
