"""Pictures of selected time steps of each view, also in false colour."""

from collections.abc import Callable, Sequence

import numpy as np

from clerestory.report.colour_bar import colour_bar
from clerestory.report.embedded_data import jpeg
from clerestory.report.markup import Markup, element, render
from clerestory.report.period import moment_words
from clerestory.report.view_pictures import (
    Moment,
    ViewPictures,
    as_luminance,
    as_seen,
    exposures,
    luminance_scale,
    read_small,
)

# Pictures per view, for up to two views and for more; image width and JPEG quality
_MOST, _MOST_OF_MANY = 6, 3
_WIDTH = 480
_QUALITY = 82


def pictures_section(
    views: Sequence[ViewPictures],
    times: np.ndarray,
    *,
    note: Callable[[str, int], str],
) -> Markup:
    """Return the pictures, with false-colour images below.

    Parameters
    ----------
    views : pictures of each view
    times : times of all time steps
    note : function that describes a view at a time step
    """
    if not views:
        return Markup("")
    most = _MOST if len(views) < 3 else _MOST_OF_MANY
    strips = [_strip(view, spread(view.moments, most), times, note) for view in views]
    return render("pictures.html", views=strips)


def spread(moments: Sequence[Moment], most: int) -> list[Moment]:
    """Return at most `most` moments, evenly spaced."""
    count = min(len(moments), most)
    places = np.unique(np.linspace(0, len(moments) - 1, count).round().astype(int))
    return [moments[k] for k in places.tolist()]


def _title(view: ViewPictures, shown: int) -> str:
    total = len(view.moments)
    return view.view if shown == total else f"{view.view} · {shown} of {total} moments"


def _strip(
    view: ViewPictures,
    moments: Sequence[Moment],
    times: np.ndarray,
    note: Callable[[str, int], str],
) -> dict[str, object]:
    pictures = [read_small(moment.file, width=_WIDTH) for moment in moments]
    scale = luminance_scale(pictures)
    figures = []
    for moment, picture, white in zip(
        moments, pictures, exposures(pictures), strict=True
    ):
        time, name = moment_words(times[moment.step]), view.view
        figures.append(
            {
                "time": time,
                "note": note(name, moment.step),
                "photograph": _image(as_seen(picture, white), f"{name}, {time}"),
                "luminance": _image(
                    as_luminance(picture, scale), f"Luminance of {name}, {time}"
                ),
            }
        )
    return {
        "title": _title(view, len(moments)),
        "wide": pictures[0].columns > 1.2 * pictures[0].rows,
        "figures": figures,
        "bar": colour_bar(scale),
    }


def _image(pixels: np.ndarray, words: str) -> Markup:
    rows, columns = pixels.shape[:2]
    address = jpeg(pixels, width=_WIDTH, quality=_QUALITY)
    return element("img", src=address, alt=words, width=columns, height=rows)
