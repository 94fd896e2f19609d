"""Interreflection between parallel layers, summed over all orders.

Matrices are flux fractions: entry (i, j) is the fraction of the flux through incident
patch j that leaves through patch i, or the BSDF times the projected solid angle of
patch i. Specular layers have diagonal matrices, which are stored as columns (…, n, 1).
Layers are added one by one, each with one linear system per wavelength; runs of
specular layers are combined first, patch by patch.

Reference: J. H. Klems, ASHRAE Transactions 100 (1), 1994: I. Optical properties,
1065–1072; II. Detailed equations, 1073–1086.
"""

from collections.abc import Sequence
from functools import reduce
from itertools import groupby
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import SIDES
from clerestory.glazing.optics import Optics

# Flux matrices (…, n, n), or columns (…, n, 1) for diagonal matrices
_Flux = Float[np.ndarray, "... _ _"]


class StackProperties(NamedTuple):
    """Flux matrices (…, n, n) of a stack, or columns (…, n, 1) if it is specular, and
    absorptance of each layer per incident patch for light on the front and on the back.
    """

    system: Optics
    absorbed: Float[np.ndarray, "2 layer *batch n"]


class _Stack(NamedTuple):
    # Flux matrices; absorptances (…, layer, n) for light on the front and on the back
    flux: Optics
    front: _Flux
    back: _Flux

    def reversed(self) -> "_Stack":
        return _Stack(
            self.flux.swapped(), self.back[..., ::-1, :], self.front[..., ::-1, :]
        )


def stack_properties(layers: Sequence[Optics]) -> StackProperties:
    """Return the optical properties of a stack from flux matrices of the layers.

    `layers`: flux matrices from outdoors to indoors, each of shape (…, n, n), or
    (…, n, 1) for the diagonals of specular layers.
    """
    runs = groupby(layers, key=lambda layer: _is_diagonal(layer.transmission_front))
    whole = reduce(_join, (reduce(_join, map(_single, run)) for _, run in runs))
    absorbed = np.array([whole.front, whole.back])
    return StackProperties(whole.flux, np.moveaxis(absorbed, -2, 1))


def _single(layer: Optics) -> _Stack:
    if _is_diagonal(layer.transmission_front):
        rows = layer.map(lambda share: share.swapaxes(-1, -2))
    else:
        rows = layer.map(lambda flux: flux.sum(axis=-2, keepdims=True))
    return _Stack(layer, *(rows.absorption(side) for side in SIDES))


def _join(outer: _Stack, inner: _Stack) -> _Stack:
    """Combine two stacks into one (Klems 1994, II, eq. 8–11)."""
    a, b = outer.flux, inner.flux
    if _is_diagonal(b.reflection_front) and not _is_diagonal(a.reflection_back):
        return _join(inner.reversed(), outer.reversed()).reversed()

    # Flux that the inner stack sends back into the gap, per flux from the outer stack
    loop = _plus(np.ones((1, 1)), -_times(b.reflection_front, a.reflection_back))
    back = _divide(loop, b.reflection_front)

    # Flux in the gap towards the inner and the outer stack: for light from outdoors,
    # then for light from indoors
    outwards = _times(back, a.transmission_front)
    inwards = _plus(a.transmission_front, _times(a.reflection_back, outwards))
    leaving = _times(a.reflection_back, b.transmission_back)
    leaving = _plus(b.transmission_back, _times(back, leaving))
    returned = _times(a.reflection_back, leaving)

    flux = Optics(
        _times(b.transmission_front, inwards),
        _times(a.transmission_back, leaving),
        _plus(a.reflection_front, _times(a.transmission_back, outwards)),
        _plus(b.reflection_back, _times(b.transmission_front, returned)),
    )
    front = outer.front + _times(outer.back, outwards), _times(inner.front, inwards)
    rear = _times(outer.back, leaving), inner.back + _times(inner.front, returned)
    return _Stack(flux, *(np.concatenate(parts, axis=-2) for parts in (front, rear)))


def _is_diagonal(flux: _Flux) -> bool:
    return bool(flux.shape[-1] == 1)


def _times(one: _Flux, other: _Flux) -> _Flux:
    if _is_diagonal(one):
        return np.asarray(one * other)
    if _is_diagonal(other):
        return np.asarray(one * other.swapaxes(-1, -2))
    return np.asarray(one @ other)


def _plus(one: _Flux, other: _Flux) -> _Flux:
    if _is_diagonal(one) == _is_diagonal(other):
        return np.asarray(one + other)
    column, full = (one, other) if _is_diagonal(one) else (other, one)
    total = full.copy()
    place = np.arange(full.shape[-1])
    total[..., place, place] += column[..., 0]
    return total


def _divide(loop: _Flux, right: _Flux) -> _Flux:
    if _is_diagonal(loop):
        return np.asarray(right / loop)
    return np.asarray(np.linalg.solve(loop, right))
