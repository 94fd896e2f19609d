"""Requests of `clerestory picture` for photographs as luminance pictures."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.options import argument, option, required

Mapping = Literal[
    "equidistant", "equisolid", "orthographic", "stereographic", "polynomial"
]


@dataclass(frozen=True, kw_only=True)
class MergePhotographs:
    """Merge photographs of different exposures into one high-dynamic-range picture.

    Radiances are known up to a common factor, which `picture calibrate` determines.
    """

    files: list[Path] = argument("Exposure bracket, .jpg, .png or .tif.", "PHOTO…")
    output: common.PictureOutput
    times: list[float] | None = option(
        None,
        "Exposure time of each photograph in order [s], repeatable; default: from"
        " the EXIF data.",
        "--time",
        metavar="S",
    )
    response: str = option(
        "debevec",
        "Camera response: recovered by debevec or robertson, srgb, linear, or a"
        " file (.csv of --save-response, .rsp of hdrgen).",
        metavar="R",
    )
    save_response: Path | None = option(
        None, "Write the camera response to a .csv file.", metavar="F"
    )
    align: bool = option(False, "Align the photographs of a camera that moved.")
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class ReprojectPhotograph:
    """Reproject a fisheye photograph to a view for glare evaluation."""

    file: common.PictureFile
    output: common.PictureOutput
    lens: Mapping = option("equisolid", "Projection of the lens.")
    coefficients: list[float] | None = option(
        None,
        "Coefficient of θ, θ², … of a polynomial lens, repeatable.",
        "--coefficient",
        metavar="X",
    )
    circle: tuple[float, float, float] | None = option(
        None,
        "Image circle: column and row of the centre from the upper left, and radius"
        " at 90°. Default: the largest centred circle.",
        metavar="X Y R",
    )
    view: str = option("-vta -vh 180 -vv 180", "Target view.", metavar="VIEW")
    resolution: int = option(
        1000, "Number of columns and of rows.", metavar="N", least=21
    )
    vignetting: list[float] | None = option(
        None,
        "Coefficient of θ², θ⁴, … of the lens transmission, repeatable.",
        metavar="X",
    )
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class CalibratePicture:
    """Scale a hemispherical picture to the illuminance measured beside the lens."""

    file: common.PictureFile
    output: common.PictureOutput
    before: float = required("Illuminance at the lens before the bracket [lux].")
    after: float | None = option(
        None, "Illuminance after the bracket [lux]; default: as before."
    )
    resolution: int | None = option(
        None, "Reduce to this many columns.", metavar="N", least=21
    )
    quiet: common.Quiet = False


COMMANDS = {
    "merge": Command(
        MergePhotographs, "photograph:merge", "bracket_*.jpg -o scene.hdr"
    ),
    "reproject": Command(
        ReprojectPhotograph,
        "photograph:reproject",
        "scene.hdr --lens equisolid --circle 2736 1824 1793 -o fisheye.hdr",
    ),
    "calibrate": Command(
        CalibratePicture,
        "photograph:calibrate",
        "fisheye.hdr --before 1520 --after 1490 -o desk.hdr",
    ),
}
