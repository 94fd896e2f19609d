"""The sky at one moment, as a function of direction and as a vector of patches.

Pictures are rendered under the function; the vector (Radiance's genskyvec) is a
sky matrix of one column and goes wherever a year of them goes.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.sparse import csc_array

from clerestory.bands import RGB, Bands
from clerestory.constants import GROUND_REFLECTANCE, SKY_COLOUR
from clerestory.errors import InputError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.sky.luminance_distribution import (
    Distribution,
    FiveParameters,
    horizontal_integral,
)
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.perez import perez_sky
from clerestory.sky.sky_conditions import SkyConditions, Spectrum, sky_conditions
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.solar_radiance import SUN_DIAMETER_DEG, SunPlacement, sun_radiance
from clerestory.sky.weather import Weather

# Points per patch edge of a sky vector
_SAMPLES = 4


@dataclass(frozen=True, eq=False)
class PointSky:
    """Sky, sun and ground at one moment.

    Attributes
    ----------
    distribution : relative luminance of the sky
    scale : what it is multiplied by [W/(m²·sr)]
    sun : unit vector to the sun
    direct_normal : irradiance from the sun [W/m²], zero for none
    ground : radiance of the ground [W/(m²·sr)]
    colour : factor of each band of the sky
    time : local standard time, NaT for none
    bands : spectral bands
    """

    distribution: Distribution
    scale: float
    sun: Float[np.ndarray, "3"]
    direct_normal: float
    ground: float
    colour: tuple[float, ...] = (1.0, 1.0, 1.0)
    time: np.datetime64 = np.datetime64("NaT", "s")  # noqa: RUF009
    bands: Bands = RGB

    def __post_init__(self) -> None:
        levels = np.array([self.scale, self.direct_normal, self.ground, *self.colour])
        if not np.all(np.isfinite(levels) & (levels >= 0)):
            raise InputError(
                f"sky of scale {self.scale}, sun {self.direct_normal}, ground"
                f" {self.ground}; finite numbers from 0 expected"
            )
        if len(self.colour) != len(self.bands):
            raise InputError(
                f"sky colour {self.colour}; one number for each of the bands"
                f" {self.bands} expected"
            )

    def radiance(
        self, direction: Float[np.ndarray, "*batch 3"]
    ) -> Float[np.ndarray, "*batch"]:
        """Grey radiance [W/(m²·sr)] of sky and ground without the sun's disc."""
        sky = self.scale * self.distribution.relative(direction, sun=self.sun)
        return np.where(direction[..., 2] > 0, sky, self.ground)

    def diffuse_horizontal(self) -> float:
        """Irradiance [W/m²] that the sky sends to a level plane."""
        return self.scale * horizontal_integral(self.distribution, sun=self.sun)


def perez_point(
    weather: Weather,
    *,
    ground_reflectance: float = GROUND_REFLECTANCE,
    sky_colour: tuple[float, float, float] = SKY_COLOUR,
    rotation_deg: float = 0.0,
    sun_formula: SunFormula = "spa",
    dew_point_c: float | None = None,
    spectrum: Spectrum = "visible",
) -> PointSky:
    """Return Perez's sky for weather of a single step.

    The arguments are those of `sky_matrix`; `weather.select(slice(i, i + 1))` is
    one step of a year.

    Raises
    ------
    InputError : more than one step, or an argument outside its range
    """
    if len(weather) != 1:
        raise InputError(f"weather of {len(weather)} steps; a single one expected")
    conditions = sky_conditions(
        weather,
        rotation_deg=rotation_deg,
        sun_formula=sun_formula,
        dew_point_c=dew_point_c,
        spectrum=spectrum,
    )
    return perez_under(
        conditions,
        ground_reflectance=ground_reflectance,
        sky_colour=sky_colour,
        time=weather.times[0],
    )


def perez_under(
    conditions: SkyConditions,
    *,
    ground_reflectance: float = GROUND_REFLECTANCE,
    sky_colour: tuple[float, float, float] = SKY_COLOUR,
    time: np.datetime64 = np.datetime64("NaT", "s"),  # noqa: B008
) -> PointSky:
    """Return Perez's sky under the conditions of a single step."""
    sky = perez_sky(conditions.state, azimuth=conditions.sun.azimuth)
    shape = FiveParameters(*(float(p[0]) for p in (sky.a, sky.b, sky.c, sky.d, sky.e)))
    diffuse = float(conditions.diffuse_horizontal[0])
    level = diffuse + float(conditions.direct_horizontal()[0])

    # The model keeps the glow of a high sun off the zenith, so it has its own sun
    distribution = _Fixed(shape, sky.sun[0])
    total = horizontal_integral(distribution, sun=sky.sun[0])
    if not total > 0:
        distribution, total = _Fixed(FiveParameters(0, 0, 0, 0, 0), sky.sun[0]), np.pi
    return PointSky(
        distribution,
        diffuse / total,
        conditions.sun.directions()[0],
        float(conditions.direct_normal[0]),
        ground_reflectance * level / np.pi,
        sky_colour,
        time,
    )


@dataclass(frozen=True, eq=False)
class _Fixed:
    # A distribution around a glow that is not quite at the sun's place
    shape: FiveParameters
    glow: Float[np.ndarray, "3"]

    def relative(
        self, direction: Float[np.ndarray, "*batch 3"], *, sun: Float[np.ndarray, "3"]
    ) -> Float[np.ndarray, "*batch"]:
        return self.shape.relative(direction, sun=self.glow)


def sky_vector(
    sky: PointSky,
    *,
    subdivision: int = 4,
    sun: SunPlacement = "spread",
    sun_diameter_deg: float = SUN_DIAMETER_DEG,
) -> SkyMatrix:
    """Return the mean radiance of every patch, as a sky matrix of one column.

    The mean is over 16 points of the patch, weighted by its projected solid
    angle, so that the level plane receives what the function of direction sends.

    Parameters
    ----------
    sky : the sky at one moment
    subdivision : Reinhart's MF, 1 to 6
    sun : how the direct sun is put into patches, see `direct.sun_radiance`
    sun_diameter_deg : apparent diameter of the sun if it is put as a "disc"
    """
    partition = reinhart(subdivision)
    dome = partition.dome
    edge = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    u = np.stack(np.meshgrid(edge, edge, indexing="ij"), axis=-1).reshape(-1, 2)
    patch = np.repeat(np.arange(len(dome)), len(u))
    points = dome.sample(patch, np.tile(u, (len(dome), 1)))
    mean = sky.radiance(points).reshape(len(dome), -1).mean(axis=1)

    # The ground's radiance holds its reflectance already
    diffuse = np.append(sky.ground, mean).astype(np.float32)[:, None]
    tint = np.repeat(np.array(sky.colour)[:, None], len(dome), axis=1)
    direct = sun_radiance(
        np.array([sky.direct_normal]),
        sky.sun[None],
        partition=partition,
        placement=sun,
        diameter_deg=sun_diameter_deg,
    )
    return SkyMatrix(
        partition=partition,
        times=np.array([sky.time], dtype="datetime64[s]"),
        diffuse=diffuse,
        colour=np.column_stack([np.ones(len(tint)), tint]),
        sun=csc_array(direct),
        sun_colour=np.ones(len(tint)),
        attributes={"sun": sun},
        bands=sky.bands,
    )
