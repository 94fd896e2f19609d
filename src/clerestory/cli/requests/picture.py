"""Requests of `clerestory picture`: pictures described, displayed and converted."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests import common
from clerestory.cli.requests.photograph import COMMANDS as PHOTOGRAPH_COMMANDS
from clerestory.options import Argument, Option, option, required

PictureFiles = Annotated[list[Path], Argument("Pictures, .hdr or .exr.", "PICTURE…")]
ImageOutput = Annotated[Path, Option("Image to write: .png or .jpg.", "-o")]


@dataclass(frozen=True, kw_only=True)
class PictureInfo:
    """Describe pictures: size, view, and the distribution of luminance."""

    files: PictureFiles
    header: bool = option(False, "Also print the lines of the header.")


@dataclass(frozen=True, kw_only=True)
class DenoisePicture:
    """Denoise a traced picture by Intel's Open Image Denoise.

    The result is for display, not for photometry; its header records the denoising.
    """

    file: common.PictureFile
    output: common.PictureOutput


@dataclass(frozen=True, kw_only=True)
class ToneMap:
    """Tone-map a picture for a display: PNG or JPEG in sRGB."""

    file: common.PictureFile
    output: ImageOutput
    method: Literal["human", "filmic", "linear"] = option(
        "human",
        "Visibility matching (human vision), film response curve, or linear.",
    )
    white: float | None = option(
        None, "Luminance of white [cd/m²] for filmic and linear; default: automatic."
    )
    veil: bool = option(False, "human: add veiling luminance by scattering in the eye.")
    screen_white: float = option(
        100.0, "human: maximum luminance of the display [cd/m²]."
    )
    screen_contrast: float = option(100.0, "human: contrast ratio of the display.")
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class FalseColour:
    """Show luminance [cd/m²], or illuminance [lux], in false colour."""

    file: common.PictureFile
    output: ImageOutput
    style: Literal["fill", "steps", "lines", "bands"] = option(
        "fill", "Continuous colours, colour steps, contour lines or contour bands."
    )
    to: float | None = option(None, "Largest value of the scale; default: automatic.")
    start: float = option(0.0, "Smallest value of a linear scale.", "--from")
    decades: float | None = option(
        None, "Logarithmic scale over this many decades.", "--log", metavar="N"
    )
    divisions: int = option(10, "Steps of a linear scale.", least=1, most=100)
    palette: str = option("turbo", "Matplotlib colour map; gnuplot resembles pm3d.")
    extremes: bool = option(False, "Mark the minimum and the maximum.", "-e")
    legend: bool = option(True, "Add a legend.", "--legend/--no-legend")
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class SumPictures:
    """Add pictures of equal size with weights; the first view is kept."""

    files: PictureFiles
    output: common.PictureOutput
    weight: list[float] | None = option(
        None, "Factor of each picture, in order; default: 1."
    )
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class ReducePicture:
    """Reduce the resolution of a picture by area averaging."""

    file: common.PictureFile
    output: common.PictureOutput
    factor: float | None = option(
        None, "Reduction factor of columns and rows; or …", least=1
    )
    size: tuple[int, int] | None = option(
        None, "… new numbers of columns and rows.", metavar="C R"
    )
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class CropPicture:
    """Crop a picture; the view is adapted."""

    file: common.PictureFile
    output: common.PictureOutput
    corner: tuple[int, int] = required(
        "First column (from the left) and first row (from the top), counted from 0."
    )
    size: tuple[int, int] = required("Columns and rows to keep.")
    quiet: common.Quiet = False


@dataclass(frozen=True, kw_only=True)
class ConvertPicture:
    """Write a picture in another format."""

    file: common.PictureFile
    output: common.PictureOutput
    factor: float = option(1.0, "Multiply all values.", "--scale")
    exposure: float = option(
        1.0, ".hdr: exposure of the pixels, recorded in the header."
    )
    xyz: bool = option(False, ".hdr: CIE XYZ instead of RGB.")
    half: bool = option(False, ".exr: 16 instead of 32 bits.")
    quiet: common.Quiet = False


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
