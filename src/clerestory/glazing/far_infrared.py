"""Hemispherical far-infrared properties of layers."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import SIDES, Function
from clerestory.glazing.air_flow import Shade
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.layer import Layer, MaterialLayer
from clerestory.glazing.optics import Optics
from clerestory.hemisphere.klems import klems


class FarInfrared(NamedTuple):
    """Transmittance in the far infrared, and emissivities of both sides."""

    transmittance: float
    emissivity_front: float
    emissivity_back: float


def far_infrared(layer: Layer) -> FarInfrared:
    """Return the hemispherical far-infrared properties of a layer.

    Those of a sheet are known. Blinds, woven shades and perforated screens are treated
    as in the solar range, with a material that reflects diffusely what it neither
    transmits nor emits (ISO 15099, section 7.3).

    >>> from clerestory.glazing.layer import Glass
    >>> from clerestory.glazing.pane import grey_pane
    >>> far_infrared(Glass(grey_pane(0.8, 0.1))).emissivity_front
    0.84
    """
    if isinstance(layer, Shade):
        return _openings_and_material(layer)
    through = 0.0
    if isinstance(layer, BsdfLayer):
        through = layer.infrared_transmittance
    elif isinstance(layer, MaterialLayer):
        through = layer.material.infrared_transmittance
    return FarInfrared(through, *layer.emissivities)


def _openings_and_material(layer: Shade) -> FarInfrared:
    sheet, partition = layer.material, klems("full")
    passed = sheet.infrared_transmittance
    front, back = sheet.emissivity_front, sheet.emissivity_back
    one = np.ones(len(sheet.wavelength_nm))
    shares = (passed, passed, 1 - passed - front, 1 - passed - back)
    grey = replace(
        sheet,
        direct=Optics(*(share * one for share in shares)),
        diffuse=None,
        coated=False,
    )
    matrices = replace(layer, material=grey).matrices(
        sheet.wavelength_nm[:1], partition
    )
    measure = partition.projected_solid_angles()

    def hemispherical(name: Function) -> Values:
        return np.asarray(measure @ matrices.of(name)[0] @ measure / np.pi)

    whole = Optics.gather(hemispherical)
    emitted = [float(np.clip(whole.absorption(side), 0, 1)) for side in SIDES]
    return FarInfrared(float(whole.transmission_front), *emitted)
