"""Requests of `clerestory picture` that make luminance pictures from photographs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import PictureFile, PictureOutput, Quiet
from clerestory.options import Argument, option

Mapping = Literal[
    "equidistant", "equisolid", "orthographic", "stereographic", "polynomial"
]


@dataclass(frozen=True, kw_only=True)
class MergePhotographs:
    """Merge photographs of different exposures into one high-dynamic-range picture.

    Its radiances are known up to one factor, which `picture calibrate` finds.
    """

    files: Annotated[
        list[Path], Argument("Exposure bracket, .jpg, .png or .tif.", "PHOTO…")
    ]
    output: PictureOutput
    times: Annotated[
        list[float] | None,
        option(
            "Exposure time of each photograph in turn [s], repeatable; from the EXIF"
            " data if not given.",
            "--time",
            metavar="S",
        ),
    ] = None
    response: Annotated[
        str,
        option(
            "Camera response: recovered by debevec or robertson, srgb, linear, or a"
            " file (.csv as written here, .rsp of hdrgen).",
            metavar="R",
        ),
    ] = "debevec"
    save_response: Annotated[
        Path | None, option("Write the camera response to a .csv file.", metavar="F")
    ] = None
    align: Annotated[bool, option("Align the photographs of a camera that moved.")] = (
        False
    )
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class ReprojectPhotograph:
    """Reproject a fisheye photograph to a view that a glare evaluation accepts."""

    file: PictureFile
    output: PictureOutput
    lens: Annotated[Mapping, option("Projection of the lens.")] = "equisolid"
    coefficients: Annotated[
        list[float] | None,
        option(
            "Coefficient of θ, θ², … of a polynomial lens, repeatable.",
            "--coefficient",
            metavar="X",
        ),
    ] = None
    circle: Annotated[
        tuple[float, float, float] | None,
        option(
            "Image circle: column and row of its centre from the upper left, radius at"
            " 90°. The largest centred circle if not given.",
            metavar="X Y R",
        ),
    ] = None
    view: Annotated[str, option("View to make.", metavar="VIEW")] = (
        "-vta -vh 180 -vv 180"
    )
    resolution: Annotated[int, option("Columns and rows.", metavar="N", least=21)] = (
        1000
    )
    vignetting: Annotated[
        list[float] | None,
        option(
            "Coefficient of θ², θ⁴, … of the lens transmission, repeatable.",
            metavar="X",
        ),
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class CalibratePicture:
    """Scale a hemispherical picture to the illuminance measured beside the lens."""

    file: PictureFile
    output: PictureOutput
    before: Annotated[
        float, option("Illuminance at the lens before the bracket [lux].")
    ]
    after: Annotated[
        float | None, option("… and after it; as before if not given.")
    ] = None
    resolution: Annotated[
        int | None, option("Reduce to this many columns.", metavar="N", least=21)
    ] = None
    quiet: Quiet = False


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
