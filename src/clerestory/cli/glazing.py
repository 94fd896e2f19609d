"""`clerestory glazing`: stacks of panes and shades, and product files."""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import numpy as np

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.checks import require
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.glazing import GlazingInfo, StackLayers
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.input_objects import write_objects
from clerestory.errors import InputError
from clerestory.glazing import glazing_system
from clerestory.glazing.layer import Glass, Layer
from clerestory.glazing.layer_files import read_catalogue
from clerestory.glazing.layer_random_walk import walk_layers
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.standard import Channel
from clerestory.glazing.standard import standard as standard_named
from clerestory.glazing.thermal import ThermalFigures, thermal_figures
from clerestory.hemisphere.klems import klems
from clerestory.library.layer_source import read_layers
from clerestory.library.system_file import read_system
from clerestory.spectral.band_sets import band_set

_SHOWN: tuple[Channel, Channel] = ("visible", "solar")
_MILLIMETRE = 1e-3


def stack(request: StackLayers) -> None:
    """Combine layers into one BSDF, and print its optical and thermal properties."""
    system = _system(request.layer, request.gap, request.gas)
    averages = standard_named(request.standard)
    require(
        not request.spectral or request.tree is None,
        "--spectral with --tree; one of them expected",
    )
    with progress_display(quiet=request.quiet) as display:
        stacked = stack_layers(
            system.layers,
            partition=klems(request.basis),
            standard=averages,
            method="bands" if request.bands else "wavelengths",
            bands=band_set(request.spectral) if request.spectral else None,
            name=system.name,
            gap_thickness=sum(space.thickness for space in system.gaps),
            report=display("layers"),
        )
        bsdf = stacked.bsdf
        if request.tree is not None:
            bsdf = walk_layers(
                system.layers,
                halvings=request.tree,
                walkers=request.walkers,
                seed=request.seed,
                standard=averages,
                name=system.name,
                report=display("random walk"),
            ).bsdf
    names = " | ".join(layer.name for layer in system.layers).replace("--", "-")
    comment = f"clerestory glazing stack of {names}"
    if request.output is not None:
        write_bsdf(request.output, bsdf, digits=usual_digits(bsdf), comment=comment)
    if request.energyplus is not None:
        objects = complex_fenestration(system, stacked)
        write_objects(request.energyplus, objects, comment=comment)
    say(*_figures(stacked), quiet=request.quiet)
    if request.thermal:
        scattering = any(not isinstance(one, Glass) for one in system.layers)
        figures = thermal_figures(
            system.layers,
            system.gaps,
            wavelengths="condensed" if scattering else "full",
            light=stacked,
        )
        say(*_heat(figures))


def info(request: GlazingInfo) -> None:
    """Describe product files; list the products in folders."""
    for path in request.file:
        if path.is_dir():
            for entry in read_catalogue(path):
                number = "-" if entry.nfrc_id is None else str(entry.nfrc_id)
                note = f"  {entry.problem}" if entry.problem else ""
                say(f"{number:>7}  {entry.name:40}  {entry.path.name}{note}")
            continue
        layers = read_layers(path)
        stacked = stack_layers(layers, partition=klems("quarter"))
        say(*(line for layer in layers for line in _about(layer)), *_figures(stacked))


def _system(files: list[Path], gap: float, gas: str) -> glazing_system.GlazingSystem:
    if any(path.suffix.lower() == ".toml" for path in files):
        require(
            len(files) == 1, "a TOML file is given with other files; one file expected"
        )
        return read_system(files[0])
    layers = [layer for path in files for layer in read_layers(path)]
    return glazing_system.system_with_equal_gaps(
        layers, gap=glazing_system.Gap(gap * _MILLIMETRE, _gases(gas))
    )


def _gases(text: str) -> dict[str, float]:
    # A gas without fraction fills 100 % of the gap
    shares: dict[str, float] = {}
    for part in text.split(","):
        name, _, share = part.partition("=")
        try:
            shares[name.strip()] = float(share) if share else 1.0
        except ValueError as error:
            raise InputError(
                f"gas is {part.strip()!r}; name and fraction such as argon=0.9 expected"
            ) from error
    return shares


def _about(layer: Layer) -> Iterator[str]:
    yield f"{layer.name}: {type(layer).__name__}"
    pane = getattr(layer, "material", None)
    if pane is not None:
        ends = pane.wavelength_nm[[0, -1]]
        yield (
            f"  {len(pane.wavelength_nm)} wavelengths, {ends[0]:g} to {ends[1]:g} nm;"
            f" {pane.thickness * 1e3:.2f} mm, {pane.conductivity:g} W/(m K);"
            f" emissivity {pane.emissivity_front:.3f} | {pane.emissivity_back:.3f};"
            f" coated: {pane.coated_side if pane.coated else 'no'}"
        )


def _figures(stacked: StackedLayers) -> Iterator[str]:
    normal = int(np.argmax(stacked.partition.centres()[:, 2]))
    yield f"{'':26}{'visible':>20}{'solar':>20}"
    yield f"{stacked.standard:26}" + f"{'normal':>10}{'diffuse':>10}" * 2
    for name in FUNCTIONS:
        row = f"{name.replace('_', ' '):26}"
        for channel in _SHOWN:
            along = stacked.direct_hemispherical(name, channel=channel)[normal]
            row += f"{along:10.4f}{stacked.diffuse(name, channel=channel):10.4f}"
        yield row
    for number, layer in enumerate(stacked.layers):
        row = f"{'absorbed by ' + str(number + 1) + ' from front':26}"
        for channel in _SHOWN:
            along = stacked.absorptance[channel, "front"][number, normal]
            even = stacked.diffuse_absorptance(channel=channel)[number]
            row += f"{along:10.4f}{even:10.4f}"
        yield f"{row}  {layer}"


def _heat(figures: ThermalFigures) -> Iterator[str]:
    values = asdict(figures)
    yield f"{'U':26}{figures.u:10.4f} W/(m2 K)"
    for key, title in (
        ("shgc", "SHGC"),
        ("visible_transmittance", "visible transmittance"),
        ("solar_transmittance", "solar transmittance"),
    ):
        yield f"{title:26}{values[key]:10.4f}"
    for season in ("winter", "summer"):
        faces = values[f"temperatures_{season}"].ravel() - 273.15
        row = " ".join(f"{face:.1f}" for face in faces)
        yield f"{'temperatures in ' + season:26}{row} degrees C"
