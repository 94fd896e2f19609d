"""Statistics of a picture: extremes, mean and percentiles of its luminance."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from clerestory.checks import require
from clerestory.image.picture import Picture, photometric, photometric_unit, same_size


@dataclass(frozen=True)
class Statistics:
    """Distribution of luminance [cd/m²], or illuminance [lux], over pixels.

    All pixels have equal weight. `percentile` contains pairs of a percentage and the
    value that this percentage of the pixels does not exceed.
    """

    pixels: int
    smallest: float
    mean: float
    largest: float
    percentile: tuple[tuple[float, float], ...]
    unit: str

    @property
    def median(self) -> float:
        """Median over the pixels [cd/m² or lux]."""
        return dict(self.percentile)[50.0]


def statistics(
    picture: Picture,
    mask: Bool[np.ndarray, "row column"] | None = None,
    *,
    percentages: tuple[float, ...] = (1.0, 10.0, 25.0, 50.0, 75.0, 90.0, 99.0),
) -> Statistics:
    """Return statistics of the pixels at which the mask is true (default: all)."""
    values = photometric(picture)
    if mask is not None:
        same_size(mask, values, "the mask")
        values = values[mask]
    require(values.size, "the mask selects no pixel; at least one expected")
    wanted = tuple(sorted({*percentages, 50.0}))
    found = np.percentile(values, wanted)
    return Statistics(
        pixels=int(values.size),
        smallest=float(values.min()),
        mean=float(values.mean(dtype=float)),
        largest=float(values.max()),
        percentile=tuple(zip(wanted, found.tolist(), strict=True)),
        unit=photometric_unit(picture),
    )
