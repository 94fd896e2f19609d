"""BSDF layers in glazing systems, from visible and solar or from spectral matrices.

The visible matrix applies to visible wavelengths, unless the file has spectral data.
The matrix at other wavelengths follows from the solar matrix, with 49 % of solar energy
visible as in WINDOW.
"""

import warnings
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import ExitIncident, Values
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.spectral_channels import spectral_limits, spectral_nodes
from clerestory.checks import require
from clerestory.errors import ClerestoryWarning
from clerestory.glazing.layer import Layer, mirrored_patches
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import (
    GLASS_EMISSIVITY,
    is_visible,
    two_band_wavelengths,
    two_bands,
)
from clerestory.glazing.standard import Channel
from clerestory.hemisphere.partition import RingPartition
from clerestory.spectra import interpolation_matrix

_UNKNOWN_THICKNESS = 1e-3

_OPPOSITE: dict[Function, Function] = {
    "transmission_front": "transmission_back",
    "transmission_back": "transmission_front",
    "reflection_front": "reflection_back",
    "reflection_back": "reflection_front",
}


@final
@dataclass(frozen=True, eq=False)
class BsdfLayer(Layer):
    """A layer with known BSDF, whose front faces the sky.

    Attributes
    ----------
    conductivity : thermal conductivity [W/(m K)]
    infrared_transmittance : transmittance in the far infrared
    permeability : area fraction that is permeable to air
    """

    bsdf: Bsdf
    conductivity: float = 1.0
    infrared_transmittance: float = 0.0
    permeability: float = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        require(
            any(self.bsdf.has("transmission_front", channel=c) for c in _BANDS),
            f"BSDF {self.bsdf.product.name!r} has neither visible nor solar"
            " transmission; one of them expected in a layer",
            file=self.bsdf.source,
        )
        missing = [
            f"{lacking} data; its {used} data are used"
            for lacking, used in (("solar", "visible"), ("visible", "solar"))
            if not self.bsdf.has("transmission_front", channel=lacking)
        ] + [
            f"{part.replace('_', ' ')} data; zero is assumed"
            for part in ("reflection_front", "reflection_back")
            if not self.bsdf.has(part, channel=self.channel("visible"))
        ]
        for text in missing:
            message = f"BSDF {self.bsdf.product.name!r} has no {text}"
            warnings.warn(message, ClerestoryWarning, stacklevel=3)

    @property
    def name(self) -> str:
        """Name of the product in the file."""
        return self.bsdf.product.name or self.bsdf.source or "BSDF"

    @property
    def wavelength_nm(self) -> Values:
        """Wavelengths at the limits of the solar and the visible range [nm].

        Those of spectral data are added.
        """
        nodes, _ = spectral_nodes(self.bsdf)
        return np.union1d(two_band_wavelengths(), nodes[is_visible(nodes)])

    @property
    def thickness(self) -> float:
        """Thickness stated in the file [m]; default: 1 mm."""
        return self.bsdf.product.thickness or _UNKNOWN_THICKNESS

    @property
    def emissivities(self) -> tuple[float, float]:
        """Far-infrared emissivities stated in the file; default: 0.84."""
        product = self.bsdf.product
        known = (product.emissivity_front, product.emissivity_back)
        front, back = (GLASS_EMISSIVITY if e is None else e for e in known)
        return front, back

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        visible, solar = (self.band(channel, partition) for channel in _BANDS)
        seen = is_visible(wavelength_nm)
        found = two_bands(visible, solar, seen[:, None, None])
        if not (spectral_limits(self.bsdf) and seen.any()):
            return found
        at = np.flatnonzero(seen)

        def table(name: Function) -> Float[np.ndarray, "wavelength exit incident"]:
            values = found.of(name)
            values[at] = self._spectral(name, wavelength_nm[at], partition, values[at])
            return values

        return Optics.gather(table)

    def _spectral(
        self,
        name: Function,
        wavelength_nm: Values,
        partition: RingPartition,
        otherwise: Float[np.ndarray, "wavelength exit incident"],
    ) -> Float[np.ndarray, "wavelength exit incident"]:
        # BSDFs at visible wavelengths from the spectral channels
        nodes, at = spectral_nodes(self.bsdf)
        channels = tuple(spectral_limits(self.bsdf))
        if not all(self.bsdf.has(name, channel=channel) for channel in channels):
            return otherwise
        weights, total = interpolation_matrix(nodes, wavelength_nm), 0.0 * otherwise
        for number in np.unique(at[weights.any(axis=0)]):
            part = self.bsdf.function(
                name, channel=channels[number], partition=partition
            )
            share = weights[:, at == number].sum(axis=1)
            total += share[:, None, None] * part.values
        return np.asarray(total)

    def band(self, channel: Channel, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] of one band by exit patch and incident patch."""
        given = self.channel(channel)

        def table(name: Function) -> ExitIncident:
            if not self.bsdf.has(name, channel=given):
                return np.zeros((len(partition), len(partition)))
            return self.bsdf.function(name, channel=given, partition=partition).values

        return Optics.gather(table)

    def flipped(self) -> "BsdfLayer":
        """Return the layer turned about its vertical axis; trees become matrices."""
        functions: dict[tuple[str, Function], ScatteringFunction] = {}
        for channel, name in self.bsdf.functions:
            part = self.bsdf.function(name, channel=channel)
            image = np.ix_(*map(mirrored_patches, (part.exits, part.incidents)))
            turned = ScatteringMatrix(part.values[image], part.exits, part.incidents)
            functions[channel, _OPPOSITE[name]] = turned
        product = self.bsdf.product
        product = replace(
            product,
            emissivity_front=product.emissivity_back,
            emissivity_back=product.emissivity_front,
        )
        bsdf = replace(self.bsdf, functions=functions, product=product)
        return replace(self, bsdf=bsdf)

    def channel(self, wanted: Channel) -> Channel:
        """Return the wanted channel, or the other one if the wanted one is missing."""
        other: Channel = "solar" if wanted == "visible" else "visible"
        return wanted if self.bsdf.has("transmission_front", channel=wanted) else other


_BANDS: tuple[Channel, Channel] = ("visible", "solar")
