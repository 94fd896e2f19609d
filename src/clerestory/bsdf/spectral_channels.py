"""Spectral channels of BSDFs, and BSDFs in given spectral bands.

A channel named "550 nm" has the BSDF at a wavelength, "540-560 nm" the mean over a
wavelength interval, and "melanopic" the mean weighted by a weighting function and by
D65. Between wavelengths, BSDFs are interpolated linearly.
"""

import re
import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Values
from clerestory.bands import RGB, Bands
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import (
    FUNCTIONS,
    OF_SIDE,
    Function,
    ScatteringFunction,
)
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import combine
from clerestory.checks import not_negative, require
from clerestory.colorimetry import RADIANCE
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.klems import klems
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import (
    WEIGHTINGS,
    band_means,
    band_set,
    mean_weights,
)

# Names of channels: a wavelength, or a wavelength interval
_NAME = re.compile(r"(\d+(?:\.\d+)?)(?:-(\d+(?:\.\d+)?))? nm")

# Distance of the limits of intervals from those of adjacent intervals [nm]
_APART = 1e-6

# Transmittance plus reflectance above which a warning is given
_MOST_SCATTERED = 1.01


def spectral_limits(bsdf: Bsdf) -> dict[str, tuple[float, float]]:
    """Shortest and longest wavelength [nm] of each spectral channel, in rising order.

    Both are equal for channels at a wavelength.

    >>> from clerestory.bsdf.analytic import lambertian
    >>> spectral_limits(lambertian(0.5, klems("quarter")))
    {}
    """
    found = {}
    for name in bsdf.channels:
        if match := _NAME.fullmatch(name):
            low, high = match.groups()
            found[name] = float(low), float(high or low)
    return dict(sorted(found.items(), key=lambda item: item[1]))


def bsdf_in_bands(bsdf: Bsdf, bands: Bands) -> Bsdf:
    """Return a BSDF with a channel for each band, from its spectral channels.

    A BSDF that has these channels, or no spectral channels, is returned unchanged:
    without spectral channels its visible channel applies to all bands.

    Raises
    ------
    InputError : the bands have neither wavelengths nor weighting functions; or the
        channels overlap

    Examples
    --------
    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.spectral.band_sets import wavelength_bands
    >>> blue, red = (lambertian(t, klems("quarter")) for t in (0.4, 0.2))
    >>> parts = {"450 nm": blue, "650 nm": red}
    >>> both = Bsdf({(c, f): part.function(f) for c, part in parts.items()
    ...              for f in FUNCTIONS})
    >>> green = bsdf_in_bands(both, wavelength_bands([500, 600]))
    >>> round(green.diffuse("transmission_front", channel="500-600 nm"), 6)
    0.3
    """
    known = spectral_limits(bsdf)
    if bands == RGB or not known or has_bands(bsdf, bands):
        return bsdf
    nodes, at = spectral_nodes(bsdf)
    of_nodes = mean_weights(nodes, bands)
    weights = np.stack([of_nodes[:, at == k].sum(axis=1) for k in range(len(known))], 1)
    functions = dict(bsdf.functions)
    for name in FUNCTIONS:
        parts = [bsdf.functions.get((channel, name)) for channel in known]
        given = [part for part in parts if part is not None]
        if not given:
            continue
        require(
            len(given) == len(parts),
            f"BSDF {bsdf.product.name!r} has {name.replace('_', ' ')} at"
            f" {len(given)} of {len(parts)} wavelengths; data at each expected",
            file=bsdf.source,
        )
        for band, row in zip(bands.names, weights, strict=True):
            functions[band, name] = weighted_function(given, row)
    return replace(bsdf, functions=functions)


def spectral_nodes(
    bsdf: Bsdf,
) -> tuple[Float[np.ndarray, " node"], Int[np.ndarray, " node"]]:
    """Wavelengths [nm] between which the BSDF is linear, and the channel at each.

    Channels are numbered as in `spectral_limits`. An interval, in which the BSDF is
    constant, has two wavelengths.

    Raises
    ------
    InputError : wavelengths and intervals are mixed, or intervals overlap
    """
    known = spectral_limits(bsdf)
    limits = np.array(list(known.values())).reshape(-1, 2)
    if np.all(limits[:, 0] == limits[:, 1]):
        return limits[:, 0], np.arange(len(known))
    nodes = (limits + np.array([_APART, -_APART])).ravel()
    require(
        np.all(np.diff(nodes) > 0),
        f"the spectral channels are {', '.join(known)[:80]}; wavelengths, or intervals"
        " that do not overlap, expected",
        file=bsdf.source,
    )
    return nodes, np.repeat(np.arange(len(known)), 2)


def weighted_function(
    parts: Sequence[ScatteringFunction], weights: Values
) -> ScatteringFunction:
    """Weighted sum of scattering functions of one kind and partition.

    Negative sums become zero.

    Raises
    ------
    InputError : matrices and trees, or several partitions or ranks, are mixed
    """
    used = [(p, float(w)) for p, w in zip(parts, weights, strict=True) if w]
    used = used or [(parts[0], 0.0)]
    first = used[0][0].tabulated()
    shares = np.array([weight for _, weight in used])
    tables = [part.tabulated() for part, _ in used]
    if isinstance(first, ScatteringTree):
        trees = [one for one in tables if isinstance(one, ScatteringTree)]
        if len(trees) == len(tables) and {one.rank for one in trees} == {first.rank}:
            return combine(
                lambda *values: np.maximum(np.tensordot(shares, values, 1), 0), *trees
            )
    elif isinstance(first, ScatteringMatrix):
        values = [
            one.values
            for one in tables
            if isinstance(one, ScatteringMatrix)
            and one.exits.matches(first.exits)
            and one.incidents.matches(first.incidents)
        ]
        if len(values) == len(tables):
            total = np.maximum(np.tensordot(shares, values, axes=1), 0)
            return ScatteringMatrix(total, first.exits, first.incidents)
    raise InputError(
        "the spectral channels of a BSDF have different partitions; equal partitions"
        " or trees of equal rank expected"
    )


def with_spectral_transmittance(bsdf: Bsdf, spectrum: Spectrum, bands: Bands) -> Bsdf:
    """Return a BSDF of one visible channel with transmission of a given colour.

    An approximation: in each band, the visible transmission is multiplied by the
    spectral transmittance at normal incidence over its photopic mean, for all
    directions. Reflection is equal in all bands.

    Parameters
    ----------
    spectrum : transmittance at normal incidence, of which only the shape counts

    Raises
    ------
    InputError : the BSDF has spectral channels, or the spectrum is dark

    Warns
    -----
    ClerestoryWarning : more flux is scattered than incident

    Examples
    --------
    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.spectral.band_sets import band_set
    >>> blue = Spectrum(np.array([400.0, 700.0]), np.array([0.5, 0.2]))
    >>> grey = lambertian(0.3, klems("quarter"))
    >>> tinted = with_spectral_transmittance(grey, blue, band_set("melanopic+photopic"))
    >>> round(tinted.diffuse("transmission_front", channel="melanopic"), 3)
    0.359
    """
    require(
        not spectral_limits(bsdf),
        f"BSDF {bsdf.product.name!r} has spectral channels; one without, or no"
        " spectrum, expected",
        file=bsdf.source,
    )
    not_negative(spectrum.value, "a spectral transmittance")
    photopic = float(band_means(spectrum, band_set("photopic"))[0])
    require(photopic > 0, "the spectral transmittance is zero; more expected")
    ratios = band_means(spectrum, bands) / photopic
    functions = dict(bsdf.functions)
    for name in FUNCTIONS:
        if ("visible", name) in functions:
            passed = name.startswith("transmission")
            for band, ratio in zip(bands.names, ratios, strict=True):
                scale = np.array([ratio if passed else 1.0])
                part = functions["visible", name]
                functions[band, name] = weighted_function([part], scale)
    coloured = replace(bsdf, functions=functions)
    _warn_of_energy(coloured, bands.names[int(np.argmax(ratios))])
    return coloured


def _warn_of_energy(bsdf: Bsdf, channel: str) -> None:
    # Flux that leaves both sides, for light on either side
    centres = klems("quarter").centres()
    incident = {side: centres * sign for side, sign in _TOWARDS.items()}
    most = 0.0
    for side, names in OF_SIDE.items():
        parts = [
            bsdf.hemispherical(incident[side], function=name, channel=channel)
            for name in names
            if bsdf.has(name, channel=channel)
        ]
        most = max(most, float(np.max(np.sum(parts, axis=0))) if parts else 0.0)
    if most > _MOST_SCATTERED:
        what = bsdf.source or f"BSDF {bsdf.product.name!r}"
        warnings.warn(
            f"{what}: with its spectral transmittance it scatters {most:.3f} times the"
            f" incident flux in the band {channel}; at most 1 expected",
            ClerestoryWarning,
            stacklevel=3,
        )


# Signs of the directions towards the source of light on each side
_TOWARDS = {"front": (-1, -1, -1), "back": (-1, -1, 1)}


def is_spectral(bsdf: Bsdf) -> bool:
    """Whether a BSDF has channels at wavelengths, of intervals or weighting functions.

    >>> from clerestory.bsdf.analytic import lambertian
    >>> is_spectral(lambertian(0.5, klems("quarter")))
    False
    """
    return bool(spectral_limits(bsdf)) or not WEIGHTINGS.keys().isdisjoint(
        bsdf.channels
    )


def has_bands(bsdf: Bsdf, bands: Bands) -> bool:
    """Whether a BSDF has a channel for each of some bands other than RGB."""
    return bands != RGB and set(bands.names) <= set(bsdf.channels)


def band_groups_of(bsdf: Bsdf, bands: Bands) -> tuple[Bsdf, ...]:
    """Return BSDFs in colour, each of which has three bands as red, green and blue.

    The last one repeats the last band if fewer than three remain. A BSDF without
    channels for the bands is the only one.

    Examples
    --------
    >>> from clerestory.bsdf.analytic import lambertian
    >>> len(band_groups_of(lambertian(0.5, klems("quarter")), band_set("20")))
    1
    """
    if not has_bands(bsdf, bands):
        return (bsdf,)
    groups = []
    for first in range(0, len(bands), len(RGB)):
        chosen = [*bands.names[first:], bands.names[-1], bands.names[-1]][: len(RGB)]
        groups.append(_as_rgb(bsdf, chosen))
    return tuple(groups)


def _as_rgb(bsdf: Bsdf, names: Sequence[str]) -> Bsdf:
    # BSDF whose tristimulus values, as in files with colour, are those of three bands
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for name in FUNCTIONS:
        if (names[0], name) in bsdf.functions:
            parts = [bsdf.functions[channel, name] for channel in names]
            for channel, row in zip(_XYZ, RADIANCE.to_xyz(), strict=True):
                functions[channel, name] = weighted_function(parts, row)
    return replace(bsdf, functions=functions)


_XYZ = ("cie-x", "visible", "cie-z")
