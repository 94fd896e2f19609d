"""Options of a glare evaluation, as in evalglare.

Pixel positions are as in Radiance: columns from the left, rows from below.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from clerestory.options import option

# Column and row of the central pixel, and one or two opening angles [rad]
Circle = tuple[int, int, float]
Circles = tuple[int, int, float, float]


@dataclass(frozen=True, kw_only=True)
class SourceOptions:
    """Options of glare source detection."""

    threshold: float | None = option(
        None,
        "Luminance above which pixels are glare pixels [cd/m²]; a number up to 100 is"
        " a multiple of the mean luminance of the task or the picture. Default: 2000,"
        " or 5 with a task.",
        "-b",
        metavar="X",
    )
    task: Circle | None = option(
        None,
        "Task zone: column from the left, row from below, opening angle [rad].",
        "-t",
        metavar="X Y ANGLE",
    )
    merge_angle: float = option(
        0.2, "Merge sources closer than half this angle [rad].", "-r", metavar="ANGLE"
    )
    smooth: bool = option(False, "Add dark pixels surrounded by a source.", "-s")
    peak: float = option(
        50_000.0,
        "Luminance above which pixels are separate sources [cd/m²].",
        "-Y",
        metavar="L",
    )
    split_peaks: bool = option(
        True, "Extract peaks as separate sources.", "--peaks/--no-peaks", "-y/-x"
    )
    smallest: float = option(
        0.0, "Ignore sources of less than this solid angle [sr].", metavar="SR"
    )
    field: Literal["1", "2"] | None = option(
        None, "Guth's field of view: 1 total, 2 binocular.", "-G"
    )


@dataclass(frozen=True, kw_only=True)
class IndexOptions:
    """Options of the glare indices."""

    illuminance: float | None = option(
        None, "Measured vertical eye illuminance, for DGP [lux].", "-i", metavar="EV"
    )
    fill: tuple[float, int, int] | None = option(
        None,
        "As -i, for a picture cropped above and below: rows above YMAX and below"
        " YMIN, counted from below, repeat the nearest captured row.",
        "-I",
        metavar="EV YMAX YMIN",
    )
    background: Literal["cie", "average", "illuminance"] = option(
        "cie", "Background luminance (evalglare -q 0, 1, 2)."
    )
    correction: Literal["l+", "l-", "0"] = option(
        "0", "l+ applies the low-light correction to DGP.", "-C"
    )
    age: float | None = option(None, "Correct DGP for the observer's age [years].")
    position: Literal["0", "1"] = option("0", "Position index: 0 Guth, 1 Kim.", "-P")
    weights: tuple[float, float, float, float, float, float, float, float] | None = (
        option(None, "Coefficients a1 … a5 c1 c2 c3 of DGP.", "-w", metavar="A1…")
    )


@dataclass(frozen=True, kw_only=True)
class RegionOptions:
    """Options of regions with separate luminance statistics."""

    mask: Path | None = option(
        None, "Picture whose bright pixels mark a window.", "-A", metavar="F"
    )
    band: float | None = option(
        None, "Statistics around the centre row [rad].", "-B", metavar="ANGLE"
    )
    zone: Circle | None = option(
        None, "Divide sources along a circle.", "-l", metavar="X Y ANGLE"
    )
    zones: Circles | None = option(
        None, "Divide sources along two circles.", "-L", metavar="X Y ANGLE ANGLE"
    )


@dataclass(frozen=True, kw_only=True)
class EvalglareOptions:
    """All options of a glare evaluation."""

    sources: SourceOptions = SourceOptions()
    indices: IndexOptions = IndexOptions()
    regions: RegionOptions = RegionOptions()
    view: str | None = option(
        None,
        "View in place of the picture's: a view file, or options such as"
        ' "-vta -vh 180 -vv 180".',
        metavar="VIEW",
    )
    trust: bool = option(
        False, "Evaluate even if the picture fails the quality checks.", "-f"
    )
