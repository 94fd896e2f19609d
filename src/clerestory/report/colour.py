"""Colour scales with perceptually uniform palettes."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8
from matplotlib import colormaps

_LEVELS = 128


@dataclass(frozen=True)
class ColourScale:
    """Mapping of a range of values to colours.

    Attributes
    ----------
    low, high : limits of the range; values outside are clipped
    unit : unit of the values in the legend
    palette : name of a perceptually uniform colour map of Matplotlib
    logarithmic : whether the scale is logarithmic instead of linear
    """

    low: float
    high: float
    unit: str
    palette: str = "viridis"
    logarithmic: bool = False

    def fraction(
        self, values: Float[np.ndarray, "*batch"]
    ) -> Float[np.ndarray, "*batch"]:
        """Position of the values on the scale, 0…1."""
        values = np.clip(values, self.low, self.high)
        if self.logarithmic:
            return np.asarray(
                np.log(values / self.low) / math.log(self.high / self.low)
            )
        return np.asarray((values - self.low) / (self.high - self.low))

    def table(self) -> UInt8[np.ndarray, "level 3"]:
        """Colours from `low` to `high` (red, green, blue)."""
        colours = colormaps[self.palette](np.linspace(0.04, 0.98, _LEVELS))
        return np.round(255 * colours[:, :3]).astype(np.uint8)

    def colours(
        self, values: Float[np.ndarray, "*batch"]
    ) -> UInt8[np.ndarray, "*batch 3"]:
        """Colour of each value."""
        level = np.round(self.fraction(values) * (_LEVELS - 1)).astype(int)
        return np.asarray(self.table()[level])

    def hexadecimal(self, values: Float[np.ndarray, " value"]) -> list[str]:
        """Colour of each value as `#rrggbb`."""
        return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in self.colours(values).tolist()]

    def ticks(self) -> list[float]:
        """Round values for the ticks of the scale.

        >>> ColourScale(0, 900, "lux").ticks()
        [0.0, 200.0, 400.0, 600.0, 800.0]
        """
        if self.logarithmic:
            decades = range(math.floor(math.log10(self.low)), 7)
            steps = [float(m * 10.0**decade) for decade in decades for m in (1, 3)]
            if self.high / self.low > 2000:
                steps = steps[::2]
        else:
            step = nice_step((self.high - self.low) / 4)
            steps = [step * k for k in range(math.floor(self.high / step) + 1)]
        return [
            x
            for x in steps
            if self.low <= x * (1 + 1e-9) and x <= self.high * (1 + 1e-9)
        ]


def nice_step(size: float) -> float:
    """Return 1, 2 or 5 times a power of ten, whichever is nearest to `size`.

    >>> nice_step(0.26), nice_step(1300)
    (0.2, 1000.0)
    """
    size = max(size, 1e-12)
    decade = 10.0 ** math.floor(math.log10(size))
    return float(
        min((decade * m for m in (1, 2, 5, 10)), key=lambda x: abs(math.log(x / size)))
    )


def percent_scale() -> ColourScale:
    """Return the scale of percentages from 0 to 100."""
    return ColourScale(0, 100, "%")


def illuminance_scale(
    illuminance: Float[np.ndarray, "*batch"], *, low: float | None = None
) -> ColourScale:
    """Return a logarithmic scale up to the 99.5th percentile of the illuminance.

    The scale starts at `low` [lux], by default at a round value below the minimum, but
    not below 10 lux. It spans at least a factor of ten.

    Examples
    --------
    >>> scale = illuminance_scale(np.array([120.0, 480.0, 5200.0]))
    >>> scale.low, scale.high, scale.ticks()
    (100.0, 10000.0, [100.0, 300.0, 1000.0, 3000.0, 10000.0])
    """
    steps = [float(m * 10**decade) for decade in range(1, 6) for m in (1, 3)]
    if low is None:
        low = max([x for x in steps if x <= illuminance.min()], default=steps[0])
    top = max(float(np.quantile(illuminance, 0.995)), 10 * low)
    high = next((x for x in steps if x >= top), max(steps[-1], 10 * low))
    return ColourScale(low, high, "lux", "inferno", logarithmic=True)
