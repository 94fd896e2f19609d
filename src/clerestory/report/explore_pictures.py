"""Pictures of a run for the interactive page, tone-mapped."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import image_address, jpeg_bytes
from clerestory.report.period import evenly, moment_words
from clerestory.report.view_pictures import (
    Moment,
    ViewPictures,
    as_seen,
    exposures,
    read_small,
    view_pictures,
)

# Numbers of pictures of all views, and widths [pixels], that are tried in a file
_SIZES = ((60, 400), (36, 320), (24, 240), (12, 200))

# Width of served pictures [pixels]; JPEG quality
_WIDTH, _QUALITY = 800, 78

# Pictures of a view from which its common exposure is found
_SAMPLE = 8


class Frame(NamedTuple):
    """Picture of a view: index of its time step, date and time, address."""

    step: int
    time: str
    address: str


class Frames(NamedTuple):
    """Pictures of a view in chronological order."""

    view: str
    frames: list[Frame]

    def facts(self) -> dict[str, object]:
        """Return the pictures as JSON values."""
        return {"view": self.view, "frames": [f._asdict() for f in self.frames]}


def embedded_frames(content: ReportContent, *, most: int) -> list[Frames]:
    """Return pictures as data URLs of at most `most` characters together."""
    views = view_pictures(content)
    for count, width in _SIZES if views else ():
        found = [_embedded(view, content, count // len(views), width) for view in views]
        if sum(len(f.address) for each in found for f in each.frames) <= most:
            return [each for each in found if each.frames]
    return []


def served_frames(
    content: ReportContent,
) -> tuple[list[Frames], dict[str, Callable[[], bytes]]]:
    """Return all pictures by address, and functions that return their JPEG data."""
    found: list[Frames] = []
    images: dict[str, Callable[[], bytes]] = {}
    for number, view in enumerate(view_pictures(content)):
        frames = []
        for k, moment in enumerate(view.moments):
            address = f"picture/{number}-{k}"
            frames.append(_frame(moment, content, address))
            images[address] = partial(_jpeg, view, moment, _WIDTH)
        found.append(Frames(view.view, frames))
    return found, images


def _embedded(
    view: ViewPictures, content: ReportContent, count: int, width: int
) -> Frames:
    frames = []
    for k in evenly(len(view.moments), count):
        moment = view.moments[k]
        image = _jpeg(view, moment, width)
        frames.append(_frame(moment, content, image_address(image, kind="jpeg")))
    return Frames(view.view, frames)


def _frame(moment: Moment, content: ReportContent, address: str) -> Frame:
    return Frame(moment.step, moment_words(content.times[moment.step]), address)


def _jpeg(view: ViewPictures, moment: Moment, width: int) -> bytes:
    # The exposure depends on the picture itself and on some pictures of the view
    sample = [view.moments[k] for k in evenly(len(view.moments), _SAMPLE)]
    pictures = [read_small(m.file, width=width) for m in (moment, *sample)]
    seen = as_seen(pictures[0], exposures(pictures)[0])
    return jpeg_bytes(seen, width=width, quality=_QUALITY)
