"""Colour scales of false-colour pictures: range, palette, levels."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.ticker import MaxNLocator

from clerestory.errors import InputError
from clerestory.image.arithmetic import within_view
from clerestory.image.picture import Picture, photometric

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
    logarithmic : whether the scale is logarithmic instead of linear
    palette : name of a matplotlib colour map; "gnuplot" resembles Radiance's pm3d

    Raises
    ------
    InputError : empty range, unknown palette, or levels not increasing

    Examples
    --------
    >>> scale = ColourScale(0, 1000, levels=(0, 500, 1000))
    >>> scale.place(np.array([250.0, 2000.0])).tolist()
    [0.25, 1.0]
    """

    smallest: float
    largest: float
    levels: tuple[float, ...]
    logarithmic: bool = False
    palette: str = "turbo"

    def __post_init__(self) -> None:
        least = 0.0 if self.logarithmic else -np.inf
        if not least < self.smallest < self.largest < np.inf:
            raise InputError(
                f"scale from {self.smallest:g} to {self.largest:g};"
                f" a growing{' positive' if self.logarithmic else ''} range expected"
            )
        if self.palette not in mpl.colormaps:
            raise InputError(
                f'palette "{self.palette}"; a colour map of matplotlib expected,'
                " such as turbo, viridis, inferno or gnuplot"
            )
        if len(self.levels) < 2 or np.any(np.diff(self.levels) <= 0):
            raise InputError("two or more increasing levels expected")

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
        table = mpl.colormaps[self.palette](np.linspace(0, 1, 1024))[:, :3]
        codes = np.round(255 * table).astype(np.uint8)
        found: np.ndarray = codes[np.round(np.asarray(place) * 1023).astype(int)]
        return found


def linear_scale(
    picture: Picture,
    *,
    smallest: float = 0.0,
    largest: float | None = None,
    divisions: int = 10,
    palette: str = "turbo",
) -> ColourScale:
    """Return a linear scale for a picture.

    Parameters
    ----------
    picture : picture whose pixel values determine the automatic range
    smallest, largest : limits of the scale; default of `largest`: a round number above
        99.5 % of the pixels
    divisions : number of intervals between levels; approximate, with round levels, if
        the range is automatic
    palette : name of a matplotlib colour map
    """
    if divisions < 1:
        raise InputError(f"{divisions} divisions; at least 1 expected")
    if largest is None:
        covered = max(_covered(picture), smallest + 1e-9)
        levels = MaxNLocator(divisions, steps=[1, 2, 2.5, 5, 10]).tick_values(
            smallest, covered
        )
        largest = float(levels[-1])
        inner = [float(x) for x in levels if x > smallest]
        return ColourScale(smallest, largest, (smallest, *inner), palette=palette)
    even = np.linspace(smallest, largest, divisions + 1)
    return ColourScale(smallest, largest, tuple(even.tolist()), palette=palette)


def logarithmic_scale(
    picture: Picture,
    *,
    largest: float | None = None,
    decades: float = 3.0,
    palette: str = "turbo",
) -> ColourScale:
    """Return a logarithmic scale for a picture, with levels at 1, 2, 5, 10, ….

    Parameters
    ----------
    picture : picture whose pixel values determine the automatic range
    largest : upper limit; default: a round number above 99.5 % of the pixels
    decades : number of decades that the scale spans
    palette : name of a matplotlib colour map
    """
    if not 0 < decades <= 30:
        raise InputError(f"scale of {decades:g} decades; above 0, at most 30 expected")
    if largest is None:
        largest = round_up(_covered(picture))
    if not 0 < largest < np.inf:
        raise InputError(f"scale up to {largest:g}; a positive number expected")
    smallest = largest / 10**decades
    powers = range(
        int(np.floor(np.log10(smallest))) - 1, int(np.ceil(np.log10(largest))) + 1
    )
    numbers = [m * 10.0**p for p in powers for m in _DECADE]
    inner = [x for x in numbers if smallest * 1.001 < x < largest * 0.999]
    levels = (smallest, *inner, largest)
    return ColourScale(smallest, largest, levels, logarithmic=True, palette=palette)


def round_up(value: float, steps: Sequence[float] = (*_DECADE, 10.0)) -> float:
    """Return the next 1, 2 or 5 times a power of ten not below a value; 1 if ≤ 0.

    >>> round_up(321.0), round_up(0.0)
    (500.0, 1.0)
    """
    if value <= 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(m * power for m in steps if m * power >= value * (1 - 1e-9)))


def _covered(picture: Picture) -> float:
    return float(np.percentile(photometric(picture)[within_view(picture)], _COVERED))
