"""`clerestory picture`: pictures described, displayed, combined and converted."""

from functools import partial
from pathlib import Path

from clerestory.checks import require
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests import picture as requests
from clerestory.errors import located
from clerestory.image import arithmetic
from clerestory.image.colour_scale import linear_scale, logarithmic_scale
from clerestory.image.denoise import denoise as denoise_picture
from clerestory.image.exr import write_exr
from clerestory.image.false_colour import false_colour
from clerestory.image.legend import value_word
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.picture_statistics import statistics
from clerestory.image.radiance_hdr import write_radiance
from clerestory.image.srgb_display import to_srgb, write_display
from clerestory.image.tone_curves import filmic, linear
from clerestory.image.visibility_matching import Screen, human_vision
from clerestory.radiance.view_text import format_view


def info(request: requests.PictureInfo) -> None:
    """Print size, view and luminance of pictures."""
    for file in request.files:
        picture = read_picture(file)
        with located(file=file):
            lines = _statistics_lines(picture)
        say(f"{file}: {picture.columns} × {picture.rows} pixels of {picture.quantity}")
        if picture.view is not None:
            say(f"  view  {format_view(picture.view)}")
        if picture.pixel_aspect != 1:
            say(f"  pixel aspect  {picture.pixel_aspect:g}")
        say(*lines)
        say(*(f"  | {line}" for line in picture.header), quiet=not request.header)


def _statistics_lines(picture: Picture) -> list[str]:
    found = statistics(picture, arithmetic.within_view(picture))
    name = "luminance" if picture.quantity == "radiance" else "illuminance"
    ends = ("smallest", "mean", "median", "largest")
    words = ", ".join(f"{end} {value_word(getattr(found, end))}" for end in ends)
    shares = ", ".join(f"{p:g} % {value_word(x)}" for p, x in found.percentile)
    return [f"  {name} [{found.unit}]  {words}", f"  below  {shares}"]


def denoise(request: requests.DenoisePicture) -> None:
    """Denoise a picture."""
    write_picture(denoise_picture(read_picture(request.file)), request.output)


def tonemap(request: requests.ToneMap) -> None:
    """Tone-map a picture."""
    method, white = request.method, request.white
    require(
        white is None or method != "human",
        "--white is given with --method human; method filmic or linear expected",
    )
    picture = read_picture(request.file)
    with progress_display(quiet=request.quiet) as display:
        progress = display("tone mapping")
        progress(0.1, method)
        if method == "human":
            screen = Screen(request.screen_white, request.screen_contrast)
            shown = human_vision(picture, veil=request.veil, screen=screen)
        else:
            mapping = filmic if method == "filmic" else linear
            shown = mapping(picture, white=white)
        write_display(to_srgb(shown), request.output)
        progress(1.0, "done")
    _say_written(request.output, quiet=request.quiet)


def falsecolour(request: requests.FalseColour) -> None:
    """Write a false-colour image."""
    picture = read_picture(request.file)
    decades = request.decades
    require(
        decades is None or not request.start,
        "--from is given with --log, whose decades set the smallest value; one of them"
        " expected",
    )
    make = (
        partial(linear_scale, smallest=request.start, divisions=request.divisions)
        if decades is None
        else partial(logarithmic_scale, decades=decades)
    )
    pixels = false_colour(
        picture,
        make(picture, largest=request.to, palette=request.palette),
        style=request.style,
        extremes=request.extremes,
        with_legend=request.legend,
    )
    write_display(pixels, request.output)
    _say_written(request.output, quiet=request.quiet)


def add(request: requests.SumPictures) -> None:
    """Add pictures with weights."""
    pictures = [read_picture(file) for file in request.files]
    total = arithmetic.weighted_sum(pictures, request.weight or None)
    _write(total, request.output, quiet=request.quiet)


def reduce(request: requests.ReducePicture) -> None:
    """Reduce the resolution of a picture."""
    factor, size = request.factor, request.size
    require((factor is None) != (size is None), "either --factor or --size expected")
    picture = read_picture(request.file)
    shares = (picture.columns / (factor or 1), picture.rows / (factor or 1))
    columns, rows = size or (max(round(share), 1) for share in shares)
    reduced = arithmetic.reduce(picture, columns=columns, rows=rows)
    _write(reduced, request.output, quiet=request.quiet)


def crop(request: requests.CropPicture) -> None:
    """Crop a picture."""
    (left, top), (columns, rows) = request.corner, request.size
    part = arithmetic.crop(
        read_picture(request.file), left=left, top=top, columns=columns, rows=rows
    )
    _write(part, request.output, quiet=request.quiet)


def convert(request: requests.ConvertPicture) -> None:
    """Write a picture in another format."""
    output, exposure, xyz = request.output, request.exposure, request.xyz
    picture = arithmetic.scale(read_picture(request.file), request.factor)
    is_exr = output.suffix.lower() == ".exr"
    only_hdr = xyz or exposure != 1
    require(not (is_exr and only_hdr), "--xyz or --exposure for .exr; .hdr expected")
    require(is_exr or not request.half, f"--half for {output.name}; .exr expected")
    if request.half:
        write_exr(picture, output, half=True)
    elif only_hdr:
        write_radiance(picture, output, exposure=exposure, xyz=xyz)
    else:
        write_picture(picture, output)
    _say_written(output, quiet=request.quiet)


def _write(picture: Picture, output: Path, *, quiet: bool) -> None:
    write_picture(picture, output)
    _say_written(output, quiet=quiet)


def _say_written(output: Path, *, quiet: bool) -> None:
    say(f"{output}: written", quiet=quiet)
