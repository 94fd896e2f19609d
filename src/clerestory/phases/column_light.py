"""Radiance and irradiance by which the matrices V, C and C_ds are multiplied.

    exiting radiance  X(t) = T(t) D S(t), of the patches of all windows
    sky radiance      of the sky patches: a grey distribution times a colour
    sun irradiance    direct normal, of at most one sun per time step

The result is illuminance (a weighted sum of the bands) for sensors, and the radiance in
each band for pictures. Radiance is weighted before multiplication by a matrix, so that
grey rooms need one product instead of one per band.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import MatrixChain
from clerestory.phases.receivers import chain_components, channel_count, side_by_side
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sky_product import fold
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.threads import computed_in_threads

# Distance of the receivers by which columns of a matrix that are not zero are found
_SOME = 32

# Weights of the bands in the result: photometric weights, or one row per band
Weights = Float[np.ndarray, "out band"]
Layers = Float32[np.ndarray, "layer channel row column"]
Received = Float32[np.ndarray, "layer out row step"]

# Function that returns D S of a matrix D in some time steps: kept, or made
Arriving = Callable[
    [
        TransferMatrix,
        Int[np.ndarray, " step"],
        Float[np.ndarray, "channel band"],
        Callable[[], Received],
    ],
    Received,
]


@dataclass(frozen=True, eq=False)
class PatchLight:
    """Exiting radiance of the patches of all windows.

    Attributes
    ----------
    values : exiting radiance, multiplied by the band weights if `summed`
    components : error components of the radiance, for each window by itself
    summed : whether products are summed over the channels, as for illuminance
    """

    values: Float32[np.ndarray, "channel patch step"]
    components: tuple[Float32[np.ndarray, "component channel own step"], ...]
    summed: bool

    def received(self, matrix: Layers) -> Received:
        """Multiply a matrix and its error components by the radiance."""
        values = self.values
        # Receivers of one room, with windows of all rooms; mostly some suffice to tell
        if _seen(matrix[:, :, ::_SOME]).mean() < 0.5:
            seen = _seen(matrix)
            if seen.mean() < 0.5:
                matrix, values = matrix[..., seen], values[:, seen]
        if not self.summed:
            return np.asarray(matrix @ values)
        wide, light = _folded(matrix, values)
        return np.asarray(wide @ light)[:, None]

    def spread(
        self, values: Float32[np.ndarray, "channel row column"]
    ) -> list[Received]:
        """Multiply a matrix by the error components of the radiance of each window.

        Windows that no receiver sees have no components.
        """
        found, first = [], 0
        for parts in self.components:
            last = first + parts.shape[2]
            seen, first = values[..., first:last], last
            errors = parts if seen.any() else parts[:0]
            if len(parts) and not self.summed:
                found.append(np.asarray(seen @ errors))
            elif len(parts):
                wide, light = _folded(seen[None], errors)
                found.append((wide @ light)[:, None])
        return found


def _seen(matrix: Layers) -> Bool[np.ndarray, " column"]:
    return np.asarray(matrix.any(axis=(0, 1, 2)))


def _folded(matrix: Layers, light: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    # Factors whose product is summed over the channels: (…, row, channel × patch) and
    # (…, channel × patch, step). The light is summed first if the matrix is grey
    layers, channels, rows, columns = matrix.shape
    if channels == 1:
        one = light.shape[-3] == 1
        return matrix[:, 0], light[..., 0, :, :] if one else light.sum(axis=-3)
    wide = np.moveaxis(matrix, 1, 2).reshape(layers, rows, channels * columns)
    light = np.broadcast_to(light, (*light.shape[:-3], channels, *light.shape[-2:]))
    return wide, light.reshape(*light.shape[:-3], channels * columns, light.shape[-1])


@dataclass(frozen=True, eq=False)
class SkyLight:
    """Radiance of the sky patches, in time steps with daylight."""

    sky: SkyMatrix
    weights: Weights

    def received(self, matrix: Layers) -> Received:
        """Multiply a matrix and its error components by the radiance."""
        layers, channels, rows, patches = matrix.shape
        shape = layers, rows, len(self.sky.times)
        if channels == 1 and self._weighted:
            flat = matrix.reshape(-1, patches)
            products = ((flat @ sky).reshape(shape) for sky in self._weighted)
        else:
            multiply = partial(sky_product, matrix, self.sky)
            products = (multiply(w).reshape(shape) for w in self.weights)
        if len(self.weights) == 1:
            return np.asarray(next(products)[:, None])
        found = np.empty((layers, len(self.weights), *shape[1:]), np.float32)
        for channel, product in enumerate(products):
            found[:, channel] = product
        return found

    @cached_property
    def _weighted(self) -> list[Float32[np.ndarray, "patch step"]]:
        # Radiance of sky and sun, summed over bands: what grey matrices multiply.
        # Nothing for the sun alone, which is sparse
        if not any(one.diffuse.any() for one in self.sky.parts):
            return []
        return [_weighted(self.sky, weights) for weights in self.weights]


@dataclass(frozen=True, eq=False)
class SunLight:
    """Direct normal irradiance [W/m²] of the suns, one for each column of a matrix."""

    suns: SunMatrix
    weights: Weights

    def received(self, matrix: Layers) -> Received:
        """Multiply a matrix and its error components by the irradiance."""
        layers, channels, rows, suns = matrix.shape
        found: np.ndarray | float = 0.0
        for normal, weights in self.suns.weighted(self.weights):
            each = weights.sum(axis=1, keepdims=True) if channels == 1 else weights
            light = np.einsum("oc,lcrs->sorl", each.astype(np.float32), matrix)
            flat = light.reshape(suns, len(each) * rows * layers)
            found = found + normal.astype(np.float32).T @ flat
        shape = len(self.suns.times), len(self.weights), rows, layers
        return np.ascontiguousarray(np.reshape(found, shape).T.swapaxes(1, 2))


Light = PatchLight | SkyLight | SunLight


def add_signed(
    sign: int, total: np.ndarray, values: np.ndarray, steps: Int[np.ndarray, " step"]
) -> None:
    """Add values of given sign to a total, in some of its time steps."""
    change = np.add if sign > 0 else np.subtract
    for some, own in runs(steps):
        part = total[..., some]
        change(part, values[..., own], out=part)


def runs(steps: Int[np.ndarray, " step"]) -> Iterator[tuple[slice, slice]]:
    """Yield runs of consecutive steps, and their places among all the steps.

    Slices are several times as fast as indices.

    >>> list(runs(np.array([3, 4, 7])))
    [(slice(3, 5, None), slice(0, 2, None)), (slice(7, 8, None), slice(2, 3, None))]
    """
    edges = [0, *(np.flatnonzero(np.diff(steps) != 1) + 1).tolist(), len(steps)]
    for first, last in itertools.pairwise(edges):
        if last > first:
            start = int(steps[first])
            yield slice(start, start + last - first), slice(first, last)


def sky_product(
    values: Float[np.ndarray, "*batch channel row patch"],
    sky: SkyMatrix,
    weights: Float[np.ndarray, " band"],
) -> Float32[np.ndarray, "rows step"]:
    """Return the product of matrices and sky radiance, as a weighted sum of bands."""
    patches = values.shape[-1]
    shape = len(weights), patches
    found = np.zeros((values[..., 0, :, 0].size, len(sky.times)), np.float32)
    for one in sky.parts:
        if one.diffuse.any():
            tint = np.broadcast_to(one.colour, shape)
            found += fold(values, tint, weights).reshape(-1, patches) @ one.diffuse
        if one.sun.nnz:
            tint = np.broadcast_to(one.sun_colour[:, None], shape)
            rows = fold(values, tint, weights).reshape(-1, patches)
            found += (one.sun.T @ np.ascontiguousarray(rows.T)).T
    return found


def _weighted(
    sky: SkyMatrix, weights: Float[np.ndarray, " band"]
) -> Float32[np.ndarray, "patch step"]:
    found: np.ndarray = np.zeros(sky.parts[0].diffuse.shape, np.float32)
    for one in sky.parts:
        tint = np.broadcast_to(one.colour, (len(weights), len(found)))
        found += (weights @ tint).astype(np.float32)[:, None] * one.diffuse
        sun = one.sun.tocoo()
        found[sun.row, sun.col] += np.float32(weights @ one.sun_colour) * sun.data
    return found


def exiting_light(
    chains: Sequence[MatrixChain],
    sky: SkyMatrix,
    states: Sequence[Int[np.ndarray, " step"]],
    weights: Weights,
    *,
    errors: bool = True,
    arriving: "Arriving | None" = None,
    threads: bool = False,
) -> PatchLight:
    """Return the exiting radiance T(t) D S(t) of all windows.

    `arriving` returns D S, by default computed here; `threads`: windows in threads.
    """
    summed = len(weights) == 1
    channels = 1 if summed and all(map(_is_grey, chains)) else weights.shape[1]
    each = weights if channels == 1 or not summed else np.diag(weights[0])
    make = partial(_exiting, sky, each, errors=errors, arriving=arriving or _arriving)
    windows = zip(chains, states, strict=True)
    parts = list((computed_in_threads if threads else map)(make, windows))
    values = np.concatenate([part[0] for part in parts], axis=1)
    return PatchLight(values, tuple(part[1:] for part in parts), summed)


def _is_grey(chain: MatrixChain) -> bool:
    # Whether V and T have one channel, so that only D and the sky are coloured
    middle = (factor for factors in chain.factors for factor in factors[:-1])
    grey = channel_count(chain.receiving[0]) == 1
    return grey and all(len(factor.values) == 1 for factor in middle)


def _exiting(
    sky: SkyMatrix,
    weights: Float[np.ndarray, "channel band"],
    window: tuple[MatrixChain, Int[np.ndarray, " step"]],
    *,
    errors: bool,
    arriving: "Arriving",
) -> Float32[np.ndarray, "layer channel patch step"]:
    # Radiance and error components of a window, given its matrices and shade states.
    # D S is computed once for all states with equal D
    chain, state = window
    layers = 1 + (chain_components(chain) if errors else 0)
    patches = chain.factors[0][0].rows.size
    found = np.zeros((layers, len(weights), patches, len(state)), np.float32)
    sources: dict[int, list[int]] = {}
    for number in np.unique(state).tolist():
        sources.setdefault(id(chain.factors[number][-1]), []).append(number)
    for numbers in sources.values():
        steps = np.flatnonzero(np.isin(state, numbers))
        last = chain.factors[numbers[0]][-1]
        make = partial(_arrived, last, sky, steps, weights, errors=errors)
        arrived = arriving(last, steps, weights, make)
        for number in numbers:
            acts = state[steps] == number
            light = arrived if acts.all() else arrived[..., acts]
            for factor in reversed(chain.factors[number][:-1]):
                light = _passed(factor, light, errors=errors)
            found[: len(light), :, :, steps[acts]] = light
    return found


def _arrived(
    daylight: TransferMatrix,
    sky: SkyMatrix,
    steps: Int[np.ndarray, " step"],
    weights: Float[np.ndarray, "channel band"],
    *,
    errors: bool,
) -> Received:
    layers = side_by_side([daylight], slice(None), errors=errors)
    return SkyLight(sky.select(steps), weights).received(layers)


def _arriving(
    _daylight: TransferMatrix,
    _steps: Int[np.ndarray, " step"],
    _weights: Float[np.ndarray, "channel band"],
    make: Callable[[], Received],
) -> Received:
    return make()


def _passed(
    factor: TransferMatrix,
    light: Float32[np.ndarray, "layer channel outer step"],
    *,
    errors: bool,
) -> Float32[np.ndarray, "more channel inner step"]:
    # Product of a matrix and the radiance, then its error components due to the error
    # of the radiance, then its error components due to the error of the matrix
    found = factor.values.astype(np.float32) @ light
    if factor.components is None or not errors:
        return np.asarray(found)
    own = factor.components.astype(np.float32) @ light[0]
    return np.concatenate([found, own])
