"""Spectral sky and sun as a few parts, each a distribution times a colour.

Daylight is a sum of three spectra (CIE 15), of which the colour temperature sets the
shares; sunlight over a year is, to a chosen accuracy, a sum of a few spectra too. The
first spectrum of each has all of the luminance, the others have none. So matrix
products take a few times as long as for a sky of one colour, for any number of bands.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Float32
from scipy.sparse import csc_array

from clerestory.array_types import Series
from clerestory.bands import Bands
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.sky.daylight_spectra import (
    DaylightSpectra,
    sky_colour_temperature,
    sun_spectra,
)
from clerestory.sky.patch_radiance import ChromaticPart, SkyMatrix
from clerestory.sky.sky_conditions import SkyConditions
from clerestory.sky.weather import Weather
from clerestory.spectral.band_sets import light_in_bands
from clerestory.spectral.colour_temperature import DAYLIGHT_K, daylight_components
from clerestory.spectral.functions import (
    MAXIMUM_EFFICACY,
    integral,
    spectral_function,
)
from clerestory.spectral.light_colours import light_colour

# Number of time steps that are computed at once
_STEPS = 512

# Number of entries in the table of daylight by reciprocal colour temperature
_ENTRIES = 1 << 18

# Largest deviation of the sun's colour from the sum of its parts, relative to white
# light, times the square root of the irradiance relative to that of the brightest sun
_TOLERANCE = 3e-3


@dataclass(frozen=True, eq=False)
class LightColours:
    """Colour of light at each time step as a sum of a few colours.

    The factor on the radiance of white light is main[b] + Σ share[t] · colour[b].

    Attributes
    ----------
    main : colour with the luminance of white
    colours : colours without luminance
    shares : shares of these colours at each time step
    """

    main: Float[np.ndarray, " band"]
    colours: Float[np.ndarray, "part band"]
    shares: Float[np.ndarray, "part time"]

    def values(self) -> Float[np.ndarray, "band time"]:
        """Factor on the radiance of white light, in each band."""
        return np.asarray(self.main[:, None] + self.colours.T @ self.shares)


def sun_colours(
    weather: Weather, conditions: SkyConditions, model: DaylightSpectra, bands: Bands
) -> LightColours:
    """Return the colour of the sun at each time step."""
    spectra = sun_spectra(weather, conditions, model)
    return _sum_of_few(light_colour(spectra.T, bands), conditions.direct_normal)


def _sum_of_few(light: Float[np.ndarray, "band time"], power: Series) -> LightColours:
    # Colours of light, of luminance 1, as a sum of few; weak light may deviate more
    main = light @ power / power.sum() if power.any() else light.mean(axis=1)

    weight = np.sqrt(power / max(power.max(), np.finfo(float).tiny))
    rest = (light - main[:, None]) * weight
    left, size, right = np.linalg.svd(rest, full_matrices=False)
    count, most = 0, _TOLERANCE * main.max()
    while np.abs(rest - (left[:, :count] * size[:count]) @ right[:count]).max() > most:
        count += 1
    shares = np.divide(
        size[:count, None] * right[:count],
        weight,
        out=np.zeros((count, len(power))),
        where=weight > 0,
    )
    return LightColours(main, left[:, :count].T, shares)


def with_spectra(
    sky: SkyMatrix,
    conditions: SkyConditions,
    model: DaylightSpectra,
    sun: LightColours,
) -> SkyMatrix:
    """Return a white sky with the spectra of daylight, and a sun of given colours."""
    if model.measured_sky is not None:
        spectra = model.measured_sky.at(sky.times, conditions.lit)
        return _with_one_colour(sky, conditions, model, spectra, sun)
    main, *others = _daylight_colours(sky.bands)
    colours, shares_of_components = _independent(np.array(others))
    ground = _ground(sky)
    diffuse = _chromatic_radiance(
        sky, conditions, model, colours, shares_of_components, main=main, sun=sun
    )
    white = np.broadcast_to(np.float32(0), sky.diffuse.shape)
    dark = np.zeros(len(sky.bands)), np.zeros(len(sky.times))
    parts = []
    for number in range(max(len(colours), len(sun.colours))):
        in_sky, in_sun = number < len(colours), number < len(sun.colours)
        tint, shares = (sun.colours[number], sun.shares[number]) if in_sun else dark
        colour = colours[number] if in_sky else dark[0]
        parts.append(
            ChromaticPart(
                diffuse[number] if in_sky else white,
                ground * colour[:, None],
                scaled_steps(sky.sun, shares),
                tint,
            )
        )
    return replace(
        sky,
        colour=ground * main[:, None],
        sun_colour=sun.main,
        chromatic=tuple(parts),
        attributes={**sky.attributes, **model.attributes()},
    )


def _with_one_colour(
    sky: SkyMatrix,
    conditions: SkyConditions,
    model: DaylightSpectra,
    spectra: Float[np.ndarray, "time wavelength"],
    sun: LightColours,
) -> SkyMatrix:
    # Sky of one measured spectrum at each time step; the ground reflects it and the sun
    light = light_colour(spectra.T, sky.bands)
    power = np.append(conditions.diffuse_horizontal, conditions.direct_normal)
    both = _sum_of_few(np.append(light, sun.values(), axis=1), power)
    of_sky, of_sun = np.split(both.shares, 2, axis=1)
    direct = conditions.direct_horizontal()
    level = np.maximum(direct + conditions.diffuse_horizontal, np.finfo(float).tiny)
    share = direct / level
    ground, parts = _ground(sky), []
    for colour, own, suns in zip(both.colours, of_sky, of_sun, strict=True):
        diffuse = sky.diffuse * own.astype(np.float32)
        diffuse[0] = sky.diffuse[0] * ((1 - share) * own + share * suns)
        tinted = ground * colour[:, None]
        parts.append(
            ChromaticPart(diffuse, tinted, scaled_steps(sky.sun, suns), colour)
        )
    return replace(
        sky,
        colour=ground * both.main[:, None],
        sun_colour=both.main,
        chromatic=tuple(parts),
        attributes={**sky.attributes, **model.attributes()},
    )


def _independent(
    colours: Float[np.ndarray, "component band"],
) -> tuple[Float[np.ndarray, "part band"], Float[np.ndarray, "part component"]]:
    # As many colours as the bands distinguish, and the shares of the given ones in
    # them: without luminance, two bands have one colour
    left, size, right = np.linalg.svd(colours, full_matrices=False)
    count = max(1, int((size > 1e-9 * size[0]).sum()))
    return right[:count], (left[:, :count] * size[:count]).T


def _ground(sky: SkyMatrix) -> Float[np.ndarray, "band patch"]:
    # Reflectance of the ground in each band, and 1 for the patches of the sky
    found = np.ones(sky.colour.shape)
    found[:, 0] = sky.colour[:, 0]
    return found


def scaled_steps(matrix: csc_array, factor: Series) -> csc_array:
    """Return a sparse matrix with its columns, the time steps, scaled."""
    scaled = matrix.copy()
    scaled.data = matrix.data * np.repeat(factor, np.diff(matrix.indptr))
    return scaled.astype(matrix.dtype)


def _chromatic_radiance(
    sky: SkyMatrix,
    conditions: SkyConditions,
    model: DaylightSpectra,
    colours: Float[np.ndarray, "part band"],
    shares_of_components: Float[np.ndarray, "part component"],
    *,
    main: Float[np.ndarray, " band"],
    sun: LightColours,
) -> list[Float32[np.ndarray, "patch time"]]:
    # Radiance of sky and ground in the colours of daylight without luminance
    found = [np.zeros_like(sky.diffuse) for _ in colours]
    lumen = MAXIMUM_EFFICACY * integral(_component(0) * spectral_function("y"))
    least, most = (1e6 / kelvin for kelvin in reversed(DAYLIGHT_K))
    known = daylight_components(1e6 / np.linspace(least, most, _ENTRIES))[1:]
    table = (shares_of_components @ (lumen * known)).astype(np.float32)
    per_mired = (_ENTRIES - 1) / (most - least)
    area = sky.partition.dome.projected_solid_angles()
    rest = sun.values() - main[:, None]
    of_sun = np.linalg.lstsq(colours.T, rest, rcond=None)[0]
    direct = conditions.direct_horizontal()
    level = direct + conditions.diffuse_horizontal
    lit = np.flatnonzero(sky.diffuse.any(axis=0))
    for start in range(0, len(lit), _STEPS):
        steps = lit[start : start + _STEPS]
        dome = sky.diffuse[1:, steps].astype(float)
        kelvin = sky_colour_temperature(
            LUMINOUS_EFFICACY * dome, conditions.state.clearness[steps], model.sky
        )
        place = ((1e6 / kelvin - least) * per_mired + 0.5).astype(np.int32)
        whole = np.maximum(area @ dome, np.finfo(np.float32).tiny)
        share = direct[steps] / level[steps]
        for part, values, own in zip(found, table, of_sun[:, steps], strict=True):
            radiance = dome * values[place]
            part[1:, steps] = radiance
            mean = (area @ radiance) / whole
            part[0, steps] = sky.diffuse[0, steps] * (mean * (1 - share) + own * share)
    return found


def _daylight_colours(bands: Bands) -> list[Float[np.ndarray, " band"]]:
    # Colours of S0, with the luminance of white, and of S1 and S2 without luminance
    lumen = MAXIMUM_EFFICACY * integral(_component(0) * spectral_function("y"))
    main = light_colour(_component(0), bands)
    others = [_colour(_component(k) / lumen, bands) for k in (1, 2)]
    if bands.efficacy is None:
        return [main, *others]
    weights = bands.weights
    return [main, *(c - main * (weights @ c) / LUMINOUS_EFFICACY for c in others)]


def _component(number: int) -> Float[np.ndarray, " wavelength"]:
    return spectral_function(f"s{number}")


def _colour(
    per_lumen: Float[np.ndarray, " wavelength *batch"], bands: Bands
) -> Float[np.ndarray, " band *batch"]:
    # Factor on white light of the same luminance, from spectral power per lumen
    return light_in_bands(LUMINOUS_EFFICACY * per_lumen, bands)
