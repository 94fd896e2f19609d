"""`clerestory picture merge|reproject|calibrate`: pictures from photographs."""

from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests import picture as requests
from clerestory.image.arithmetic import reduce
from clerestory.image.camera_response import write_response
from clerestory.image.exposure_bracket import merge_photographs
from clerestory.image.fisheye_lens import ImageCircle, Lens, largest_circle
from clerestory.image.fisheye_lens import reproject as reproject_picture
from clerestory.image.photometric_calibration import calibrate as calibrate_picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.image.vignetting import Vignetting, correct_vignetting
from clerestory.radiance.view_text import parse_view


def merge(request: requests.MergePhotographs) -> None:
    """Merge an exposure bracket."""
    with progress_display(quiet=request.quiet) as display:
        merged, curve = merge_photographs(
            request.files,
            times=request.times,
            response=request.response,
            align_first=request.align,
            progress=display("merge"),
        )
        write_picture(merged.picture, request.output)
    if request.save_response is not None:
        write_response(curve, request.save_response)
    over, under = merged.overflow.mean(), merged.underflow.mean()
    say(
        f"{request.output}: {len(request.files)} photographs; {over:.3%} of the pixels"
        f" are too bright for the shortest exposure, {under:.3%} too dark for the"
        " longest",
        quiet=request.quiet,
    )


def reproject(request: requests.ReprojectPhotograph) -> None:
    """Reproject a fisheye photograph."""
    picture = read_picture(request.file)
    circle = largest_circle(picture)
    if request.circle is not None:
        column, row, radius = request.circle
        circle = ImageCircle(row=row, column=column, radius=radius)
    with progress_display(quiet=request.quiet) as display:
        progress = display("reproject")
        view = parse_view(request.view)
        columns, rows = view.size_for(request.resolution)
        result = reproject_picture(
            picture,
            Lens(request.lens, tuple(request.coefficients or ())),
            circle,
            view=view,
            columns=columns,
            rows=rows,
        )
        if request.vignetting:
            result = correct_vignetting(result, Vignetting(tuple(request.vignetting)))
        write_picture(result, request.output)
        progress(1.0, "done")


def calibrate(request: requests.CalibratePicture) -> None:
    """Scale a picture to measured illuminance."""
    before, columns = request.before, request.resolution
    after = before if request.after is None else request.after
    result = calibrate_picture(read_picture(request.file), before=before, after=after)
    picture = result.picture
    if columns is not None:
        rows = max(round(columns * picture.rows / picture.columns), 1)
        picture = reduce(picture, columns=columns, rows=rows)
    write_picture(picture, request.output)
    say(
        f"{request.output}: factor {result.factor:.5g} for {result.illuminance:g} lux;"
        f" illuminance changed by {result.drift:.1%}",
        quiet=request.quiet,
    )
