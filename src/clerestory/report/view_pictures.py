"""Pictures of the views of a run, and their exposure for display.

The exposure of each picture is the geometric mean of its automatic exposure and the
common exposure of all pictures, so that dim pictures are darker but still visible.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import UInt8

from clerestory.escaping import file_stems
from clerestory.image.arithmetic import reduce, within_view
from clerestory.image.colour_scale import ColourScale
from clerestory.image.picture import Picture, photometric
from clerestory.image.picture_files import read_picture
from clerestory.image.srgb_display import to_srgb
from clerestory.image.tone_curves import filmic, key_luminance
from clerestory.report.colour import logarithmic_scale, value_colours
from clerestory.report.content import ReportContent
from clerestory.report.view_glare import glare_note, view_glare
from clerestory.report.window_states import states_note, table_name, window_states

Pixels = UInt8[np.ndarray, "row column 3"]

# Weight of a picture's own automatic exposure against the common exposure, 0…1
_ADAPTATION = 0.5

# False-colour scale: ratio of its limits, luminance quantile at its upper limit
_SPAN = 1000.0
_COVERED = 0.997


class Moment(NamedTuple):
    """Picture of a run: index of the time step, and picture file."""

    step: int
    file: Path


class ViewPictures(NamedTuple):
    """Pictures of one view in chronological order."""

    view: str
    moments: tuple[Moment, ...]


def view_pictures(content: ReportContent) -> tuple[ViewPictures, ...]:
    """Return the pictures requested by the study that exist in the folder.

    Other pictures, left by earlier runs, are ignored.
    """
    folder = content.picture_folder
    if folder is None:
        return ()
    study = json.loads(content.data.attrs.get("study", "{}"))
    stamps = [stamp[5:] for stamp in np.datetime_as_string(content.times, unit="m")]
    found = []
    tables = {table_name(table): table for table in study.get("view", [])}
    for view, stem in file_stems(tables).items():
        table = tables[view]
        asked = table.get("pictures") or []
        # Runs write files such as VIEW_06-21T1200.hdr
        moments = [
            Moment(step, folder / f"{stem}_{stamp.replace(':', '')}.hdr")
            for step, stamp in enumerate(stamps)
            if "every" in asked or stamp in asked
        ]
        there = tuple(moment for moment in moments if moment.file.is_file())
        if there:
            found.append(ViewPictures(view, there))
    return tuple(found)


def moment_notes(content: ReportContent) -> Callable[[str, int], str]:
    """Return a function that describes the glare and the window states in words.

    The function's arguments are the name of a view and the index of a time step.
    """
    glare, states = view_glare(content.data), window_states(content.data)

    def note(view: str, step: int) -> str:
        words = (glare_note(glare, view, step), states_note(states, step))
        return "; ".join(filter(None, words))

    return note


def read_small(file: str | Path, *, width: int) -> Picture:
    """Read a picture, and reduce it to `width` [pixels] if it is wider."""
    picture = read_picture(file)
    if picture.columns <= width:
        return picture
    rows = max(1, round(picture.rows * width / picture.columns))
    return reduce(picture, columns=width, rows=rows)


def exposures(pictures: Sequence[Picture]) -> list[float]:
    """Return the luminance shown as white in each picture [cd/m²].

    This is the geometric mean of `key_luminance` of the picture and the average of
    `key_luminance` over all pictures.
    """
    keys = np.log([key_luminance(picture) for picture in pictures])
    mixed = _ADAPTATION * keys + (1 - _ADAPTATION) * keys.mean()
    return [float(x) for x in np.exp(mixed)]


def as_seen(picture: Picture, white: float) -> Pixels:
    """Return a tone-mapped picture in sRGB; white outside the view."""
    return _on_paper(to_srgb(filmic(picture, white=white)), picture)


def luminance_scale(pictures: Sequence[Picture]) -> ColourScale:
    """Return a common false-colour scale of three decades for several pictures."""
    seen = [photometric(picture)[within_view(picture)] for picture in pictures]
    top = float(np.quantile(np.concatenate(seen), _COVERED))
    steps = [m * 10.0**decade for decade in range(7) for m in (1, 3)]
    high = next((x for x in steps if x >= top), steps[-1])
    return logarithmic_scale(high / _SPAN, high, "cd/m²")


def as_luminance(picture: Picture, scale: ColourScale) -> Pixels:
    """Return a false-colour luminance image in sRGB; white outside the view."""
    return _on_paper(value_colours(scale, photometric(picture).astype(float)), picture)


def _on_paper(pixels: Pixels, picture: Picture) -> Pixels:
    return np.where(within_view(picture)[..., None], pixels, np.uint8(255))
