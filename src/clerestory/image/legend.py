"""Legend of a false-colour picture: a colour bar with values and unit."""

from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw, ImageFont

from clerestory.image.colour_scale import ColourScale

# Ratio of font size to picture height; smallest and largest font size [pixels]
_LETTERS, _SMALLEST, _LARGEST = 1 / 30, 10, 26

# Smallest height of the legend, in lines of text
_LINES = 6


@cache
def font(size: int) -> ImageFont.FreeTypeFont:
    """Return the font DejaVu Sans, which is part of every matplotlib installation."""
    folder = Path(mpl.get_data_path()) / "fonts" / "ttf"
    return ImageFont.truetype(str(folder / "DejaVuSans.ttf"), size)


def text_size(text: str, letters: ImageFont.FreeTypeFont) -> tuple[int, int]:
    """Return width and height of a line of text [pixels]."""
    left, _, right, _ = letters.getbbox(text)
    ascent, descent = letters.getmetrics()
    return int(np.ceil(right - left)), ascent + descent


def legend(scale: ColourScale, *, height: int) -> UInt8[np.ndarray, "row column 3"]:
    """Return the colour bar of a scale with its unit and values, white on black.

    Labels that would overlap are left out. The legend is higher than `height` [pixels]
    if the text requires it.
    """
    letters = font(int(np.clip(height * _LETTERS, _SMALLEST, _LARGEST)))
    line = text_size("0", letters)[1]
    height = max(height, _LINES * line)
    words = [value_word(level) for level in scale.levels]
    gap = line // 2
    bar = 2 * line
    widest = max(text_size(word, letters)[0] for word in (*words, scale.unit))
    image = Image.new("RGB", (bar + widest + 4 * gap, height))
    draw = ImageDraw.Draw(image)
    draw.text((gap, gap), scale.unit, "white", letters)
    top, bottom = gap + 2 * line, height - line
    # Colour bar with the largest value at the top
    colours = scale.colours(np.linspace(1, 0, bottom - top))
    colours = np.repeat(colours[:, None], bar, axis=1)
    image.paste(Image.fromarray(colours), (gap, top))
    # Draw labels from the bottom upwards, where there is space
    free = float(height)
    places = scale.place(np.array(scale.levels, dtype=float)).tolist()
    for place, word in zip(places, words, strict=True):
        y = bottom - place * (bottom - top)
        close = free - y < line and place > 0
        if close and place < 1:
            continue
        if close:
            # The label of the largest value replaces its neighbour
            box = (gap + bar, int(y), image.width, int(y + 1.5 * line))
            draw.rectangle(box, "black")
        draw.line((gap + bar, y, gap + bar + gap // 2, y), "white")
        draw.text((2 * gap + bar, y - line / 2), word, "white", letters)
        free = y
    return np.asarray(image)


def value_word(value: float) -> str:
    """Return a number with at least three significant digits, without trailing zeros.

    Thousands are separated by thin spaces.

    >>> value_word(0.012345), value_word(5.2e8), value_word(20)
    ('0.0123', '5.2e8', '20')
    """
    if value and not 1e-4 <= abs(value) < 1e7:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
    digits = max(0, 2 - int(np.floor(np.log10(abs(value))))) if value else 0
    text = f"{value:,.{digits}f}".replace(",", "\u2009")
    return text.rstrip("0").rstrip(".") if "." in text else text
