"""Requests of `clerestory picture`: pictures described, displayed and converted."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import PictureFile, PictureOutput, Quiet
from clerestory.cli.requests.photograph import COMMANDS as PHOTOGRAPH_COMMANDS
from clerestory.options import Argument, option

PictureFiles = Annotated[list[Path], Argument("Pictures, .hdr or .exr.", "PICTURE…")]
ImageOutput = Annotated[Path, option("Image to write: .png or .jpg.", "-o")]


@dataclass(frozen=True, kw_only=True)
class PictureInfo:
    """Describe pictures: size, view, and the distribution of luminance."""

    files: PictureFiles
    header: Annotated[bool, option("Print the lines of the header too.")] = False


@dataclass(frozen=True, kw_only=True)
class DenoisePicture:
    """Denoise a traced picture by Intel's Open Image Denoise.

    The result is for display, not for photometry; its header records the denoising.
    """

    file: PictureFile
    output: PictureOutput


@dataclass(frozen=True, kw_only=True)
class ToneMap:
    """Tone-map a picture for a display: PNG or JPEG in sRGB."""

    file: PictureFile
    output: ImageOutput
    method: Annotated[
        Literal["human", "filmic", "linear"],
        option(
            "Visibility matching of human vision, the response of a film, or linear."
        ),
    ] = "human"
    white: Annotated[
        float | None,
        option("Luminance of white [cd/m²] for filmic and linear; else automatic."),
    ] = None
    veil: Annotated[bool, option("human: add the veiling glare in the eye.")] = False
    screen_white: Annotated[
        float, option("human: the display's maximum luminance [cd/m²].")
    ] = 100.0
    screen_contrast: Annotated[
        float, option("human: the display's maximum over minimum luminance.")
    ] = 100.0
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class FalseColour:
    """Show luminance [cd/m²], or illuminance [lux], in false colour."""

    file: PictureFile
    output: ImageOutput
    style: Annotated[
        Literal["fill", "steps", "lines", "bands"],
        option("Continuous colours, colour steps, contour lines or contour bands."),
    ] = "fill"
    to: Annotated[
        float | None, option("Largest value of the scale; else automatic.")
    ] = None
    start: Annotated[float, option("Smallest value of a linear scale.", "--from")] = 0.0
    decades: Annotated[
        float | None,
        option("Logarithmic scale over this many decades.", "--log", metavar="N"),
    ] = None
    divisions: Annotated[int, option("Steps of a linear scale.", least=1, most=100)] = (
        10
    )
    palette: Annotated[
        str, option("A colour map of Matplotlib; gnuplot is like pm3d.")
    ] = "turbo"
    extremes: Annotated[bool, option("Mark the minimum and the maximum.", "-e")] = False
    legend: Annotated[
        bool, option("Put a legend beside the picture.", "--legend/--no-legend")
    ] = True
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class SumPictures:
    """Add pictures of one size with weights; the view is that of the first."""

    files: PictureFiles
    output: PictureOutput
    weight: Annotated[
        list[float] | None,
        option("Factor of each picture, in order; 1 if none is given."),
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class ReducePicture:
    """Reduce the resolution of a picture by averaging over areas; exposure is kept."""

    file: PictureFile
    output: PictureOutput
    factor: Annotated[
        float | None, option("Reduction of both columns and rows; or …", least=1)
    ] = None
    size: Annotated[
        tuple[int, int] | None, option("… columns and rows.", metavar="C R")
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class CropPicture:
    """Crop a picture; its view becomes that of the part."""

    file: PictureFile
    output: PictureOutput
    corner: Annotated[
        tuple[int, int],
        option("First column from the left and first row from the top, from 0."),
    ]
    size: Annotated[tuple[int, int], option("Columns and rows to keep.")]
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class ConvertPicture:
    """Write a picture in another format."""

    file: PictureFile
    output: PictureOutput
    factor: Annotated[float, option("Multiply all values.", "--scale")] = 1.0
    exposure: Annotated[
        float, option(".hdr: exposure of the pixels, recorded in the header.")
    ] = 1.0
    xyz: Annotated[bool, option(".hdr: CIE XYZ instead of RGB.")] = False
    half: Annotated[bool, option(".exr: 16 instead of 32 bits.")] = False
    quiet: Quiet = False


HELP = "Pictures: .hdr, .pic and .exr."
COMMANDS = {
    "info": Command(PictureInfo, "picture:info", "room.hdr"),
    "denoise": Command(DenoisePicture, "picture:denoise", "room.hdr -o smooth.hdr"),
    "tonemap": Command(ToneMap, "picture:tonemap", "room.hdr -o room.png"),
    "falsecolour": Command(
        FalseColour, "picture:falsecolour", "room.hdr --to 2000 -o room.png"
    ),
    "falsecolor": Command(FalseColour, "picture:falsecolour", hidden=True),
    "sum": Command(
        SumPictures,
        "picture:add",
        "sky.hdr sun.hdr --weight 1 --weight 0.5 -o both.hdr",
    ),
    "reduce": Command(
        ReducePicture, "picture:reduce", "room.hdr --factor 2 -o half.hdr"
    ),
    "crop": Command(
        CropPicture,
        "picture:crop",
        "room.hdr --corner 100 50 --size 400 300 -o part.hdr",
    ),
    "convert": Command(ConvertPicture, "picture:convert", "room.hdr -o room.exr"),
    **PHOTOGRAPH_COMMANDS,
}
