"""Request of `clerestory bsdf generate`: a BSDF by ray tracing."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import (
    Bounces,
    BsdfOutput,
    DeviceName,
    Halvings,
    Quiet,
    Seed,
)
from clerestory.options import Argument, Option, option


def _kind(example: str) -> Option:
    return option(
        f"Parametric system, such as {example}; lengths in metres.",
        metavar="NAME=VALUE,…",
        panel="Parametric systems",
    )


@dataclass(frozen=True, kw_only=True)
class ParametricSystem:
    """A system by its kind and parameters; one of the fields, or none."""

    venetian: Annotated[
        str | None, _kind("slat_width=0.08,spacing=0.072,tilt_deg=45")
    ] = None
    microlouvre: Annotated[str | None, _kind("cutoff_deg=40, or default")] = None
    prismatic: Annotated[str | None, _kind("upper_angle_deg=60, or default")] = None
    mirrored_channels: Annotated[str | None, _kind("pitch=0.001, or default")] = None
    perforated: Annotated[str | None, _kind("pitch=0.002,hole=0.001")] = None
    woven: Annotated[str | None, _kind("spacing=0.001,thread=0.0003")] = None
    fabric: Annotated[str | None, _kind("openness=0.03,reflectance=0.5")] = None
    diffuse_pane: Annotated[str | None, _kind("transmittance=0.5")] = None
    clear_pane: Annotated[str | None, _kind("transmissivity=0.96, or default")] = None


@dataclass(frozen=True, kw_only=True)
class Tracing:
    """Basis, sides and effort: keywords of `generate_bsdf`."""

    basis: Annotated[
        Literal["full", "half", "quarter", "tree3", "tree4"],
        option("Klems basis, or a tensor tree of rank 3 or 4."),
    ] = "full"
    halvings: Halvings = 5
    sides: Annotated[
        Literal["both", "front", "back"], option("Sides of incident light.")
    ] = "both"
    colour: Annotated[bool, option("Write CIE X and Z too; u' and v' for trees.")] = (
        False
    )
    samples: Annotated[
        int | None,
        option(
            "Paths per incident patch or cell; 2000 if neither …", metavar="N", least=1
        ),
    ] = None
    relative_error: Annotated[
        float | None,
        option(
            "… nor this: root mean square error of all values over their mean.",
            metavar="X",
        ),
    ] = None
    bounces: Bounces = None
    symmetry: Annotated[
        bool,
        option(
            "Trace one of two patches that are mirror images by the symmetry of the"
            " geometry.",
            "--symmetry/--no-symmetry",
        ),
    ] = True
    reciprocal: Annotated[bool, option("Average with the reverse function.")] = False
    reduction: Annotated[
        float, option("Percentage of a tree's smallest cells to merge.", "--reduce")
    ] = 0.0
    geometry: Annotated[
        bool,
        option("Include the geometry in the file.", "--geometry/--no-geometry"),
    ] = True
    name: Annotated[str, option("Name of the product.")] = ""
    seed: Seed = 1
    device: DeviceName = "auto"


@dataclass(frozen=True, kw_only=True)
class GenerateBsdf:
    """Trace the BSDF of a shading system, as genBSDF does.

    +x is the width, +y up, +z into the room; all geometry is at z ≤ 0.
    """

    output: BsdfOutput
    files: Annotated[
        list[Path] | None,
        Argument("Radiance scene files, materials first.", "[FILE…]"),
    ] = None
    system: Annotated[Path | None, option("TOML file of a parametric system.")] = None
    kinds: ParametricSystem
    dimensions: Annotated[
        tuple[float, float, float, float, float, float] | None,
        option(
            "Sample area [m], as genBSDF's -dim; the bounding box if not given.",
            "--dim",
            metavar="XMIN XMAX YMIN YMAX ZMIN ZMAX",
        ),
    ] = None
    periodic: Annotated[
        bool, option("Repeat the sample area periodically: no light is lost.")
    ] = False
    band: Annotated[
        list[str] | None,
        option(
            "Band and its weights of red, green, blue; repeatable.",
            metavar="NAME=R/G/B",
        ),
    ] = None
    tracing: Tracing
    errors: Annotated[
        Path | None, option("Standard errors to write, as a BSDF file.")
    ] = None
    rad: Annotated[Path | None, option("Radiance file of the geometry to write.")] = (
        None
    )
    quiet: Quiet = False


COMMAND = Command(
    GenerateBsdf,
    "bsdf_generate:generate",
    "--venetian slat_width=0.08,spacing=0.072,tilt_deg=45 -o blind.xml",
)
