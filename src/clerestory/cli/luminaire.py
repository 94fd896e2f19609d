"""`clerestory luminaire`: descriptions and polar diagrams of photometric files."""

from pathlib import Path

from clerestory.cli.progress import say
from clerestory.cli.requests.luminaire import LuminaireInfo, PlotLuminaire
from clerestory.formats.photometry.luminaire import Luminaire
from clerestory.formats.photometry.read import read_luminaire
from clerestory.report.figure_file import write_figure
from clerestory.report.luminaire_plot import polar_figure

# IES keywords to print, and their labels
_SHOWN = {"MANUFAC": "manufacturer", "LUMINAIRE": "luminaire", "LAMP": "lamp"}


def info(request: LuminaireInfo) -> None:
    """Print a description of photometric files."""
    for file in request.files:
        say(*_lines(file, read_luminaire(file)))


def plot(request: PlotLuminaire) -> None:
    """Draw a polar diagram."""
    planes = request.plane or (0.0, 90.0)
    figure = polar_figure(read_luminaire(request.file), planes_deg=planes)
    write_figure(figure, request.output)


def _lines(file: Path, luminaire: Luminaire) -> list[str]:
    shape, flux = luminaire.shape, luminaire.flux()
    lines = [f"{file}: {luminaire.name}"]
    given = luminaire.keywords
    lines += [
        f"  {word}: {given[key]}" for key, word in _SHOWN.items() if given.get(key)
    ]
    light = f"  flux: {flux:.0f} lm"
    if luminaire.lamp_lumens:
        share = flux / luminaire.lamp_lumens
        light += f", {share:.1%} of the {luminaire.lamp_lumens:.0f} lm of its lamps"
    if luminaire.watts > 0:
        light += f"; {luminaire.watts:g} W, {flux / luminaire.watts:.0f} lm/W"
    horizontal, vertical = luminaire.intensity.shape
    return [
        *lines,
        light,
        f"  intensity: type {luminaire.photometry}, up to"
        f" {luminaire.intensity.max():.0f} cd; {horizontal} horizontal × {vertical}"
        " vertical angles",
        f"  luminous body: {shape.kind} {shape.x:g} × {shape.y:g} × {shape.z:g} m",
    ]
