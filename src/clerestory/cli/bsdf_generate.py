"""`clerestory bsdf generate`: the BSDF of a shading system by ray tracing."""

import time

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.bsdfgen import system_catalogue
from clerestory.bsdfgen.channel_weights import Weights
from clerestory.bsdfgen.generate import generate_bsdf
from clerestory.bsdfgen.postprocessing import error_functions
from clerestory.bsdfgen.shading_system import (
    System,
    area_from_dimensions,
    area_of,
    system_in_bands,
)
from clerestory.checks import require
from clerestory.cli.bsdf_report import function_title
from clerestory.cli.named_spectra import spectral_bands
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.bsdf import GenerateBsdf
from clerestory.files import write_text
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad

_DEFAULTS = "default"


def generate(request: GenerateBsdf) -> None:
    """Trace a BSDF; write the BSDF file, its standard errors and the scene geometry."""
    begin = time.perf_counter()
    system = _spectral(request, _system(request))
    if request.rad is not None:
        write_text(request.rad, format_rad(system.scene, bsdf_file={}))
    with progress_display(quiet=request.quiet) as display:
        bsdf = generate_bsdf(
            system,
            bands=_bands(request.band),
            progress=display("BSDF"),
            **vars(request.tracing),
        )
    tracing, output = request.tracing, request.output
    comment = f"clerestory bsdf generate, {tracing.basis}, seed {tracing.seed}"
    write_bsdf(output, bsdf, digits=usual_digits(bsdf), comment=comment)
    if request.errors is not None:
        write_bsdf(
            request.errors,
            Bsdf(error_functions(bsdf.functions), bsdf.product),
            digits=4,
            comment=f"standard errors of the values in {output.name}",
        )
    lines = [f"{output}: {line}" for line in _summary(bsdf)]
    say(*lines, f"done in {time.perf_counter() - begin:.1f} s", quiet=request.quiet)


def _system(request: GenerateBsdf) -> System:
    # Shading system with sample area, from scene files or from one system option
    files, periodic = request.files or [], request.periodic
    dimensions = request.dimensions
    kinds = vars(request.kinds).items()
    named = {kind: text for kind, text in kinds if text is not None}
    require(
        bool(files) + (request.system is not None) + len(named) <= 1,
        "several systems are given; scene files or one system expected",
    )
    if request.system is not None:
        return system_catalogue.read_system(request.system)
    for kind, text in named.items():
        return system_catalogue.make_system(
            kind, {} if text == _DEFAULTS else system_catalogue.parse_parameters(text)
        )
    require(
        files or dimensions is not None,
        "no system is given; Radiance files or an option such as --venetian"
        " slat_width=0.08,spacing=0.072 expected",
    )
    scene = read_rad(*files)
    if dimensions is None:
        return System(scene, area_of(scene, periodic=periodic))
    return System(scene, area_from_dimensions(dimensions, periodic=periodic))


def _spectral(request: GenerateBsdf, system: System) -> System:
    # The system in the spectral bands of the request, if any
    chosen = spectral_bands(request.spectral, request.spectrum)
    if chosen is None:
        return system
    require(not request.band, "--band with --spectral; one of them expected")
    bands, spectra = chosen
    return system_in_bands(system, bands, spectra=spectra)


def _bands(texts: list[str] | None) -> dict[str, Weights] | None:
    found: dict[str, Weights] = {}
    for text in texts or []:
        for name, weights in system_catalogue.parse_parameters(text).items():
            numbers = weights if isinstance(weights, list) else [weights]
            valid = [isinstance(each, int | float) for each in numbers]
            require(
                valid == [True] * 3,
                f"band is {text!r}; a text such as solar=0.3/0.4/0.3 expected",
            )
            found[name.lower()] = tuple(map(float, numbers))
    return found or None


def _summary(bsdf: Bsdf) -> list[str]:
    lines = []
    for channel, name in bsdf.functions:
        if not channel.startswith("cie-"):
            share = bsdf.diffuse(name, channel=channel)
            lines.append(f"{function_title(channel, name):28}diffuse {share:.4f}")
    return lines
