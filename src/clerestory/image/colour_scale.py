"""Colour scales of false-colour pictures: range, palette, levels."""

from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.ticker import MaxNLocator

from clerestory.brief_repr import brief
from clerestory.checks import positive, require
from clerestory.image.arithmetic import within_view
from clerestory.image.picture import Picture, photometric, photometric_unit

# Percentile of the pixel values at the upper limit of an automatic scale
_COVERED = 99.5

# Round numbers within a decade
_DECADE = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class ColourScale:
    """Mapping of a range of values to colours, with levels for legend and contours.

    Attributes
    ----------
    smallest, largest : values shown in the first and the last colour [cd/m² or lux]
    levels : increasing values that are labelled in the legend and drawn as contours
    unit : unit of the values in the legend
    logarithmic : whether the scale is logarithmic instead of linear
    palette : name of a matplotlib colour map; "gnuplot" resembles Radiance's pm3d
    ends : positions of the first and the last colour within the palette, 0…1
    steps : number of colours
    """

    smallest: float
    largest: float
    levels: tuple[float, ...]
    unit: str = ""
    logarithmic: bool = False
    palette: str = "turbo"
    ends: tuple[float, float] = (0.0, 1.0)
    steps: int = 1024

    __repr__ = brief

    def __post_init__(self) -> None:
        least = 0.0 if self.logarithmic else -np.inf
        require(
            least < self.smallest < self.largest < np.inf,
            f"colour scale from {self.smallest:g} to {self.largest:g}; a smallest value"
            f"{' above 0 and' if self.logarithmic else ''} below the largest expected",
        )
        require(
            self.palette in mpl.colormaps,
            f'palette "{self.palette}"; a colour map of matplotlib expected,'
            " such as turbo, viridis, inferno or gnuplot",
        )
        require(
            len(self.levels) >= 2 and np.all(np.diff(self.levels) > 0),
            f"levels {self.levels}; two or more increasing numbers expected",
        )

    def place(self, values: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch"]:
        """Positions of values on the scale, from 0 (`smallest`) to 1 (`largest`)."""
        if self.logarithmic:
            ratio = np.maximum(values, self.smallest) / self.smallest
            place = np.log(ratio) / np.log(self.largest / self.smallest)
        else:
            place = (values - self.smallest) / (self.largest - self.smallest)
        return np.asarray(np.clip(place, 0, 1))

    def colours(self, place: Float[np.ndarray, "*batch"]) -> UInt8[np.ndarray, "..."]:
        """Colours (sRGB) at positions 0…1 of the scale."""
        step = np.round(np.asarray(place) * (self.steps - 1)).astype(int)
        return np.asarray(self.table()[step])

    def table(self) -> UInt8[np.ndarray, "step 3"]:
        """Colours (sRGB) from `smallest` to `largest`."""
        colours = mpl.colormaps[self.palette](np.linspace(*self.ends, self.steps))
        return np.round(255 * colours[:, :3]).astype(np.uint8)


def linear_scale(
    picture: Picture,
    *,
    smallest: float = 0.0,
    largest: float | None = None,
    divisions: int = 10,
    palette: str = "turbo",
) -> ColourScale:
    """Return a linear colour scale for a picture.

    By default, the scale ends at a round value that 99.5 % of the pixels do not exceed;
    levels are then round values, with about `divisions` intervals between them.
    """
    require(divisions >= 1, f"{divisions} divisions; 1 or more expected")
    if largest is None:
        covered = max(_covered(picture), smallest + 1e-9)
        locator = MaxNLocator(divisions, steps=[1, 2, 2.5, 5, 10])
        round_levels = np.asarray(locator.tick_values(smallest, covered))
        levels = (smallest, *round_levels[round_levels > smallest].tolist())
    else:
        levels = tuple(np.linspace(smallest, largest, divisions + 1).tolist())
    unit = photometric_unit(picture)
    return ColourScale(smallest, levels[-1], levels, unit, palette=palette)


def logarithmic_scale(
    picture: Picture,
    *,
    largest: float | None = None,
    decades: float = 3.0,
    palette: str = "turbo",
) -> ColourScale:
    """Return a logarithmic colour scale for a picture, with levels at 1, 2, 5, 10, ….

    By default, the scale ends at a round value that 99.5 % of the pixels do not exceed.
    """
    require(
        0 < decades <= 30, f"scale of {decades:g} decades; above 0, at most 30 expected"
    )
    if largest is None:
        largest = round_up(_covered(picture))
    positive(largest, "largest value of the scale")
    smallest = largest / 10**decades
    first, last = np.floor(np.log10(smallest)), np.ceil(np.log10(largest))
    numbers = np.outer(10.0 ** np.arange(first - 1, last + 1), _DECADE).ravel()
    inner = numbers[(numbers > smallest * 1.001) & (numbers < largest * 0.999)]
    levels = (smallest, *inner.tolist(), largest)
    unit = photometric_unit(picture)
    return ColourScale(smallest, largest, levels, unit, True, palette)


def round_up(value: float) -> float:
    """Round a value up to 1, 2 or 5 times a power of ten; values ≤ 0 give 1.

    >>> round_up(321.0), round_up(0.0)
    (500.0, 1.0)
    """
    if value <= 0:
        return 1.0
    steps = 10.0 ** np.floor(np.log10(value)) * np.array([*_DECADE, 10])
    return float(steps[steps >= value * (1 - 1e-9)][0])


def _covered(picture: Picture) -> float:
    return float(np.percentile(photometric(picture)[within_view(picture)], _COVERED))
