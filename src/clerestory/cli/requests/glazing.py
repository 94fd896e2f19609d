"""Requests of `clerestory glazing`: stacks of panes and shades."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import Quiet, Seed
from clerestory.options import Argument, option


@dataclass(frozen=True, kw_only=True)
class StackLayers:
    """Combine layers into one BSDF, and print its transmittance and reflectance."""

    layer: Annotated[
        list[Path],
        Argument(
            "Layers from outdoors to the room: .json, .dat, .xml; or one .toml.",
            "LAYER…",
        ),
    ]
    output: Annotated[Path | None, option("BSDF file to write.", "-o")] = None
    gap: Annotated[float, option("Thickness of all gaps [mm].", least=0.01)] = 12.7
    gas: Annotated[str, option("Gas in the gaps, such as argon=0.9,air=0.1.")] = "air"
    basis: Annotated[Literal["full", "half", "quarter"], option("Klems basis.")] = (
        "full"
    )
    standard: Annotated[
        Literal["nfrc", "en410"], option("Standard of the spectral averages.")
    ] = "nfrc"
    bands: Annotated[bool, option("Combine band averages, not each wavelength.")] = (
        False
    )
    tree: Annotated[
        int | None,
        option("Tensor tree of 2^N cells per side, by a random walk.", least=1, most=6),
    ] = None
    walkers: Annotated[
        int, option("Random walks per incident cell, for --tree.", least=8)
    ] = 256
    thermal: Annotated[bool, option("Print U, SHGC and temperatures too.")] = False
    seed: Seed = 1
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class GlazingInfo:
    """Describe products; list the products of a folder."""

    file: Annotated[list[Path], Argument("Product files, or folders of them.", "FILE…")]


HELP = "Stacks of panes, gaps and shades."
COMMANDS = {
    "stack": Command(StackLayers, "glazing:stack", "clear.dat blind.xml -o system.xml"),
    "info": Command(GlazingInfo, "glazing:info", "clear.dat"),
}
