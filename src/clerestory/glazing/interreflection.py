"""Interreflection between parallel layers, summed over all orders.

Matrices are flux fractions: entry (i, j) is the fraction of the flux through incident
patch j that leaves through patch i, or the BSDF times the projected solid angle of
patch i. Matrices of successive layers are multiplied.

Reference: J. H. Klems, ASHRAE Transactions 100 (1), 1994: I. Optical properties,
1065–1072; II. Detailed equations, 1073–1086.
"""

from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Side
from clerestory.glazing.optics import Optics


class StackProperties(NamedTuple):
    """Flux matrices (…, n, n) of a stack, and absorptance of each layer per incident
    patch for light on the front and on the back of the stack.
    """

    system: Optics
    absorbed: Float[np.ndarray, "2 layer *batch n"]


def stack_properties(layers: Sequence[Optics]) -> StackProperties:
    """Return the optical properties of a stack from flux matrices of the layers.

    `layers`: flux matrices from outdoors to indoors, each of shape (…, n, n).
    """
    reverse = [layer.swapped() for layer in reversed(layers)]
    # Stacks of the first 1, 2, … layers, and of the last 1, 2, … layers
    outer, inner = (list(accumulate(some, combine)) for some in (layers, reverse))
    front = _absorbed(layers, outer, inner)
    back = _absorbed(reverse, inner, outer)
    return StackProperties(outer[-1], np.array([front, back[::-1]]))


def combine(outer: Optics, inner: Optics) -> Optics:
    """Combine two layers, or stacks of layers, into one (Klems 1994, II, eq. 8–11)."""
    enter = between(
        outer.reflection_back, inner.reflection_front, outer.transmission_front
    )
    leave = between(
        inner.reflection_front, outer.reflection_back, inner.transmission_back
    )
    return Optics(
        inner.transmission_front @ enter,
        outer.transmission_back @ leave,
        outer.reflection_front
        + outer.transmission_back @ (inner.reflection_front @ enter),
        inner.reflection_back
        + inner.transmission_front @ (outer.reflection_back @ leave),
    )


def between(
    behind: Float[np.ndarray, "*batch n n"],
    ahead: Float[np.ndarray, "*batch n n"],
    arriving: Float[np.ndarray, "*batch n n"],
) -> Float[np.ndarray, "*batch n n"]:
    """Flux that reaches the layer beyond a gap, after all interreflections.

    `behind`, `ahead`: reflection flux matrices of the layers before and after the gap.
    `arriving`: flux that enters the gap through the layer before the gap.
    """
    loop = np.eye(behind.shape[-1]) - behind @ ahead
    return np.asarray(np.linalg.solve(loop, arriving))


def _absorbed(
    layers: Sequence[Optics], outer: Sequence[Optics], inner: Sequence[Optics]
) -> list[Float[np.ndarray, "*batch n"]]:
    # Absorptance of each layer for flux incident on layer 0. `inner`: stacks of the
    # last 1, 2, … layers, reversed.
    kept = []
    for k, layer in enumerate(layers):
        behind = len(layers) - 1 - k
        on_front = (
            np.eye(layer.transmission_front.shape[-1])
            if k == 0
            else between(
                outer[k - 1].reflection_back,
                inner[behind].reflection_back,
                outer[k - 1].transmission_front,
            )
        )
        share = _row(layer, "front") @ on_front
        if behind > 0:
            mirror = inner[behind - 1].reflection_back
            share = share + _row(layer, "back") @ mirror @ between(
                outer[k].reflection_back, mirror, outer[k].transmission_front
            )
        kept.append(share[..., 0, :])
    return kept


def _row(layer: Optics, side: Side) -> Float[np.ndarray, "*batch 1 n"]:
    # Absorptance of a layer per incident patch, as a row vector
    passed = layer.map(lambda flux: flux.sum(axis=-2, keepdims=True))
    return passed.absorption(side)
