"""False-colour images: luminance as colours, contour lines or bands, with a legend."""

from typing import Literal, get_args

import numpy as np
from contourpy import contour_generator
from jaxtyping import Bool, UInt8
from PIL import Image, ImageDraw

from clerestory.checks import one_of
from clerestory.image.arithmetic import within_view
from clerestory.image.colour_scale import ColourScale
from clerestory.image.legend import font, legend, text_size, value_word
from clerestory.image.picture import Picture, photometric
from clerestory.image.srgb_display import to_srgb
from clerestory.image.visibility_matching import human_vision

Style = Literal["fill", "steps", "lines", "bands"]
Pixels = UInt8[np.ndarray, "row column 3"]

# Supersampling factor for antialiased lines
_FINER = 3

# Width of a band relative to the distance between levels
_BAND = 0.2


def false_colour(
    picture: Picture,
    scale: ColourScale,
    *,
    style: Style = "fill",
    extremes: bool = False,
    with_legend: bool = True,
) -> UInt8[np.ndarray, "height width 3"]:
    """Return a picture in false colour, as sRGB pixels.

    Parameters
    ----------
    picture : picture of luminance or illuminance
    scale : mapping of values to colours
    style : "fill" colours every pixel, "steps" uses one colour between two levels;
        "lines" and "bands" draw contours of the levels over the tone-mapped picture
    extremes : whether to mark the smallest value above zero and the largest value
    with_legend : whether to add a legend on the left

    Examples
    --------
    >>> from clerestory.image.colour_scale import linear_scale
    >>> ramp = np.linspace(0, 5, 90, dtype=np.float32)[None, :, None]
    >>> picture = Picture(np.tile(ramp, (60, 1, 3)))
    >>> false_colour(picture, linear_scale(picture), with_legend=False).shape
    (60, 90, 3)
    """
    one_of(style, "style", choices=get_args(Style))
    values, seen = photometric(picture).astype(float), within_view(picture)
    if style == "fill":
        pixels = scale.colours(scale.place(values))
    elif style == "steps":
        pixels = _steps(values, scale)
    else:
        draw = _with_lines if style == "lines" else _with_bands
        pixels = draw(to_srgb(human_vision(picture)), values, scale)
    pixels = np.where(seen[..., None], pixels, np.uint8(0))
    if extremes:
        pixels = _with_extremes(pixels, values, seen)
    if not with_legend:
        return pixels
    parts = (legend(scale, height=len(pixels)), pixels)
    tall = max(map(len, parts))
    return np.hstack([np.pad(p, ((0, tall - len(p)), (0, 0), (0, 0))) for p in parts])


def _steps(values: np.ndarray, scale: ColourScale) -> Pixels:
    # Fill each interval between two levels with the colour of its middle
    ends = scale.place(np.array(scale.levels))
    step = np.searchsorted(scale.levels, values, side="right") - 1
    step = np.clip(step, 0, len(ends) - 2)
    return scale.colours((ends[step] + ends[step + 1]) / 2)


def _with_bands(background: Pixels, values: np.ndarray, scale: ColourScale) -> Pixels:
    ends = scale.place(np.array(scale.levels))
    place = scale.place(values)
    nearest = np.searchsorted((ends[:-1] + ends[1:]) / 2, place)
    inside = np.abs(place - ends[nearest]) < _BAND * np.diff(ends).min() / 2
    # Draw no bands at values beyond the first or last level
    inside &= (values > scale.levels[0]) & (values < scale.levels[-1])
    return np.where(inside[..., None], scale.colours(ends[nearest]), background)


def _with_lines(background: Pixels, values: np.ndarray, scale: ColourScale) -> Pixels:
    rows, columns = values.shape
    if min(rows, columns) < 2:
        return background
    width = max(round(min(rows, columns) / 300 * _FINER), _FINER)
    size = (columns * _FINER, rows * _FINER)
    large = Image.fromarray(background).resize(size, Image.Resampling.BILINEAR)
    draw = ImageDraw.Draw(large)
    # On a logarithmic scale, contours are interpolated in the logarithm of the values
    if scale.logarithmic:
        values = np.log(np.maximum(values, scale.smallest / 10))
    generator = contour_generator(z=values)
    for level in scale.levels:
        at = float(np.log(level) if scale.logarithmic else level)
        colour = tuple(scale.colours(scale.place(np.array(level))).tolist())
        for line in generator.lines(at):
            points = (np.asarray(line) + 0.5) * _FINER
            draw.line([tuple(point) for point in points.tolist()], colour, width)
    return np.asarray(large.resize((columns, rows), Image.Resampling.BOX))


def _with_extremes(
    pixels: Pixels, values: np.ndarray, seen: Bool[np.ndarray, "row column"]
) -> Pixels:
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    rows, columns = values.shape
    radius = max(min(rows, columns) // 90, 3)
    letters = font(max(min(rows, columns) // 30, 10))
    # Black pixels are outside the camera image and are excluded from the minimum
    lit = seen & (values > 0) if (values[seen] > 0).any() else seen
    for find, away in ((np.argmin, np.inf), (np.argmax, -np.inf)):
        row, column = divmod(int(find(np.where(lit, values, away))), columns)
        text = value_word(float(values[row, column]))
        width, height = text_size(text, letters)
        # Place the label right of the mark if there is space, otherwise left
        x = column + 2 * radius
        x = x if x + width < columns else column - 2 * radius - width
        y = min(max(row - height // 2, 1), max(rows - height - 3, 1))
        box = (column - radius, row - radius, column + radius, row + radius)
        draw.ellipse(box, outline="black", width=max(radius // 2, 3))
        draw.ellipse(box, outline="white", width=max(radius // 4, 1))
        draw.text((x, y), text, "white", letters, stroke_width=2, stroke_fill="black")
    return np.asarray(image)
