"""`clerestory bsdf generate`: the BSDF of a shading system by tracing its geometry."""

import time
from pathlib import Path
from typing import Annotated

import typer

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.channel_weights import Weights
from clerestory.bsdfgen.generate import Basis, Sides, generate_bsdf
from clerestory.bsdfgen.postprocessing import error_functions
from clerestory.bsdfgen.shading_system import System, area_from_dimensions, area_of
from clerestory.bsdfgen.system_catalogue import (
    make_system,
    parse_parameters,
    read_system,
)
from clerestory.cli.options import Bounces, DeviceOption, Quiet, Seed
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad

EXAMPLE = (
    "Example: clerestory bsdf generate"
    " --venetian slat_width=0.08,spacing=0.072,tilt_deg=45 -o blind.xml"
)

_DIGITS = 7
_DEFAULTS = "default"


def _kind(name: str, example: str) -> object:
    return typer.Option(
        f"--{name.replace('_', '-')}",
        help=f"Parametric system, such as {example}; lengths in metres.",
        metavar="NAME=VALUE,…",
        rich_help_panel="Parametric systems",
    )


Files = Annotated[
    list[Path] | None,
    typer.Argument(metavar="[FILE…]", help="Radiance scene files, materials first."),
]
Dimensions = Annotated[
    tuple[float, float, float, float, float, float] | None,
    typer.Option(
        "--dim",
        help="Sample area [m], as genBSDF's -dim; the box around it if not given.",
        metavar="XMIN XMAX YMIN YMAX ZMIN ZMAX",
    ),
]
Bands = Annotated[
    list[str] | None,
    typer.Option(
        "--band",
        help="Band and its weights of red, green, blue; repeatable.",
        metavar="NAME=R/G/B",
    ),
]


def generate(
    output: Annotated[Path, typer.Option("--output", "-o", help="BSDF file to write.")],
    files: Files = None,
    system: Annotated[
        Path | None, typer.Option("--system", help="TOML file of a parametric system.")
    ] = None,
    venetian: Annotated[
        str | None, _kind("venetian", "slat_width=0.08,spacing=0.072,tilt_deg=45")
    ] = None,
    microlouvre: Annotated[
        str | None, _kind("microlouvre", "cutoff_deg=40, or default")
    ] = None,
    prismatic: Annotated[
        str | None, _kind("prismatic", "upper_angle_deg=60, or default")
    ] = None,
    mirrored_channels: Annotated[
        str | None, _kind("mirrored_channels", "pitch=0.001, or default")
    ] = None,
    perforated: Annotated[
        str | None, _kind("perforated", "pitch=0.002,hole=0.001")
    ] = None,
    woven: Annotated[str | None, _kind("woven", "spacing=0.001,thread=0.0003")] = None,
    fabric: Annotated[
        str | None, _kind("fabric", "openness=0.03,reflectance=0.5")
    ] = None,
    diffuse_pane: Annotated[
        str | None, _kind("diffuse_pane", "transmittance=0.5")
    ] = None,
    clear_pane: Annotated[
        str | None, _kind("clear_pane", "transmissivity=0.96, or default")
    ] = None,
    basis: Annotated[
        Basis,
        typer.Option("--basis", help="Klems patches, or a tensor tree of rank 3 or 4."),
    ] = "full",
    halvings: Annotated[
        int, typer.Option("--halvings", help="2^N cells along each axis of a tree.")
    ] = 5,
    sides: Annotated[
        Sides, typer.Option("--sides", help="Where light comes from.")
    ] = "both",
    dimensions: Dimensions = None,
    periodic: Annotated[
        bool,
        typer.Option("--periodic", help="The sample area repeats: no light is lost."),
    ] = False,
    band: Bands = None,
    colour: Annotated[
        bool, typer.Option("--colour", help="CIE X and Z too; u' and v' of trees.")
    ] = False,
    samples: Annotated[
        int | None,
        typer.Option(
            "--samples",
            help="Paths from each incident patch or cell; 2000 if neither …",
            min=1,
            metavar="N",
        ),
    ] = None,
    relative_error: Annotated[
        float | None,
        typer.Option(
            "--relative-error",
            help="… nor this: root mean square error of all values over their mean.",
            metavar="X",
        ),
    ] = None,
    bounces: Bounces = None,
    symmetry: Annotated[
        bool,
        typer.Option(
            "--symmetry/--no-symmetry",
            help="Trace matrices from one of two patches that the geometry mirrors.",
        ),
    ] = True,
    reciprocal: Annotated[
        bool, typer.Option("--reciprocal", help="Average light forth with light back.")
    ] = False,
    reduction: Annotated[
        float,
        typer.Option("--reduce", help="Percent of a tree's smallest blocks to join."),
    ] = 0.0,
    geometry: Annotated[
        bool,
        typer.Option(
            "--geometry/--no-geometry", help="Put the geometry into the file."
        ),
    ] = True,
    name: Annotated[str, typer.Option("--name", help="Name of the product.")] = "",
    errors: Annotated[
        Path | None,
        typer.Option("--errors", help="File for the standard errors, as a BSDF file."),
    ] = None,
    rad: Annotated[
        Path | None, typer.Option("--rad", help="Radiance file for the geometry.")
    ] = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    quiet: Quiet = False,
) -> None:
    """Trace a shading system to a BSDF file, as genBSDF does.

    +x is the width, +y up, +z into the room; nothing lies at z > 0.
    """
    begin = time.perf_counter()
    kinds = {
        "venetian": venetian,
        "microlouvre": microlouvre,
        "prismatic": prismatic,
        "mirrored_channels": mirrored_channels,
        "perforated": perforated,
        "woven": woven,
        "fabric": fabric,
        "diffuse_pane": diffuse_pane,
        "clear_pane": clear_pane,
    }
    chosen = _chosen(files or [], system, kinds, dimensions, periodic=periodic)
    if rad is not None:
        write_text(rad, format_rad(chosen.scene, bsdf_file={}))
    with progress_display(quiet=quiet) as display:
        bsdf = generate_bsdf(
            chosen,
            basis=basis,
            halvings=halvings,
            sides=sides,
            bands=_bands(band),
            colour=colour,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            symmetry=symmetry,
            reciprocal=reciprocal,
            reduction=reduction,
            geometry=geometry,
            name=name,
            seed=seed,
            device=device,
            progress=display("BSDF"),
        )
    comment = f"clerestory bsdf generate, {basis}, seed {seed}"
    write_bsdf(output, bsdf, digits=_DIGITS, comment=comment)
    if errors is not None:
        write_bsdf(
            errors,
            Bsdf(error_functions(bsdf.functions), bsdf.product),
            digits=4,
            comment=f"standard errors of the values in {output.name}",
        )
    if not quiet:
        for line in _summary(bsdf):
            typer.echo(f"{output}: {line}")
        typer.echo(f"done in {time.perf_counter() - begin:.1f} s")


def _chosen(
    files: list[Path],
    toml: Path | None,
    kinds: dict[str, str | None],
    dimensions: tuple[float, ...] | None,
    *,
    periodic: bool,
) -> System:
    # One source of geometry, and the area to sample
    named = {kind: text for kind, text in kinds.items() if text is not None}
    if bool(files) + (toml is not None) + len(named) > 1:
        raise InputError("several systems given; scene files or one of them expected")
    if toml is not None:
        return read_system(toml)
    for kind, text in named.items():
        return make_system(kind, {} if text == _DEFAULTS else parse_parameters(text))
    if not files and dimensions is None:
        raise InputError(
            "no system; Radiance files or one such as --venetian"
            " slat_width=0.08,spacing=0.072 expected"
        )
    scene = read_rad(*files)
    if dimensions is None:
        return System(scene, area_of(scene, periodic=periodic))
    return System(scene, area_from_dimensions(dimensions, periodic=periodic))


def _bands(texts: list[str] | None) -> dict[str, Weights] | None:
    found: dict[str, Weights] = {}
    for text in texts or []:
        for name, weights in parse_parameters(text).items():
            numbers = weights if isinstance(weights, list) else [weights]
            if len(numbers) != 3 or not all(
                isinstance(n, int | float) for n in numbers
            ):
                raise InputError(f"band {text!r}; such as solar=0.3/0.4/0.3 expected")
            found[name.lower()] = (
                float(numbers[0]),
                float(numbers[1]),
                float(numbers[2]),
            )
    return found or None


def _summary(bsdf: Bsdf) -> list[str]:
    lines = []
    for channel, name in bsdf.functions:
        if not channel.startswith("cie-"):
            share = bsdf.diffuse(name, channel=channel)
            title = f"{channel} {name.replace('_', ' ')}"
            lines.append(f"{title:28}{share:.4f} of diffuse light")
    return lines
