"""Panes and suspended films of the built-in BSDFs: generic products.

Properties are averages over the solar and the visible spectrum at normal incidence.

Source: EnergyPlus, datasets/WindowGlassMaterials.idf, which takes them from the glass
library of WINDOW 4.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clerestory.glazing.layer import Glass
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import two_band_pane


class _Averages(NamedTuple):
    # Thickness [mm], solar and visible properties, emissivities; the front is outside
    thickness: float
    solar: tuple[float, float, float]
    visible: tuple[float, float, float]
    emissivities: tuple[float, float] = (0.84, 0.84)


# Transmittance, front and back reflectance
_PANES = {
    "clear-3": _Averages(3, (0.837, 0.075, 0.075), (0.898, 0.081, 0.081)),
    "clear-6": _Averages(6, (0.775, 0.071, 0.071), (0.881, 0.080, 0.080)),
    "clear-12": _Averages(12, (0.653, 0.064, 0.064), (0.841, 0.077, 0.077)),
    "low-iron-3": _Averages(3, (0.899, 0.079, 0.079), (0.913, 0.082, 0.082)),
    "bronze-6": _Averages(6, (0.482, 0.054, 0.054), (0.534, 0.057, 0.057)),
    "grey-6": _Averages(6, (0.455, 0.053, 0.053), (0.431, 0.052, 0.052)),
    "grey-12": _Averages(12, (0.217, 0.044, 0.044), (0.187, 0.045, 0.045)),
    "green-6": _Averages(6, (0.487, 0.056, 0.056), (0.749, 0.070, 0.070)),
    "pyrolytic-6": _Averages(
        6, (0.680, 0.090, 0.100), (0.810, 0.110, 0.120), (0.84, 0.20)
    ),
    "lowe-3": _Averages(3, (0.630, 0.190, 0.220), (0.850, 0.056, 0.079), (0.84, 0.10)),
    "lowe-6": _Averages(6, (0.600, 0.170, 0.220), (0.840, 0.055, 0.078), (0.84, 0.10)),
    "lowe-tint-6": _Averages(
        6, (0.360, 0.093, 0.200), (0.500, 0.035, 0.054), (0.84, 0.10)
    ),
    "selective-3": _Averages(
        3, (0.450, 0.340, 0.370), (0.780, 0.070, 0.060), (0.84, 0.03)
    ),
    "selective-6": _Averages(
        6, (0.430, 0.300, 0.420), (0.770, 0.070, 0.060), (0.84, 0.03)
    ),
    "selective-tint-6": _Averages(
        6, (0.260, 0.140, 0.410), (0.460, 0.060, 0.040), (0.84, 0.03)
    ),
    "polyester-88": _Averages(
        0.51, (0.656, 0.249, 0.227), (0.868, 0.064, 0.060), (0.136, 0.72)
    ),
    "polyester-77": _Averages(
        0.51, (0.504, 0.402, 0.398), (0.766, 0.147, 0.167), (0.075, 0.72)
    ),
    "polyester-66": _Averages(
        0.51, (0.403, 0.514, 0.515), (0.658, 0.256, 0.279), (0.057, 0.72)
    ),
    "polyester-55": _Averages(
        0.51, (0.320, 0.582, 0.593), (0.551, 0.336, 0.375), (0.046, 0.72)
    ),
}


def library_pane(name: str) -> Glass:
    """Return a pane or a film by name, its coating on the room side.

    >>> pane = library_pane("lowe-6")
    >>> pane.thickness, pane.emissivities
    (0.006, (0.84, 0.1))
    """
    given = _PANES[name]
    front, back = given.emissivities
    pane = two_band_pane(
        name, solar=_optics(given.solar), visible=_optics(given.visible)
    )
    return Glass(
        replace(
            pane,
            thickness=given.thickness / 1000,
            coated=front != back,
            emissivity_front=front,
            emissivity_back=back,
        )
    )


def _optics(shares: tuple[float, float, float]) -> Optics:
    transmitted, front, back = shares
    return replace(Optics.alike(transmitted, front), reflection_back=np.asarray(back))
