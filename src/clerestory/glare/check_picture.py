"""Check picture: grey picture with coloured glare sources, as from evalglare -c.

The luminances of the pixels are preserved.
"""

from dataclasses import replace

import numpy as np

from clerestory.array_types import ImageMask, Vector
from clerestory.bands import RGB
from clerestory.checks import require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.glare.sources import Members
from clerestory.image.picture import Picture

Colour = tuple[float, float, float]

# Colours of successive sources: relative contributions of red, green and blue to the
# luminance
PALETTE: tuple[Colour, ...] = (
    (0.1, 0.85, 0.05),
    (0.15, 0.15, 0.7),
    (0.5, 0.5, 0.0),
    (0.5, 0.0, 0.5),
    (0.0, 0.5, 0.5),
    (0.8, 0.2, 0.0),
)
TASK_COLOUR: Colour = (0.0, 0.0, 1.0)


def check_picture(
    picture: Picture,
    members: Members,
    *,
    colour: Colour | None = None,
    task: ImageMask | None = None,
) -> Picture:
    """Return the picture in grey, with coloured glare sources and a blue task zone.

    Without `colour`, successive sources have the colours of `PALETTE`.
    """
    luminance = picture.luminance() / np.float32(LUMINOUS_EFFICACY)
    shown = np.repeat(luminance[..., None], 3, axis=2)
    if task is not None:
        shown[task] = luminance[task][:, None] * _primaries(TASK_COLOUR)
    palette = PALETTE if colour is None else (colour,)
    colours = np.stack([_primaries(one) for one in palette])
    label, row, column = members
    shown[row, column] = luminance[row, column][:, None] * colours[label % len(palette)]
    return replace(picture, radiance=shown.astype(np.float32), bands=RGB)


def _primaries(colour: Colour) -> Vector:
    # RGB radiance with the chromaticity of the colour and 179 cd/m²
    shares = np.asarray(colour, dtype=float)
    require(
        shares.min() >= 0 and 0 < shares.sum() < np.inf,
        f"colour {colour}; numbers of 0 or more, not all 0, expected",
    )
    primaries: np.ndarray = shares / shares.sum() / RGB.shares
    return primaries
