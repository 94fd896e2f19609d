"""Options of a glare evaluation, as those of evalglare.

Pixels are counted as in Radiance: columns from the left, rows from below.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.options import option

# Column and row of a pixel, opening angle or angles of circles about it [rad]
Circle = tuple[int, int, float]
Circles = tuple[int, int, float, float]


@dataclass(frozen=True, kw_only=True)
class SourceOptions:
    """Detection of glare sources."""

    threshold: Annotated[
        float | None,
        option(
            "Luminance above which pixels are glare [cd/m²]; up to 100 a multiple of"
            " the mean of the task or the picture. 2000, or 5 with a task, if not"
            " given.",
            "-b",
            metavar="X",
        ),
    ] = None
    task: Annotated[
        Circle | None,
        option(
            "Task zone: column from the left, row from below, opening angle [rad].",
            "-t",
            metavar="X Y ANGLE",
        ),
    ] = None
    merge_angle: Annotated[
        float,
        option(
            "Sources closer than half this angle are one [rad].", "-r", metavar="ANGLE"
        ),
    ] = 0.2
    smooth: Annotated[bool, option("Fill the gaps within sources.", "-s")] = False
    peak: Annotated[
        float,
        option(
            "Luminance above which pixels are sources of their own [cd/m²].",
            "-Y",
            metavar="L",
        ),
    ] = 50_000.0
    split_peaks: Annotated[
        bool, option("Extract peaks from their sources.", "--peaks/--no-peaks", "-y/-x")
    ] = True
    smallest: Annotated[
        float, option("Ignore sources of less solid angle [sr].", metavar="SR")
    ] = 0.0
    field: Annotated[
        Literal["1", "2"] | None,
        option("Guth's field of view: 1 total, 2 binocular.", "-G"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class IndexOptions:
    """Variants and corrections of the glare indices."""

    illuminance: Annotated[
        float | None,
        option("Measured vertical eye illuminance, for DGP [lux].", "-i", metavar="EV"),
    ] = None
    fill: Annotated[
        tuple[float, int, int] | None,
        option(
            "As -i, for a picture cropped above and below: from row YMAX upwards and"
            " from row YMIN downwards, counted from below, the last row is repeated.",
            "-I",
            metavar="EV YMAX YMIN",
        ),
    ] = None
    background: Annotated[
        Literal["cie", "average", "illuminance"],
        option("Background luminance (evalglare -q 0, 1, 2)."),
    ] = "cie"
    correction: Annotated[
        Literal["l+", "l-", "0"],
        option("l+ applies the low-light correction to DGP.", "-C"),
    ] = "0"
    age: Annotated[
        float | None, option("Correct DGP for the observer's age [years].")
    ] = None
    position: Annotated[
        Literal["0", "1"], option("Position index: 0 Guth, 1 Kim.", "-P")
    ] = "0"
    weights: Annotated[
        tuple[float, float, float, float, float, float, float, float] | None,
        option("Coefficients a1 … a5 c1 c2 c3 of DGP.", "-w", metavar="A1…"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class RegionOptions:
    """Regions with statistics of their own."""

    mask: Annotated[
        Path | None,
        option("Picture whose bright pixels mark a window.", "-A", metavar="F"),
    ] = None
    band: Annotated[
        float | None,
        option("Statistics of a horizontal band [rad].", "-B", metavar="ANGLE"),
    ] = None
    zone: Annotated[
        Circle | None,
        option("Divide sources along a circle.", "-l", metavar="X Y ANGLE"),
    ] = None
    zones: Annotated[
        Circles | None, option("… along two circles.", "-L", metavar="X Y ANGLE ANGLE")
    ] = None


@dataclass(frozen=True, kw_only=True)
class EvalglareOptions:
    """All options of a glare evaluation.

    >>> EvalglareOptions(sources=SourceOptions(threshold=3000)).sources.merge_angle
    0.2
    """

    sources: SourceOptions = SourceOptions()
    indices: IndexOptions = IndexOptions()
    regions: RegionOptions = RegionOptions()
    view: Annotated[
        str | None,
        option(
            "View in place of the picture's: a view file, or options such as"
            ' "-vta -vh 180 -vv 180".',
            metavar="VIEW",
        ),
    ] = None
    trust: Annotated[
        bool, option("Evaluate even if the picture fails the quality checks.", "-f")
    ] = False
