"""Request of `clerestory bsdf generate`: a BSDF by ray tracing."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.options import argument, option


def _kind(example: str) -> Any:
    return option(
        None,
        f"Parametric system, such as {example}; lengths in metres.",
        metavar="NAME=VALUE,…",
        panel="Parametric systems",
    )


@dataclass(frozen=True, kw_only=True)
class ParametricSystem:
    """A parametric system; at most one field is given."""

    venetian: str | None = _kind("slat_width=0.08,spacing=0.072,tilt_deg=45")
    microlouvre: str | None = _kind("cutoff_deg=40, or default")
    prismatic: str | None = _kind("upper_angle_deg=60, or default")
    mirrored_channels: str | None = _kind("pitch=0.001, or default")
    perforated: str | None = _kind("pitch=0.002,hole=0.001")
    woven: str | None = _kind("spacing=0.001,thread=0.0003")
    fabric: str | None = _kind("openness=0.03,reflectance=0.5")
    diffuse_pane: str | None = _kind("transmittance=0.5")
    clear_pane: str | None = _kind("transmissivity=0.96, or default")


@dataclass(frozen=True, kw_only=True)
class Tracing:
    """Basis, sides and effort: keywords of `generate_bsdf`."""

    basis: Literal["full", "half", "quarter", "tree3", "tree4"] = option(
        "full", "Klems basis, or a tensor tree of rank 3 or 4."
    )
    halvings: common.Halvings = 5
    sides: Literal["both", "front", "back"] = option("both", "Sides of incident light.")
    colour: bool = option(False, "Write CIE X and Z too; u' and v' for trees.")
    samples: int | None = option(
        None,
        "Paths per incident patch or cell (default 2000); or …",
        metavar="N",
        least=1,
    )
    relative_error: float | None = option(
        None,
        "… root mean square error of all values relative to their mean.",
        metavar="X",
    )
    bounces: common.Bounces = None
    symmetry: bool = option(
        True,
        "Trace only one of two patches that are mirror images by the symmetry of"
        " the geometry.",
        "--symmetry/--no-symmetry",
    )
    reciprocal: bool = option(False, "Average with the reverse function.")
    reduction: float = option(
        0.0, "Percentage of the smallest tree cells to merge.", "--reduce"
    )
    geometry: bool = option(
        True, "Include the geometry in the file.", "--geometry/--no-geometry"
    )
    name: str = option("", "Name of the product.")
    seed: common.Seed = 1
    device: common.DeviceName = "auto"


@dataclass(frozen=True, kw_only=True)
class GenerateBsdf:
    """Trace the BSDF of a shading system, as genBSDF does.

    +x is the width, +y up, +z into the room; all geometry is at z ≤ 0.
    """

    output: common.BsdfOutput
    files: list[Path] | None = argument(
        "Radiance scene files, materials first.", "[FILE…]", default=None
    )
    system: Path | None = option(None, "TOML file of a parametric system.")
    kinds: ParametricSystem
    dimensions: tuple[float, float, float, float, float, float] | None = option(
        None,
        "Sample area [m], like genBSDF -dim; default: the bounding box.",
        "--dim",
        metavar="XMIN XMAX YMIN YMAX ZMIN ZMAX",
    )
    periodic: bool = option(
        False, "Repeat the sample area periodically, so that no light is lost."
    )
    band: list[str] | None = option(
        None,
        "Band and its weights of red, green, blue; repeatable.",
        metavar="NAME=R/G/B",
    )
    tracing: Tracing
    errors: Path | None = option(None, "BSDF file of the standard errors to write.")
    rad: Path | None = option(None, "Radiance scene file of the geometry to write.")
    quiet: common.Quiet = False


COMMAND = Command(
    GenerateBsdf,
    "bsdf_generate:generate",
    "--venetian slat_width=0.08,spacing=0.072,tilt_deg=45 -o blind.xml",
)
