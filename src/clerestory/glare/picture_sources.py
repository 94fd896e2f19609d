"""Table of the glare sources of pictures, from the pixels of the sources."""

import numpy as np
from jaxtyping import Bool, Int

from clerestory.array_types import Image, Pictures
from clerestory.glare.glare_view import GlareView
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sources import Members


def tabulate(
    members: Members,
    luminance: Image,
    eye: GlareView,
    *,
    zone: Int[np.ndarray, " label"] | None = None,
) -> GlareSources:
    """Return the table of the sources of a picture, in the order of labels."""
    every = np.ones((1, len(members.label)), bool)
    return source_table(members, every, luminance[None], eye, zone=zone)


def source_table(
    members: Members,
    own: Bool[np.ndarray, "picture member"],
    pictures: Pictures,
    eye: GlareView,
    *,
    zone: Int[np.ndarray, " label"] | None = None,
    error: Image | None = None,
) -> GlareSources:
    """Return the sources of pictures, in the order of pictures and labels.

    `own` are the members of the sources in each picture. `error` is the standard error
    of each pixel, independent of those of other pixels.
    """
    picture, member = np.nonzero(own)
    row, column = members.row[member], members.column[member]
    # Labels of the sources of a picture follow those of the picture before
    count = int(members.label.max(initial=0)) + 1
    label = members.label[member] + count * picture
    bright = pictures[picture, row, column].astype(float)
    omega = eye.solid_angle[row, column]
    flux = bright * omega

    pixels = np.bincount(label, minlength=1)
    used = np.flatnonzero(pixels)

    def total(values: np.ndarray) -> np.ndarray:
        return np.asarray(np.bincount(label, weights=values)[used], dtype=float)

    # Centre of each source, weighted by luminance; the pixel at the centre defines
    # position index and direction. evalglare counts rows from below and truncates
    # coordinates
    solid_angle, power = total(omega), total(flux)
    noise = np.zeros(used.size)
    if error is not None:
        noise = np.sqrt(total((error[row, column] * omega) ** 2))
    last = eye.shape[0] - 1
    up, across = total(flux * (last - row)) / power, total(flux * column) / power
    up_pixel, column_pixel = (x.astype(np.float32).astype(int) for x in (up, across))
    at = last - up_pixel, column_pixel
    return GlareSources(
        luminance=power / solid_angle,
        solid_angle=solid_angle,
        position_index=eye.position_index[at],
        sigma=eye.sigma[at],
        direction=eye.direction[at],
        illuminance=total(bright * eye.eye_weight[row, column]),
        pixels=pixels[used],
        row=last - up,
        column=across,
        zone=np.zeros(used.size, dtype=np.int64)
        if zone is None
        else zone[used % count],
        luminance_error=noise / solid_angle,
        step=used // count,
        steps=len(pictures),
    )
