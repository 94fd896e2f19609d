"""`clerestory picture`: pictures described, shown, added, cut, reduced, converted."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from clerestory.cli.options import Quiet
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.image.arithmetic import crop as crop_picture
from clerestory.image.arithmetic import reduce as reduce_picture
from clerestory.image.arithmetic import scale, weighted_sum, within_view
from clerestory.image.colour_scale import ColourScale, linear_scale, logarithmic_scale
from clerestory.image.denoise import denoise as denoise_picture
from clerestory.image.exr import write_exr
from clerestory.image.false_colour import Style, false_colour
from clerestory.image.legend import value_word
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.picture_statistics import statistics
from clerestory.image.radiance_hdr import write_radiance
from clerestory.image.srgb_display import to_srgb, write_display
from clerestory.image.tone_curves import filmic, linear
from clerestory.image.visibility_matching import Screen, human_vision
from clerestory.radiance.view_text import format_view

app = typer.Typer(no_args_is_help=True, help="Pictures: .hdr, .pic and .exr.")

PictureFile = Annotated[
    Path, typer.Argument(metavar="PICTURE", help="Radiance's .hdr or .pic, or .exr.")
]
PictureFiles = Annotated[
    list[Path], typer.Argument(metavar="PICTURE…", help="Pictures, .hdr or .exr.")
]
Output = Annotated[
    Path, typer.Option("--output", "-o", help="Picture to write: .hdr or .exr.")
]
Shown = Annotated[
    Path, typer.Option("--output", "-o", help="File to write: .png or .jpg.")
]


@app.command(epilog="Example: clerestory picture info room.hdr")
def info(
    files: PictureFiles,
    header: Annotated[
        bool, typer.Option("--header", help="Tell the lines of the header too.")
    ] = False,
) -> None:
    """Say what pictures hold: size, view, and how luminance is distributed."""
    for file in files:
        picture = read_picture(file)
        typer.echo(
            f"{file}: {picture.columns} × {picture.rows} pixels of {picture.quantity}"
        )
        if picture.view is not None:
            typer.echo(f"  view  {format_view(picture.view)}")
        if picture.pixel_aspect != 1:
            typer.echo(f"  pixel aspect  {picture.pixel_aspect:g}")
        for line in _statistics_lines(picture):
            typer.echo(f"  {line}")
        for line in picture.header if header else ():
            typer.echo(f"  | {line}")


def _statistics_lines(picture: Picture) -> list[str]:
    found = statistics(picture, within_view(picture))
    name = "luminance" if picture.quantity == "radiance" else "illuminance"
    ends = (
        ("smallest", found.smallest),
        ("mean", found.mean),
        ("median", found.median),
        ("largest", found.largest),
    )
    words = ", ".join(f"{word} {value_word(value)}" for word, value in ends)
    shares = ", ".join(f"{p:g} % {value_word(x)}" for p, x in found.percentile)
    return [f"{name} [{found.unit}]  {words}", f"below  {shares}"]


@app.command(epilog="Example: clerestory picture denoise room.hdr -o smooth.hdr")
def denoise(file: PictureFile, output: Output) -> None:
    """Smooth the noise of a traced picture by Intel's Open Image Denoise.

    The result is a guess for the eye, and its header says so.
    """
    write_picture(denoise_picture(read_picture(file)), output)


@app.command(epilog="Example: clerestory picture tonemap room.hdr -o room.png")
def tonemap(
    file: PictureFile,
    output: Shown,
    method: Annotated[
        Literal["human", "filmic", "linear"],
        typer.Option(help="What the eye would see, a film's curve, or proportional."),
    ] = "human",
    white: Annotated[
        float | None,
        typer.Option(
            help="Luminance of white [cd/m²] for filmic and linear; else automatic."
        ),
    ] = None,
    veil: Annotated[
        bool, typer.Option("--veil", help="human: glare scattered in the eye.")
    ] = False,
    screen_white: Annotated[
        float, typer.Option(help="human: the screen's largest luminance [cd/m²].")
    ] = 100.0,
    screen_contrast: Annotated[
        float, typer.Option(help="human: largest over smallest luminance.")
    ] = 100.0,
    quiet: Quiet = False,
) -> None:
    """Show a picture on a screen: PNG or JPEG in sRGB."""
    if white is not None and method == "human":
        raise InputError("--white with --method human; filmic or linear expected")
    picture = read_picture(file)
    with progress_display(quiet=quiet) as display:
        progress = display("tone mapping")
        progress(0.1, method)
        if method == "human":
            screen = Screen(screen_white, screen_contrast)
            shown = human_vision(picture, veil=veil, screen=screen)
        else:
            mapping = filmic if method == "filmic" else linear
            shown = mapping(picture, white=white)
        write_display(to_srgb(shown), output)
        progress(1.0, "done")
    _tell(output, quiet=quiet)


@app.command(
    epilog="Example: clerestory picture falsecolour room.hdr --to 2000 -o room.png"
)
def falsecolour(
    file: PictureFile,
    output: Shown,
    style: Annotated[
        Style, typer.Option(help="Colour everything, in steps, or draw contours.")
    ] = "fill",
    to: Annotated[
        float | None, typer.Option(help="Largest value of the scale; else automatic.")
    ] = None,
    start: Annotated[
        float, typer.Option("--from", help="Smallest value of a linear scale.")
    ] = 0.0,
    decades: Annotated[
        float | None,
        typer.Option("--log", help="Logarithmic, over this many decades.", metavar="N"),
    ] = None,
    divisions: Annotated[
        int, typer.Option(help="Steps of a linear scale.", min=1, max=100)
    ] = 10,
    palette: Annotated[
        str, typer.Option(help="A colour map of matplotlib; gnuplot is like pm3d.")
    ] = "turbo",
    extremes: Annotated[
        bool, typer.Option("--extremes", "-e", help="Mark smallest and largest.")
    ] = False,
    legend: Annotated[
        bool, typer.Option("--legend/--no-legend", help="Put a legend beside it.")
    ] = True,
    quiet: Quiet = False,
) -> None:
    """Show luminance [cd/m²], or illuminance [lux], in false colour."""
    picture = read_picture(file)
    if decades is not None and start:
        raise InputError("--from with --log; the number of decades tells the start")
    chosen: ColourScale = (
        linear_scale(
            picture, smallest=start, largest=to, divisions=divisions, palette=palette
        )
        if decades is None
        else logarithmic_scale(picture, largest=to, decades=decades, palette=palette)
    )
    pixels = false_colour(
        picture, chosen, style=style, extremes=extremes, with_legend=legend
    )
    write_display(pixels, output)
    _tell(output, quiet=quiet)


app.command("falsecolor", hidden=True)(falsecolour)


@app.command(
    "sum",
    epilog="Example: clerestory picture sum sky.hdr sun.hdr --weight 1 --weight 0.5 "
    "-o both.hdr",
)
def add(
    files: PictureFiles,
    output: Output,
    weight: Annotated[
        list[float] | None,
        typer.Option(help="Factor of each picture, in order; 1 if none is given."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Add pictures of one size, each with its weight; view of the first."""
    pictures = [read_picture(file) for file in files]
    write_picture(weighted_sum(pictures, weight or None), output)
    _tell(output, quiet=quiet)


@app.command(
    epilog="Example: clerestory picture reduce room.hdr --factor 2 -o half.hdr"
)
def reduce(
    file: PictureFile,
    output: Output,
    factor: Annotated[
        float | None, typer.Option(help="How many times smaller, both ways.", min=1)
    ] = None,
    size: Annotated[
        tuple[int, int] | None,
        typer.Option(help="Columns and rows; or …", metavar="C R"),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Average pixels over the area of fewer, larger ones; exposure stays."""
    if (factor is None) == (size is None):
        raise InputError("either --factor or --size is expected")
    picture = read_picture(file)
    shares = (picture.columns / (factor or 1), picture.rows / (factor or 1))
    columns, rows = size or (max(round(share), 1) for share in shares)
    write_picture(reduce_picture(picture, columns=columns, rows=rows), output)
    _tell(output, quiet=quiet)


@app.command(
    epilog="Example: clerestory picture crop room.hdr --corner 100 50 --size 400 300 "
    "-o part.hdr"
)
def crop(
    file: PictureFile,
    output: Output,
    corner: Annotated[
        tuple[int, int],
        typer.Option(help="First column from the left, row from the top; from 0."),
    ],
    size: Annotated[tuple[int, int], typer.Option(help="Columns and rows to keep.")],
    quiet: Quiet = False,
) -> None:
    """Cut out a part; its view becomes that of the part."""
    picture = crop_picture(
        read_picture(file),
        left=corner[0],
        top=corner[1],
        columns=size[0],
        rows=size[1],
    )
    write_picture(picture, output)
    _tell(output, quiet=quiet)


@app.command(epilog="Example: clerestory picture convert room.hdr -o room.exr")
def convert(
    file: PictureFile,
    output: Output,
    factor: Annotated[
        float, typer.Option("--scale", help="Multiply all values.")
    ] = 1.0,
    exposure: Annotated[
        float, typer.Option(help=".hdr: factor on pixels, told in the header.")
    ] = 1.0,
    xyz: Annotated[
        bool, typer.Option("--xyz", help=".hdr: CIE XYZ instead of RGB.")
    ] = False,
    half: Annotated[
        bool, typer.Option("--half", help=".exr: 16 instead of 32 bits.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Write a picture in another format."""
    picture = scale(read_picture(file), factor)
    is_exr = output.suffix.lower() == ".exr"
    if is_exr and (xyz or exposure != 1):
        raise InputError("--xyz and --exposure belong to .hdr files")
    if half and not is_exr:
        raise InputError("--half belongs to .exr files")
    if half:
        write_exr(picture, output, half=True)
    elif xyz or exposure != 1:
        write_radiance(picture, output, exposure=exposure, xyz=xyz)
    else:
        write_picture(picture, output)
    _tell(output, quiet=quiet)


def _tell(output: Path, *, quiet: bool) -> None:
    if not quiet:
        typer.echo(f"{output}: written")
