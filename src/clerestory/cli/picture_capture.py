"""`clerestory picture merge|reproject|calibrate`: pictures from photographs."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import Quiet
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.image.arithmetic import reduce as reduce_picture
from clerestory.image.camera_response import (
    ResponseCurve,
    linear_response,
    read_response,
    recover_response,
    srgb_response,
    write_response,
)
from clerestory.image.exposure_bracket import align as align_photographs
from clerestory.image.exposure_bracket import merge_bracket
from clerestory.image.fisheye_lens import ImageCircle, Lens, Mapping
from clerestory.image.fisheye_lens import reproject as reproject_picture
from clerestory.image.photograph import (
    Exposure,
    Photograph,
    read_exposure,
    read_photograph,
)
from clerestory.image.photometric_calibration import calibrate as calibrate_picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.vignetting import Vignetting, correct_vignetting
from clerestory.radiance.view_text import parse_view
from clerestory.scene.view import View

Output = Annotated[
    Path, typer.Option("--output", "-o", help="Picture to write: .hdr or .exr.")
]
PictureFile = Annotated[
    Path, typer.Argument(metavar="PICTURE", help="Radiance's .hdr or .pic, or .exr.")
]


def merge(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="PHOTO…", help="Bracket, .jpg, .png or .tif."),
    ],
    output: Output,
    times: Annotated[
        list[float] | None,
        typer.Option(
            "--time",
            help="Exposure time of each photograph in turn [s], once each; from their"
            " EXIF data if not given.",
            metavar="S",
        ),
    ] = None,
    response: Annotated[
        str,
        typer.Option(
            "--response",
            help="debevec or robertson recover the camera's curve; srgb, linear, or a"
            " file (.csv as written here, .rsp of hdrgen).",
            metavar="R",
        ),
    ] = "debevec",
    save_response: Annotated[
        Path | None,
        typer.Option("--save-response", help="Keep the curve in a .csv.", metavar="F"),
    ] = None,
    align: Annotated[
        bool, typer.Option("--align", help="The camera moved: shift the photographs.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Merge photographs of one scene at different exposures into one picture.

    Its radiances are right up to one factor: calibrate finds it.
    """
    with progress_display(quiet=quiet) as display:
        report = display("merge")
        photographs = [read_photograph(file) for file in files]
        exposures = _exposures(files, times)
        if align:
            report(0.2, "aligning")
            photographs = align_photographs(photographs)
        report(0.4, "response")
        curve = _response(response, photographs, exposures)
        report(0.7, "merging")
        merged = merge_bracket(photographs, exposures, curve)
        write_picture(merged.picture, output)
        report(1.0, "done")
    if save_response is not None:
        write_response(curve, save_response)
    if not quiet:
        over, under = merged.overflow.mean(), merged.underflow.mean()
        typer.echo(
            f"{output}: {len(files)} photographs; {over:.3%} of the pixels too bright"
            f" for the shortest exposure, {under:.3%} too dark for the longest"
        )


def _exposures(files: list[Path], times: list[float] | None) -> list[Exposure]:
    if not times:
        return [read_exposure(file) for file in files]
    if len(times) != len(files):
        raise InputError(
            f"{len(times)} exposure times for {len(files)} photographs; one each"
            " expected"
        )
    return [Exposure(time=time) for time in times]


def _response(
    name: str, photographs: list[Photograph], exposures: list[Exposure]
) -> ResponseCurve:
    if name in ("debevec", "robertson"):
        return recover_response(photographs, exposures, method=name)  # type: ignore[arg-type]
    if name == "srgb":
        return srgb_response()
    if name == "linear":
        return linear_response()
    return read_response(name)


def reproject(
    file: PictureFile,
    output: Output,
    lens: Annotated[
        Mapping, typer.Option("--lens", help="How the lens maps angles to radii.")
    ] = "equisolid",
    coefficients: Annotated[
        list[float] | None,
        typer.Option(
            "--coefficient",
            help="Of θ, θ², … of a polynomial lens, once each.",
            metavar="X",
        ),
    ] = None,
    circle: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            "--circle",
            help="Image circle: pixels to the right and down from the upper left,"
            " radius at 90°. The largest in the middle if not given.",
            metavar="X Y R",
        ),
    ] = None,
    view: Annotated[
        str,
        typer.Option("--view", help="View to make.", metavar="VIEW"),
    ] = "-vta -vh 180 -vv 180",
    resolution: Annotated[
        int, typer.Option("--resolution", help="Columns and rows.", min=21, metavar="N")
    ] = 1000,
    vignetting: Annotated[
        list[float] | None,
        typer.Option(
            "--vignetting",
            help="Of θ², θ⁴, … of the share that the lens passes, once each.",
            metavar="X",
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Turn a fisheye photograph into a view that glare can be told from."""
    picture = read_picture(file)
    place = circle or (
        picture.columns / 2,
        picture.rows / 2,
        min(picture.columns, picture.rows) / 2,
    )
    with progress_display(quiet=quiet) as display:
        report = display("reproject")
        target: View = parse_view(view)
        columns, rows = target.size_for(resolution)
        seen = reproject_picture(
            picture,
            Lens(lens, tuple(coefficients or ())),
            ImageCircle(row=place[1], column=place[0], radius=place[2]),
            view=target,
            columns=columns,
            rows=rows,
        )
        if vignetting:
            seen = correct_vignetting(seen, Vignetting(tuple(vignetting)))
        write_picture(seen, output)
        report(1.0, "done")


def calibrate(
    file: PictureFile,
    output: Output,
    before: Annotated[
        float,
        typer.Option(
            "--before", help="Illuminance at the lens before the bracket [lux]."
        ),
    ],
    after: Annotated[
        float | None,
        typer.Option("--after", help="… and after it; as before if not given."),
    ] = None,
    resolution: Annotated[
        int | None,
        typer.Option(
            "--resolution", help="Reduce to so many columns.", min=21, metavar="N"
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Scale a picture of a hemisphere to the illuminance measured beside the lens."""
    result = calibrate_picture(
        read_picture(file), before=before, after=before if after is None else after
    )
    picture = result.picture
    if resolution is not None:
        rows = max(round(resolution * picture.rows / picture.columns), 1)
        picture = reduce_picture(picture, columns=resolution, rows=rows)
    write_picture(picture, output)
    if not quiet:
        typer.echo(
            f"{output}: times {result.factor:.5g} for {result.illuminance:g} lux, which"
            f" changed by {result.drift:.1%}"
        )
