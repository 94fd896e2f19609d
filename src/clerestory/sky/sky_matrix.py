"""From weather to the sky matrix, as Radiance's gendaymtx does it.

The sky is Perez's all-weather sky, scaled so that it sends the diffuse
horizontal irradiance of the weather; the ground below is as bright as its
reflectance makes it under sky and sun.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import numpy as np
from jaxtyping import Float, Float32

from clerestory.constants import GROUND_REFLECTANCE, SKY_COLOUR
from clerestory.errors import InputError
from clerestory.hemisphere.reinhart import SkyPartition, reinhart
from clerestory.sky.direct import SunPlacement, sun_radiance
from clerestory.sky.matrix import SkyMatrix, SkyResponse
from clerestory.sky.perez import PerezSky, perez_sky
from clerestory.sky.sky_state import (
    DEFAULT_DEW_POINT_C,
    sky_state,
    visible_irradiance,
)
from clerestory.sky.sun import SunFormula, SunPosition, day_of_year, sun_position
from clerestory.sky.weather import Weather

__all__ = ["SkyMatrix", "SkyResponse", "sky_matrix"]

Include = Literal["all", "sky", "sun"]
Quadrature = Literal["exact", "centres"]

# Irradiance below which it is night [W/m²], as in gendaymtx
_NIGHT = 1e-4

# Time steps computed together: a block of MF 4 fits in the processor's cache
_BLOCK = 64


def sky_matrix(
    weather: Weather,
    *,
    subdivision: int = 4,
    include: Include = "all",
    sun: SunPlacement = "spread",
    ground_reflectance: float | Sequence[float] = GROUND_REFLECTANCE,
    sky_colour: Sequence[float] = SKY_COLOUR,
    rotation_deg: float = 0.0,
    sun_formula: SunFormula = "spa",
    quadrature: Quadrature | None = None,
    dew_point_c: float | None = None,
) -> SkyMatrix:
    """Return the radiance [W/(m²·sr)] of ground and sky patches at every time step.

    Parameters
    ----------
    weather : irradiance over time
    subdivision : Reinhart's MF, 1 to 6
    include : "all"; "sky" without the direct sun (the ground is still lit by
        it); "sun" alone, without sky and ground
    sun : how the direct sun is put into patches, see `direct.sun_radiance`
    ground_reflectance : one value, or one per channel
    sky_colour : factor of each channel
    rotation_deg : turns sky and sun counter-clockwise, for scenes whose y axis
        points that much east of north
    sun_formula : "spa", or "radiance" for comparisons with gendaymtx
    quadrature : the sky is scaled to the diffuse irradiance by the "exact"
        projected solid angles of its patches, or by their "centres" as in
        gendaymtx, which sends 0.55 % less at MF 1 and 0.04 % at MF 4
    dew_point_c : for all steps; None takes the weather's, or 11 °C

    Returns
    -------
    With `sun_formula="radiance"`, arguments left at None are as in gendaymtx too:
    "centres" and 11 °C.

    Raises
    ------
    InputError : an argument outside its range
    """
    partition = reinhart(subdivision)
    ground = _colour("ground reflectance", ground_reflectance, largest=1.0)
    tint = _colour("sky colour", sky_colour, largest=100.0)
    if include not in ("all", "sky", "sun"):
        raise InputError(
            f"unknown part of the sky {include!r}; 'all', 'sky' or 'sun' expected"
        )
    as_radiance = sun_formula == "radiance"
    quadrature = quadrature or ("centres" if as_radiance else "exact")
    if as_radiance and dew_point_c is None:
        dew_point_c = DEFAULT_DEW_POINT_C

    # Find the sun, in the frame of the scene
    position = sun_position(
        weather.times,
        latitude_deg=weather.latitude_deg,
        longitude_deg=weather.longitude_deg,
        utc_offset_hours=weather.utc_offset_hours,
        elevation=weather.elevation,
        formula=sun_formula,
    )
    position = SunPosition(
        position.altitude, position.azimuth - np.radians(rotation_deg)
    )

    # Turn irradiance into the state of the sky and visible light
    state = sky_state(
        weather.direct_normal,
        weather.diffuse_horizontal,
        altitude=position.altitude,
        day_of_year=day_of_year(weather.times),
    )
    direct, diffuse = visible_irradiance(
        weather.direct_normal,
        weather.diffuse_horizontal,
        state=state,
        dew_point_c=_dew_point(weather, dew_point_c),
    )
    night = weather.direct_normal + weather.diffuse_horizontal <= _NIGHT
    direct[night] = diffuse[night] = 0

    # Fill sky and ground, then the sun
    radiance = np.zeros((len(weather), len(partition)), np.float32)
    if include != "sun":
        lit = np.flatnonzero(~night)
        sky = perez_sky(state, azimuth=position.azimuth)
        _fill_sky(
            radiance,
            sky,
            diffuse,
            steps=lit,
            partition=partition,
            quadrature=quadrature,
        )
        level = direct * np.maximum(np.sin(position.altitude), 0)
        radiance[:, 0] = (diffuse + level) / np.pi
    added = sun_radiance(
        direct if include != "sky" else np.zeros_like(direct),
        position.directions(),
        partition=partition,
        placement=sun,
    )
    return SkyMatrix(
        partition=partition,
        times=weather.times,
        diffuse=radiance.T,
        colour=np.column_stack(
            [ground, np.repeat(tint[:, None], len(partition) - 1, axis=1)]
        ),
        sun=added,
        sun_colour=np.ones(3),
        attributes={
            "place": weather.place,
            "latitude_deg": weather.latitude_deg,
            "longitude_deg": weather.longitude_deg,
            "source": weather.source,
            "include": include,
            "sun": sun,
            "sun_formula": sun_formula,
            "quadrature": quadrature,
            "rotation_deg": rotation_deg,
        },
    )


def _colour(name: str, value: float | Sequence[float], *, largest: float) -> np.ndarray:
    values = np.asarray(value, dtype=float)
    if values.shape not in ((), (3,)):
        raise InputError(
            f"{name} of shape {values.shape}; one number or three expected"
        )
    if not np.all((values >= 0) & (values <= largest)):
        raise InputError(f"{name} {values.tolist()}; 0 to {largest:g} expected")
    return np.broadcast_to(values, 3).copy()


def _dew_point(weather: Weather, fixed: float | None) -> Float[np.ndarray, " time"]:
    if fixed is not None or weather.dew_point_c is None:
        return np.full(len(weather), DEFAULT_DEW_POINT_C if fixed is None else fixed)
    known = np.isfinite(weather.dew_point_c)
    return np.where(known, np.clip(weather.dew_point_c, -60, 35), DEFAULT_DEW_POINT_C)


def _fill_sky(
    radiance: Float32[np.ndarray, "time patch"],
    sky: PerezSky,
    diffuse: Float[np.ndarray, " time"],
    *,
    steps: np.ndarray,
    partition: SkyPartition,
    quadrature: Quadrature,
) -> None:
    # Write the sky of the given steps into `radiance`, in parallel over blocks
    dome = partition.dome
    centres = dome.centres()
    rings = centres[dome.first, 2]
    weight = dome.projected_solid_angles()
    if quadrature == "centres":
        weight = dome.solid_angles() * centres[:, 2]
    towards = np.ascontiguousarray(centres.T, dtype=np.float32)
    weight = weight.astype(np.float32)

    def fill(start: int) -> None:
        at = steps[start : start + _BLOCK]
        part = sky.select(at)
        block = part.indicatrix(part.sun.astype(np.float32) @ towards)
        gradation = part.gradation(rings).astype(np.float32)
        block *= np.repeat(gradation, dome.count, axis=1)
        np.maximum(block, 0, out=block)

        # Scale to the irradiance; a sky that the model leaves dark is uniform
        total = block @ weight
        dark = ~(total > 1e-30)
        block[dark] = 1
        total[dark] = weight.sum()
        block *= (diffuse[at] / total).astype(np.float32)[:, None]
        radiance[at, 1:] = block

    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 8)) as pool:
        list(pool.map(fill, range(0, len(steps), _BLOCK)))
