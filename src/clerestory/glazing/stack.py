"""BSDF and absorptances of a stack of layers.

The matrices of the layers are combined at each wavelength, and the results are averaged
over the solar and the visible band, and over spectral bands if wanted. Unlike a
combination of band averages, this method is exact for spectrally selective layers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, final, get_args

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bands import Bands
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import (
    FUNCTIONS,
    SIDES,
    Function,
    ScatteringFunction,
    Side,
)
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.checks import one_of, require
from clerestory.errors import InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.interreflection import StackProperties, stack_properties
from clerestory.glazing.layer import Layer
from clerestory.glazing.optics import Optics
from clerestory.glazing.standard import CHANNELS, Channel, Standard, nfrc
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.progress import Progress
from clerestory.spectra import common_wavelengths
from clerestory.spectral.band_sets import mean_weights

# Matrix entries per chunk of wavelengths: 10 MB for four matrices.
_TOGETHER = 300_000

Method = Literal["wavelengths", "bands"]


@final
@dataclass(frozen=True, eq=False)
class StackedLayers:
    """Optical properties of a stack of layers: visible, solar, and in spectral bands.

    `absorptance`: absorptance of each layer per incident patch, by channel and side.
    `layers`: layer names from outdoors to indoors. `standard`: name of the standard for
    spectral averages.
    """

    bsdf: Bsdf
    absorptance: dict[tuple[str, Side], Float[np.ndarray, "layer incident"]]
    layers: tuple[str, ...]
    standard: str
    partition: RingPartition = field(repr=False)

    __repr__ = brief

    def direct_hemispherical(
        self, function: Function, *, channel: str = "visible"
    ) -> Values:
        """Directional-hemispherical transmittance or reflectance per patch."""
        return self.bsdf.direct_hemispherical(function, channel=channel)

    def diffuse(self, function: Function, *, channel: str = "visible") -> float:
        """Diffuse transmittance or reflectance."""
        return self.bsdf.diffuse(function, channel=channel)

    def diffuse_absorptance(
        self, *, channel: str = "solar", side: Side = "front"
    ) -> Values:
        """Absorptance of each layer under uniform hemispherical illumination."""
        one_of(
            channel, "channel", choices=dict.fromkeys(c for c, _ in self.absorptance)
        )
        one_of(side, "side", choices=SIDES)
        measure = self.partition.projected_solid_angles()
        return np.asarray(self.absorptance[channel, side] @ measure / np.pi)


def stack_layers(
    layers: Sequence[Layer],
    *,
    partition: RingPartition | None = None,
    standard: Standard | None = None,
    method: Method = "wavelengths",
    bands: Bands | None = None,
    name: str = "",
    gap_thickness: float = 0.0,
    report: Progress = lambda _share, _note: None,
) -> StackedLayers:
    """Return the optical properties of a stack of layers.

    Parameters
    ----------
    layers : layers from outdoors to indoors, at least one
    partition : patches on both sides; default: full Klems basis
    standard : standard of the spectral averages; default: NFRC
    method : "wavelengths" combines layers at each wavelength; "bands" combines their
        solar and visible averages, which is faster. A single BSDF layer always uses its
        averages.
    bands : spectral bands that the BSDF gets as further channels, with means over
        wavelengths; by "wavelengths" only
    name : name of the system
    gap_thickness : total thickness of the gaps, stored in the product data [m]
    report : function called with the completed fraction and the wavelength

    Raises
    ------
    InputError : no layer, or no common wavelengths

    Examples
    --------
    >>> from clerestory.glazing.layer import Diffuser
    >>> from clerestory.glazing.pane import grey_pane
    >>> cloth = Diffuser(grey_pane(0.5, 0.2))
    >>> pair = stack_layers([cloth, cloth], partition=klems("quarter"))
    >>> round(pair.diffuse("transmission_front"), 4)  # 0.25 / (1 - 0.04)
    0.2604
    """
    require(layers, "stack without layers; at least one expected")
    one_of(method, "method", choices=get_args(Method))
    partition = partition or klems("full")
    standard = standard or nfrc()
    single = len(layers) == 1 and isinstance(layers[0], BsdfLayer)
    averaged = single or method == "bands"
    sums: dict[str, StackProperties] = {}
    if averaged:
        for part in CHANNELS:
            sums[part] = _band_by_band(layers, standard, part, partition)
    if bands is not None or not averaged:
        require(
            method == "wavelengths",
            'spectral bands with the method "bands"; the method "wavelengths" expected',
        )
        grid = common_wavelengths([layer.wavelength_nm for layer in layers])
        weights = {} if averaged else _standard_weights(standard, grid)
        if bands is not None:
            weights |= dict(zip(bands.names, mean_weights(grid, bands), strict=True))
        sums |= _by_wavelength(layers, grid, weights, partition, report)
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    channels: list[str] = [*reversed(CHANNELS), *(bands.names if bands else ())]
    for channel in channels:
        for function in FUNCTIONS:
            # Clip rounding errors
            flux = np.maximum(sums[channel].system.of(function), 0)
            if flux.shape[-1] == 1:
                flux = np.diagflat(flux)
            value = flux / partition.projected_solid_angles()[:, None]
            functions[channel, function] = ScatteringMatrix(value, partition, partition)
    names = tuple(layer.name for layer in layers)
    absorptance = {
        (channel, side): absorbed
        for channel in sums
        for side, absorbed in zip(SIDES, sums[channel].absorbed, strict=True)
    }
    bsdf = Bsdf(functions, _product(layers, gap_thickness, name))
    return StackedLayers(bsdf, absorptance, names, standard.name, partition)


def _product(layers: Sequence[Layer], gap_thickness: float, name: str) -> Product:
    # WINDOW and pywincalc require a manufacturer and a thickness
    return Product(
        name=name or " | ".join(layer.name for layer in layers),
        manufacturer="stack of layers",
        thickness=sum(layer.thickness for layer in layers) + gap_thickness,
        emissivity_front=layers[0].emissivities[0],
        emissivity_back=layers[-1].emissivities[1],
    )


def _standard_weights(standard: Standard, grid: Values) -> dict[str, Values]:
    return {channel: standard.band(channel).weights(grid) for channel in CHANNELS}


def _by_wavelength(
    layers: Sequence[Layer],
    grid: Values,
    weights: dict[str, Values],
    partition: RingPartition,
    report: Progress,
) -> dict[str, StackProperties]:
    # Properties averaged over wavelengths, by channel
    counts = np.flatnonzero(np.any(list(weights.values()), axis=0))
    total: dict[str, StackProperties] = {}
    chunk = max(1, _TOGETHER // len(partition) ** 2)
    for start in range(0, len(counts), chunk):
        part = counts[start : start + chunk]
        passage = _passage(layers, grid[part], partition)
        for channel, every in weights.items():
            weight, before = every[part], total.get(channel)
            if not weight.any():
                continue
            system = passage.system.averaged(weight)
            sides = passage.absorbed
            absorbed = np.array([np.tensordot(a, weight, axes=(1, 0)) for a in sides])
            if before is not None:
                system = before.system.plus(system)
                absorbed = before.absorbed + absorbed
            total[channel] = StackProperties(system, absorbed)
        report((start + len(part)) / len(counts), f"{grid[part[-1]]:.0f} nm")
    return total


def _band_by_band(
    layers: Sequence[Layer],
    standard: Standard,
    channel: Channel,
    partition: RingPartition,
) -> StackProperties:
    measure = partition.projected_solid_angles()[:, None]
    averages = [
        layer_band(layer, standard, channel, partition).map(lambda f: measure * f)
        for layer in layers
    ]
    return stack_properties(averages)


def layer_band(
    layer: Layer, standard: Standard, channel: Channel, partition: RingPartition
) -> Optics:
    """Band-averaged BSDFs [1/sr] of a layer by exit patch and incident patch."""
    if isinstance(layer, BsdfLayer):
        return layer.band(channel, partition)
    weights = standard.band(channel).weights(layer.wavelength_nm)
    counts = np.flatnonzero(weights)
    chunk = max(1, _TOGETHER // len(partition) ** 2)
    total: Optics | None = None
    for start in range(0, len(counts), chunk):
        part = counts[start : start + chunk]
        matrices = layer.matrices(layer.wavelength_nm[part], partition)
        shares = matrices.averaged(weights[part])
        total = shares if total is None else total.plus(shares)
    if total is None:
        raise InputError(f"layer {layer.name!r} has no data in the {channel} band")
    return total


def _passage(
    layers: Sequence[Layer], wavelength_nm: Values, partition: RingPartition
) -> StackProperties:
    measure = partition.projected_solid_angles()[:, None]
    cosine = partition.centres()[:, 2]

    def flux(layer: Layer) -> Optics:
        clear = layer.specular(wavelength_nm, cosine)
        if clear is not None:
            return clear.map(lambda share: share[..., None])
        return layer.matrices(wavelength_nm, partition).map(lambda f: measure * f)

    return stack_properties([flux(layer) for layer in layers])
