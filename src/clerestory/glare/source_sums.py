"""The table of sources of a picture: sums over the pixels of each."""

import numpy as np
from jaxtyping import Float, Int

from clerestory.glare.glare_view import GlareView
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sources import Members


def tabulate(
    members: Members,
    luminance: Float[np.ndarray, "row column"],
    eye: GlareView,
    *,
    zone: Int[np.ndarray, " label"] | None = None,
) -> GlareSources:
    """Return the sources of a picture, one row each, in the order of their labels.

    Parameters
    ----------
    members : pixels of the sources
    luminance : of the pixels [cd/m²]
    zone : of each label; 0 if not given
    """
    label, row, column = members
    bright = luminance[row, column].astype(float)
    omega = eye.solid_angle[row, column]
    flux = bright * omega

    pixels = np.bincount(label, minlength=1)
    used = np.flatnonzero(pixels)

    def total(values: np.ndarray) -> np.ndarray:
        # Of the pixels of each source; a picture without any has no numbers either
        sums: np.ndarray = np.bincount(label, weights=values)[used].astype(float)
        return sums

    solid_angle, power = total(omega), total(flux)
    # The middle is weighted by luminance, and looked up in the pixel that holds it.
    # evalglare counts rows from below, and cuts off what follows the point
    rows, _ = eye.shape
    up = total(flux * (rows - 1 - row)) / power
    across = total(flux * column) / power
    at = (
        rows - 1 - up.astype(np.float32).astype(int),
        across.astype(np.float32).astype(int),
    )

    lit = total(bright * eye.eye_weight[row, column])
    return GlareSources(
        luminance=power / solid_angle,
        solid_angle=solid_angle,
        position_index=eye.position_index[at],
        sigma=eye.sigma[at],
        direction=eye.direction[at],
        illuminance=lit,
        pixels=pixels[used],
        row=rows - 1 - up,
        column=across,
        zone=np.zeros(used.size, dtype=np.int64) if zone is None else zone[used],
    )
