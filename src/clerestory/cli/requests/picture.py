"""Requests of `clerestory picture`: pictures and photographs."""

from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import Argument, Option, argument, option, required

HELP = "Pictures: .hdr, .pic and .exr."

PictureFiles = Annotated[list[Path], Argument("Pictures, .hdr or .exr.", "PICTURE…")]
Mapping = Literal[
    "equidistant", "equisolid", "orthographic", "stereographic", "polynomial"
]
ImageOutput = Annotated[Path, Option("Image to write: .png or .jpg.", "-o")]


@command("picture:info", "room.hdr")
class PictureInfo:
    """Describe pictures: size, view, and the distribution of luminance."""

    files: PictureFiles
    header: bool = option(False, "Also print the lines of the header.")


@command("picture:denoise", "room.hdr -o smooth.hdr")
class DenoisePicture:
    """Denoise a traced picture by Intel's Open Image Denoise.

    The result is for display, not for photometry; its header records the denoising.
    """

    file: common.PictureFile
    output: common.PictureOutput


@command("picture:tonemap", "room.hdr -o room.png")
class ToneMap:
    """Tone-map a picture for a display: PNG or JPEG in sRGB."""

    file: common.PictureFile
    output: ImageOutput
    method: Literal["human", "filmic", "linear"] = option(
        "human", "Visibility matching (human vision), film response curve, or linear."
    )
    white: float | None = option(
        None, "Luminance of white [cd/m²] for filmic and linear; default: automatic."
    )
    veil: bool = option(
        False, "human: add the veiling luminance of light scattered in the eye."
    )
    screen_white: float = option(100.0, "human: white of the display [cd/m²].")
    screen_contrast: float = option(100.0, "human: contrast ratio of the display.")
    quiet: common.Quiet = False


@command("picture:falsecolour", "room.hdr --to 2000 -o room.png", alias="falsecolor")
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


@command(
    "picture:add", "sky.hdr sun.hdr --weight 1 --weight 0.5 -o both.hdr", name="sum"
)
class SumPictures:
    """Add weighted pictures of equal size; the view is that of the first picture."""

    files: PictureFiles
    output: common.PictureOutput
    weight: list[float] | None = option(None, "Factor of each picture; default: 1.")
    quiet: common.Quiet = False


@command("picture:reduce", "room.hdr --factor 2 -o half.hdr")
class ReducePicture:
    """Reduce the resolution of a picture by area averaging."""

    file: common.PictureFile
    output: common.PictureOutput
    factor: float | None = option(None, "Reduction factor; or …", least=1)
    size: tuple[int, int] | None = option(None, "… columns and rows.", metavar="C R")
    quiet: common.Quiet = False


@command("picture:crop", "room.hdr --corner 100 50 --size 400 300 -o part.hdr")
class CropPicture:
    """Crop a picture, and adapt the view in its header."""

    file: common.PictureFile
    output: common.PictureOutput
    corner: tuple[int, int] = required(
        "First column (from the left) and first row (from the top), counted from 0."
    )
    size: tuple[int, int] = required("Columns and rows to keep.")
    quiet: common.Quiet = False


@command("picture:convert", "room.hdr -o room.exr")
class ConvertPicture:
    """Write a picture in another format."""

    file: common.PictureFile
    output: common.PictureOutput
    factor: float = option(1.0, "Multiply all values.", "--scale")
    exposure: float = option(1.0, ".hdr: exposure, recorded in the header.")
    xyz: bool = option(False, ".hdr: CIE XYZ instead of RGB.")
    half: bool = option(False, ".exr: 16 instead of 32 bits.")
    quiet: common.Quiet = False


@command("photograph:merge", "bracket_*.jpg -o scene.hdr")
class MergePhotographs:
    """Merge photographs of different exposures into one high-dynamic-range picture.

    Radiances are known up to a common factor, which `picture calibrate` determines.
    """

    files: list[Path] = argument("Exposure bracket, .jpg, .png or .tif.", "PHOTO…")
    output: common.PictureOutput
    times: list[float] | None = option(
        None, "Exposure time of a photograph [s]; default: EXIF.", "--time", metavar="S"
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


@command(
    "photograph:reproject",
    "scene.hdr --lens equisolid --circle 2736 1824 1793 -o fisheye.hdr",
)
class ReprojectPhotograph:
    """Reproject a fisheye photograph to a view for glare evaluation."""

    file: common.PictureFile
    output: common.PictureOutput
    lens: Mapping = option("equisolid", "Projection of the lens.")
    coefficients: list[float] | None = option(
        None, "Coefficient of θ, θ², … (polynomial).", "--coefficient", metavar="X"
    )
    circle: tuple[float, float, float] | None = option(
        None,
        "Image circle: column and row of the centre from the upper left, and radius"
        " at 90°. Default: the largest centred circle.",
        metavar="X Y R",
    )
    view: str = option("-vta -vh 180 -vv 180", "Target view.", metavar="VIEW")
    resolution: int = option(1000, "Number of columns and rows.", metavar="N", least=21)
    vignetting: list[float] | None = option(
        None, "Coefficient of θ², θ⁴, … of lens transmission; repeatable.", metavar="X"
    )
    quiet: common.Quiet = False


@command("photograph:calibrate", "fisheye.hdr --before 1520 --after 1490 -o desk.hdr")
class CalibratePicture:
    """Scale a hemispherical picture to the illuminance measured beside the lens."""

    file: common.PictureFile
    output: common.PictureOutput
    before: float = required("Illuminance at the lens before the bracket [lux].")
    after: float | None = option(None, "Illuminance afterwards [lux]; default: same.")
    resolution: int | None = option(None, "Number of columns.", metavar="N", least=21)
    quiet: common.Quiet = False
