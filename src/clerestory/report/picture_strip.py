"""Pictures of selected time steps of each view, also in false colour."""

from collections.abc import Callable

import numpy as np

from clerestory.report.colour import colour_bar
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import jpeg
from clerestory.report.markup import Markup, element, render
from clerestory.report.period import evenly, moment_words
from clerestory.report.section import Section
from clerestory.report.view_pictures import (
    ViewPictures,
    as_luminance,
    as_seen,
    exposures,
    luminance_scale,
    moment_notes,
    read_small,
    view_pictures,
)

# Pictures per view for one or two views, for more views; width [pixels]; JPEG quality
_MOST, _MOST_OF_MANY = 6, 3
_WIDTH = 480
_QUALITY = 82


def pictures_section(content: ReportContent) -> Section:
    """Return the pictures of each view, with false-colour images below."""
    views = view_pictures(content)
    if not views:
        return Section()
    most = _MOST if len(views) < 3 else _MOST_OF_MANY
    note = moment_notes(content)
    strips = [picture_figures(view, most, content.times, note) for view in views]
    return Section(render("pictures.html", views=strips))


def picture_figures(
    view: ViewPictures, most: int, times: np.ndarray, note: Callable[[str, int], str]
) -> dict[str, object]:
    """Return up to `most` pictures of a view, tone-mapped and in false colour."""
    name, total = view.view, len(view.moments)
    moments = [view.moments[k] for k in evenly(total, most)]
    pictures = [read_small(moment.file, width=_WIDTH) for moment in moments]
    scale = luminance_scale(pictures)
    figures = []
    for moment, picture, white in zip(
        moments, pictures, exposures(pictures), strict=True
    ):
        time = moment_words(times[moment.step])
        seen, luminance = as_seen(picture, white), as_luminance(picture, scale)
        figures.append(
            {
                "time": time,
                "note": note(name, moment.step),
                "photograph": _image(seen, f"{name}, {time}"),
                "luminance": _image(luminance, f"Luminance of {name}, {time}"),
            }
        )
    some = f" · {len(moments)} of {total} time steps" * (len(moments) < total)
    return {
        "title": name + some,
        "wide": pictures[0].columns > 1.2 * pictures[0].rows,
        "figures": figures,
        "bar": colour_bar(scale),
    }


def _image(pixels: np.ndarray, words: str) -> Markup:
    rows, columns = pixels.shape[:2]
    address = jpeg(pixels, width=_WIDTH, quality=_QUALITY)
    return element("img", src=address, alt=words, width=columns, height=rows)
