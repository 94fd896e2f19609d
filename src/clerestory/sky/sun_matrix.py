"""Sun matrix: direct normal irradiance from every solar position at every time step.

Every step with direct irradiance has its exact solar position, unlike in the five-phase
method with 5185 patch centres, most of which the sun never reaches. Solar positions
within a given angle are merged into the position with the largest irradiance.
"""

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, csc_array

from clerestory.argument_types import checked_fields
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.checks import require, within
from clerestory.constants import SUN_DIAMETER
from clerestory.errors import MatrixError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import Axis, time_axis, unknown_axis
from clerestory.sky.daylight_spectra import DaylightSpectra
from clerestory.sky.sky_conditions import SkyConditions, SkyOptions, sky_conditions
from clerestory.sky.solar_radiance import sun_radiance
from clerestory.sky.spectral_light import scaled_steps, sun_colours
from clerestory.sky.weather import Weather

# Largest angle within which solar positions may be merged [°]
_WIDEST_TOLERANCE_DEG = 10.0


@checked_fields
@dataclass(frozen=True, eq=False)
class SunMatrix:
    """Direct normal irradiance [W/m²] from every solar position at every time step.

    Rows are solar positions, columns are time steps, each with at most one position.

    Attributes
    ----------
    directions : unit vectors to the suns
    times : centres of the time steps
    direct_normal : irradiance of white light with the sun's illuminance
    colour : factor on `direct_normal` in each band; None for a white sun
    chromatic : parts of the irradiance without illuminance, with their factors in each
        band, of suns whose colour changes over time
    attributes : provenance of the matrix
    """

    directions: Float[np.ndarray, "sun 3"]
    times: np.ndarray
    direct_normal: csc_array
    attributes: Mapping[str, str | float]
    colour: Float[np.ndarray, " band"] | None = None
    chromatic: tuple[tuple[csc_array, Float[np.ndarray, " band"]], ...] = ()

    __repr__ = brief

    def __post_init__(self) -> None:
        require(
            self.direct_normal.shape == (len(self.directions), len(self.times)),
            f"irradiance of shape {self.direct_normal.shape}; {len(self.directions)}"
            f" suns by {len(self.times)} steps expected",
            error=MatrixError,
        )

    def __len__(self) -> int:
        return len(self.directions)

    @property
    def rows(self) -> Axis:
        """Axis of solar positions."""
        return unknown_axis(len(self))

    @property
    def columns(self) -> Axis:
        """Axis of time steps."""
        return time_axis(self.times)

    def select(self, steps: slice | np.ndarray) -> "SunMatrix":
        """Return the time steps in a slice or mask, with all solar positions."""
        chosen = np.arange(len(self.times))[steps]
        return replace(
            self,
            times=self.times[chosen],
            direct_normal=self.direct_normal[:, chosen],
            chromatic=tuple((normal[:, chosen], c) for normal, c in self.chromatic),
        )

    def rows_at(self, positions: Int[np.ndarray, " chosen"]) -> "SunMatrix":
        """Return some of the solar positions, with all time steps."""

        def chosen(normal: csc_array) -> csc_array:
            return csc_array(normal.tocsr()[positions])

        return replace(
            self,
            directions=self.directions[positions],
            direct_normal=chosen(self.direct_normal),
            chromatic=tuple((chosen(normal), c) for normal, c in self.chromatic),
        )

    def weighted(
        self, weights: Float[np.ndarray, "out band"]
    ) -> Iterator[tuple[csc_array, Float[np.ndarray, "out band"]]]:
        """Yield parts of the irradiance, and the weights times the colour of each."""
        yield (
            self.direct_normal,
            weights if self.colour is None else weights * self.colour,
        )
        for normal, colour in self.chromatic:
            yield normal, weights * colour

    def radiance(self, diameter: float = SUN_DIAMETER) -> csc_array:
        """Radiance [W/(m²·sr)] of a solar disc of the given angular diameter [rad]."""
        return csc_array(self.direct_normal / (np.pi * (diameter / 2) ** 2))


def sun_matrix(
    weather: Weather,
    *,
    tolerance_deg: float = 0.0,
    bands: Bands = RGB,
    daylight: DaylightSpectra | None = None,
    **options: Unpack[SkyOptions],
) -> SunMatrix:
    """Return the sun matrix of all time steps with direct irradiance.

    Time steps with the sun below the horizon are excluded; the attribute
    "steps_below_horizon" is the number of these steps. Solar positions are merged
    within an angle `tolerance_deg` [°]. `bands` and `daylight` give the suns a
    spectrum, as in `sky_matrix`; by default they are white. `options` are keyword
    arguments of `sky_conditions`.
    """
    most = _WIDEST_TOLERANCE_DEG
    within(tolerance_deg, "tolerance", least=0, most=most, unit="degrees")
    conditions = sky_conditions(weather, **options)
    shining = conditions.direct_normal > 0
    up = conditions.sun.altitude > -SUN_DIAMETER / 2
    steps = np.flatnonzero(shining & up)
    irradiance = conditions.direct_normal[steps]
    directions = conditions.sun.directions()[steps]
    angle = np.radians(tolerance_deg)
    representative = merge_suns(directions, irradiance, tolerance=angle)
    kept, sun = np.unique(representative, return_inverse=True)
    matrix = coo_array((irradiance, (sun, steps)), shape=(len(kept), len(weather)))
    found = SunMatrix(
        directions[kept],
        weather.times,
        csc_array(matrix),
        {
            **_provenance(weather, options),
            "tolerance_deg": tolerance_deg,
            "steps_below_horizon": float(np.count_nonzero(shining & ~up)),
        },
    )
    return _with_colours(found, weather, conditions, daylight, bands)


def patch_suns(
    weather: Weather,
    *,
    subdivision: int = 6,
    bands: Bands = RGB,
    daylight: DaylightSpectra | None = None,
    **options: Unpack[SkyOptions],
) -> SunMatrix:
    """Return a sun matrix with one solar position at the centre of every sky patch.

    At each time step the sun is moved to the nearest patch centre, as in the five-phase
    method. Subdivision 6 has 5185 solar positions. See `sun_matrix` for the rest.
    """
    conditions = sky_conditions(weather, **options)
    partition = reinhart(subdivision)
    direct, towards = conditions.direct_normal, conditions.sun.directions()
    radiance = sun_radiance(direct, towards, partition=partition, placement="disc")
    solid_angle = np.pi * (SUN_DIAMETER / 2) ** 2
    found = SunMatrix(
        partition.dome.centres(),
        weather.times,
        csc_array(radiance[1:] * solid_angle),
        _provenance(weather, options) | {"subdivision": float(subdivision)},
    )
    return _with_colours(found, weather, conditions, daylight, bands)


def _with_colours(
    suns: SunMatrix,
    weather: Weather,
    conditions: SkyConditions,
    daylight: DaylightSpectra | None,
    bands: Bands,
) -> SunMatrix:
    if daylight is None:
        return suns
    found = sun_colours(weather, conditions, daylight, bands)
    parts = tuple(
        (scaled_steps(suns.direct_normal, shares), colour)
        for colour, shares in zip(found.colours, found.shares, strict=True)
    )
    return replace(suns, colour=found.main, chromatic=parts)


def _provenance(weather: Weather, options: SkyOptions) -> dict[str, str | float]:
    return {
        "source": weather.source,
        "sun_formula": options.get("sun_formula", "spa"),
        "rotation_deg": options.get("rotation_deg", 0.0),
        "spectrum": options.get("spectrum", "visible"),
    }


def merge_suns(
    directions: Float[np.ndarray, "step 3"],
    weight: Float[np.ndarray, " step"],
    *,
    tolerance: float,
) -> Int[np.ndarray, " step"]:
    """Merge solar positions; return the index of the step that represents each step.

    In greedy clustering, the unassigned time step of largest weight represents all
    unassigned time steps with the sun within the angle `tolerance` [rad].
    """
    count = len(directions)
    if count == 0 or tolerance == 0:
        return np.arange(count)
    # Imported here, since scipy.spatial loads slowly
    tree = importlib.import_module("scipy.spatial").cKDTree(directions)
    near = tree.query_ball_point(directions, 2 * np.sin(tolerance / 2))
    representative = np.full(count, -1)
    for step in np.argsort(-weight, kind="stable"):
        if representative[step] < 0:
            close = np.array(near[step])
            representative[close[representative[close] < 0]] = step
    return representative
