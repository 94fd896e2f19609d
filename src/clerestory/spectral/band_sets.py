"""Sets of spectral bands: wavelength intervals, or weighting functions of the eye.

A band is a wavelength interval, in which a material has the mean of its spectrum, or a
weighting function, such as the melanopic action spectrum: there a material has the mean
weighted by the function and by illuminant D65. Intervals are accurate for any light if
they are narrow. Weighting functions give one quantity with one band, exactly for
light of D65 after one reflection or transmission.

A radiance of 1 W/(m²·sr) in every band is equal-energy white light of 179 cd/m².
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB, Bands
from clerestory.checks import one_of, require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.spectra import Spectrum, interpolation_matrix
from clerestory.spectral.functions import (
    MAXIMUM_EFFICACY,
    STEP_NM,
    WAVELENGTH_NM,
    integral,
    spectral_function,
)

# Weighting functions of bands, by name, with the names of their tables
WEIGHTINGS = {
    "photopic": "y",
    "melanopic": "melanopic",
    "rhodopic": "rhodopic",
    "s_cone": "s_cone",
    "m_cone": "m_cone",
    "l_cone": "l_cone",
}

# Spectral radiance of equal-energy white light of 179 cd/m² [W/(m²·sr·nm)]
WHITE = LUMINOUS_EFFICACY / (MAXIMUM_EFFICACY * float(integral(spectral_function("y"))))

# Centres of the finest set of bands [nm]
_FINEST_NM = np.arange(380.0, 785.0, 5.0)


def band_set(name: str) -> Bands:
    """Return a set of bands by name.

    Parameters
    ----------
    name : "RGB"; weighting functions joined by "+", such as "photopic" or
        "melanopic+photopic"; or the number of equal wavelength intervals, 2 to 81, from
        380 to 780 nm. "81" are intervals of 5 nm around 380, 385, …, 780 nm.

    Raises
    ------
    InputError : the name is not one of these

    Examples
    --------
    >>> print(band_set("melanopic+photopic"), "|", band_set("20").names[0])
    melanopic, photopic | 380-400 nm
    """
    word = name.strip().lower()
    if word == "rgb":
        return RGB
    if word.isdecimal() and len(word) <= 3:
        return _intervals(int(word))
    names = tuple(part.strip() for part in word.split("+"))
    if not set(names) <= set(WEIGHTINGS):
        raise InputError(
            f'the set of bands is "{name}"; "RGB", a number of wavelength intervals'
            f" from 2 to {len(_FINEST_NM)}, or {', '.join(WEIGHTINGS)} joined by +"
            " expected"
        )
    efficacy = tuple(LUMINOUS_EFFICACY * (name == "photopic") for name in names)
    known = efficacy if "photopic" in names else None
    return Bands(names, known, weightings=names)


def _intervals(count: int) -> Bands:
    require(
        2 <= count <= len(_FINEST_NM),
        f"{count} wavelength intervals; 2 to {len(_FINEST_NM)} expected",
    )
    if count == len(_FINEST_NM):
        return wavelength_bands(np.append(_FINEST_NM, 785.0) - 2.5)
    return wavelength_bands(np.linspace(380.0, 780.0, count + 1))


def wavelength_bands(limits_nm: Sequence[float] | np.ndarray) -> Bands:
    """Return adjacent bands with the given limits [nm].

    The luminous efficacy of a band is 179 lm/W times the fraction of ∫ V(λ) dλ within
    the band, so the efficacies of bands over the visible range add up to 179 lm/W.

    >>> nine = wavelength_bands(range(380, 830, 45))
    >>> nine.names[2], round(float(nine.weights.sum()), 6)
    ('470-515 nm', 179.0)
    """
    limits = np.asarray(limits_nm, dtype=float)
    require(
        limits.ndim == 1 and len(limits) > 1 and np.all(np.diff(limits) > 0),
        f"limits are {limits.tolist()} nm; two or more increasing numbers expected",
    )
    pairs = tuple(pairwise(limits.tolist()))
    area = _antiderivative(WAVELENGTH_NM, spectral_function("y"), limits, beyond=0.0)
    efficacy = MAXIMUM_EFFICACY * WHITE * np.diff(area)
    names = tuple(f"{low:g}-{high:g} nm" for low, high in pairs)
    return Bands(names, tuple(efficacy.tolist()), pairs)


def band_means(spectrum: Spectrum, bands: Bands) -> Float[np.ndarray, " band"]:
    """Mean of a spectrum in each band, such as the reflectance of a paint.

    The spectrum is interpolated linearly and constant beyond both ends.

    Raises
    ------
    InputError : the bands have neither wavelengths nor weighting functions, as RGB

    Examples
    --------
    >>> ramp = Spectrum(np.array([400.0, 700.0]), np.array([0.4, 0.7]))
    >>> band_means(ramp, wavelength_bands([500, 520, 600])).round(3).tolist()
    [0.51, 0.56]
    """
    return np.asarray(mean_weights(spectrum.wavelength_nm, bands) @ spectrum.value)


def mean_weights(
    wavelength_nm: Float[np.ndarray, " wavelength"], bands: Bands
) -> Float[np.ndarray, "band wavelength"]:
    """Weights of values at given wavelengths [nm] in the mean of each band; sum 1.

    The weights times the values of a spectrum are its `band_means`.

    Raises
    ------
    InputError : the bands have neither wavelengths nor weighting functions, as RGB

    Examples
    --------
    >>> mean_weights(np.array([400.0, 500.0]), wavelength_bands([400, 450])).tolist()
    [[0.75, 0.25]]
    """
    if bands.limits_nm is not None:
        limits = np.array(bands.limits_nm)
        area = _antiderivative(wavelength_nm, np.eye(len(wavelength_nm)), limits)
        return np.asarray(np.diff(area, axis=1)[:, 0] / np.diff(limits, axis=1))
    inside = (wavelength_nm > 380) & (wavelength_nm < 780)
    fine = np.union1d(WAVELENGTH_NM, wavelength_nm[inside])
    step = np.diff(fine)
    half = (np.append(step, 0) + np.insert(step, 0, 0)) / 2
    daylight = half * _at(fine, "d65")
    weights = [_at(fine, WEIGHTINGS[name]) * daylight for name in _weightings(bands)]
    shares = np.array([one / one.sum() for one in weights])
    return np.asarray(shares @ interpolation_matrix(wavelength_nm, fine))


def light_in_bands(
    power: Float[np.ndarray, " wavelength *batch"], bands: Bands
) -> Float[np.ndarray, " band *batch"]:
    """Radiance in each band of light with a spectrum at `WAVELENGTH_NM`.

    Parameters
    ----------
    power : spectral radiance [W/(m²·sr·nm)] or irradiance [W/(m²·nm)]

    Returns
    -------
    Radiance [W/(m²·sr)] or irradiance [W/m²] in the bands, 1 for equal-energy white of
    179 cd/m² or 179 lux. In a wavelength interval it is a mean; in a band with a
    weighting function it is exact for the quantity of the function.

    Examples
    --------
    >>> white = np.full(401, WHITE)
    >>> light_in_bands(white, band_set("melanopic+photopic")).round(9).tolist()
    [1.0, 1.0]
    """
    if bands.limits_nm is not None:
        weights = mean_weights(WAVELENGTH_NM, bands)
    else:
        tables = [spectral_function(WEIGHTINGS[name]) for name in _weightings(bands)]
        weights = np.array([one * STEP_NM / integral(one) for one in tables])
    return np.tensordot(weights, power, axes=1) / WHITE


def efficacy(bands: Bands, quantity: str) -> Float[np.ndarray, " band"]:
    """Weighted radiance per radiance in each band, without unit, for a quantity.

    The sum over the bands of radiance times this efficacy is ∫ L(λ) s(λ) dλ with the
    weighting function s. For the quantity "photopic" it is luminance over 683 lm/W.

    Parameters
    ----------
    quantity : name of a weighting function, see `WEIGHTINGS`

    Raises
    ------
    InputError : unknown quantity, or bands from which it cannot be computed

    Examples
    --------
    >>> round(float(683 * efficacy(band_set("20"), "photopic").sum()), 6)
    179.0
    """
    one_of(quantity, "the quantity", choices=WEIGHTINGS)
    values = spectral_function(WEIGHTINGS[quantity])
    if bands.limits_nm is not None:
        return WHITE * interval_integrals(values, bands)
    names = _weightings(bands)
    require(
        quantity in names,
        f"the bands are {bands}, which do not give {quantity} light; a band of that"
        " name, or wavelength intervals, expected",
    )
    chosen = np.array([name == quantity for name in names])
    return np.asarray(WHITE * integral(values) * chosen)


def gives(bands: Bands, quantity: str) -> bool:
    """Whether light in these bands gives a quantity, such as "melanopic".

    >>> gives(RGB, "melanopic"), gives(band_set("9"), "melanopic")
    (False, True)
    """
    return bands.limits_nm is not None or quantity in (bands.weightings or ())


def interval_integrals(
    values: Float[np.ndarray, " wavelength"], bands: Bands
) -> Float[np.ndarray, " band"]:
    """Integral over each wavelength interval of a function at `WAVELENGTH_NM`.

    The function is zero beyond its wavelengths.

    Raises
    ------
    InputError : the bands are not wavelength intervals
    """
    if bands.limits_nm is None:
        raise InputError(
            f"the bands {bands} have no wavelengths; wavelength intervals expected"
        )
    limits = np.array(bands.limits_nm)
    area = _antiderivative(WAVELENGTH_NM, values, limits, beyond=0.0)
    return np.asarray(np.diff(area, axis=1)[:, 0])


def _weightings(bands: Bands) -> tuple[str, ...]:
    if bands.weightings is None:
        raise InputError(
            f"the bands {bands} have no wavelengths; wavelength intervals, or weighting"
            " functions such as melanopic+photopic, expected"
        )
    for name in bands.weightings:
        one_of(name, "a weighting function", choices=WEIGHTINGS)
    return bands.weightings


def _at(wavelength_nm: np.ndarray, name: str) -> np.ndarray:
    return np.asarray(np.interp(wavelength_nm, WAVELENGTH_NM, spectral_function(name)))


def _antiderivative(
    known_nm: Float[np.ndarray, " known"],
    values: Float[np.ndarray, " known *batch"],
    at_nm: Float[np.ndarray, "*shape"],
    *,
    beyond: float | None = None,
) -> np.ndarray:
    # Integral of the linear interpolation, from the first wavelength to others, over
    # (*shape, *batch); beyond both ends the function has its last value, or `beyond`
    batch = (1,) * (values.ndim - 1)

    def column(numbers: np.ndarray) -> np.ndarray:
        return numbers.reshape(*numbers.shape, *batch)

    step = column(np.diff(known_nm))
    parts = step * (values[1:] + values[:-1]) / 2
    whole = np.concatenate([np.zeros_like(values[:1]), np.cumsum(parts, axis=0)])
    inside = np.clip(at_nm, known_nm[0], known_nm[-1])
    last = len(known_nm) - 1
    start = np.clip(np.searchsorted(known_nm, inside, "right") - 1, 0, last)
    after = np.minimum(start + 1, last)
    way = inside - known_nm[start]
    share = column(way / np.where(after > start, known_nm[after] - known_nm[start], 1))
    end = values[start] + share * (values[after] - values[start])
    area = whole[start] + (values[start] + end) / 2 * column(way)
    low, high = (values[0], values[-1]) if beyond is None else (beyond, beyond)
    area += column(np.minimum(at_nm - known_nm[0], 0)) * low
    return np.asarray(area + column(np.maximum(at_nm - known_nm[-1], 0)) * high)
