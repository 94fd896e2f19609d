"""Sampling of a layer in one spectral band, for random walks between layers.

Panes transmit or reflect specularly, by tables over the angle of incidence. Openings
transmit rays undeviated. All other rays are scattered by the BSDF of the layer, at the
resolution of its data.
"""

from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Mask, Values
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import (
    FUNCTIONS,
    OF_SIDE,
    Function,
    ScatteringFunction,
)
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.layer import Layer, diagonal
from clerestory.glazing.optics import Optics
from clerestory.glazing.stack import layer_band
from clerestory.glazing.standard import Channel, Standard
from clerestory.hemisphere.klems import klems

# Number of cosines in the specular table of a pane.
_TABLE = 513

# Factors that convert centres of exit patches to directions for `Layer.openness`.
_TURN = {
    "transmission_front": np.array([1.0, 1.0, 1.0]),
    "transmission_back": np.array([-1.0, -1.0, 1.0]),
}

_Directions = Float[np.ndarray, "walker 3"]


@final
@dataclass(frozen=True, eq=False)
class Scatterer:
    """A layer in one spectral band; openings in the layer transmit light undeviated.

    `mirror`: specular T and R over the cosine of incidence; None for scattering layers.
    `bsdf`: BSDF of the scattered light, stored as channel "visible"; None for panes.
    """

    layer: Layer
    mirror: Optics | None
    bsdf: Bsdf | None

    def shares(self, travel: _Directions) -> tuple[Values, Values]:
        """Transmittance and reflectance for each direction of incidence.

        `travel`: directions of travel, all with the same sign of z.
        """
        if self.mirror is not None:
            cosine, grid = np.abs(travel[:, 2]), np.linspace(0, 1, _TABLE)
            on, back = (
                np.interp(cosine, grid, self.mirror.of(name)) for name in _names(travel)
            )
            return np.asarray(on), np.asarray(back)
        on, back = (self._scattered(travel, name) for name in _names(travel))
        return on + self._open(travel), back

    def leave(
        self, travel: _Directions, passed: Mask, rng: np.random.Generator
    ) -> _Directions:
        """Sample the directions in which rays leave the layer; `travel`: incident rays.

        `passed`: True for rays that are transmitted, False for reflected rays.
        """
        leaving = np.where(passed[:, None], travel, travel * [1, 1, -1])
        if self.mirror is not None:
            return leaving
        free = self._open(travel)
        on, back = _names(travel)
        total = free + self._scattered(travel, on)
        untouched = passed & (rng.random(len(travel)) * total < free)
        for name, some in ((on, passed & ~untouched), (back, ~passed)):
            if self.bsdf is not None and np.any(some):
                u = rng.random((int(some.sum()), 2))
                leaving[some] = self.bsdf.sample(-travel[some], u, function=name)[0]
        return leaving

    def _scattered(self, travel: _Directions, name: Function) -> Values:
        if self.bsdf is None or not self.bsdf.has(name):
            return np.zeros(len(travel))
        return self.bsdf.hemispherical(-travel, function=name)

    def _open(self, travel: _Directions) -> Values:
        sign = 1.0 if travel[0, 2] > 0 else -1.0
        return self.layer.openness(travel * sign)


def scatterer(layer: Layer, standard: Standard, channel: Channel) -> Scatterer:
    """Return the sampler of a layer in one spectral band."""
    known = layer.wavelength_nm
    clear = layer.specular(known, np.maximum(np.linspace(0, 1, _TABLE), 1e-6))
    if clear is not None:
        weights = standard.band(channel).weights(known)
        return Scatterer(layer, clear.map(lambda share: weights @ share), None)
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    if isinstance(layer, BsdfLayer):
        used = layer.channel(channel)
        for name in FUNCTIONS:
            if layer.bsdf.has(name, channel=used):
                functions["visible", name] = layer.bsdf.scattering(name, channel=used)
        return Scatterer(layer, None, Bsdf(functions))

    # BSDF of the layer without its openings, in the full Klems basis
    partition = klems("full")
    shares = layer_band(layer, standard, channel, partition)
    measure = partition.projected_solid_angles()
    for name in FUNCTIONS:
        rest = shares.of(name)
        if name in _TURN:
            free = layer.openness(partition.centres() * _TURN[name])
            rest = rest - diagonal((free / measure)[None])[0]
        functions["visible", name] = ScatteringMatrix(
            np.maximum(rest, 0), partition, partition
        )
    return Scatterer(layer, None, Bsdf(functions))


def _names(travel: _Directions) -> tuple[Function, Function]:
    # Names of the transmission and reflection functions for the incident side
    return OF_SIDE["front" if travel[0, 2] > 0 else "back"]
