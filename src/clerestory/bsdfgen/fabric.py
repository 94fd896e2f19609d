"""Roller-shade fabrics from openness factor and reflectance in product catalogues.

The fabric is a diffusing sheet with square holes that transmit direct light; its
thickness shades the holes at oblique incidence.
"""

import math

import numpy as np

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.screen_geometry import sheet_with_holes, unit_cell
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.system_parameters import Share, bands, channel_values
from clerestory.errors import InputError
from clerestory.scene.model import Plastic, Trans

# Distance between hole centres [m]; only its ratio to the thickness affects the BSDF.
_PITCH = 1e-3


def fabric(
    *,
    openness: float,
    reflectance: Share,
    diffuse_transmittance: Share = 0.0,
    thickness: float = 0.3,
) -> System:
    """Return the unit cell of an infinite fabric.

    Parameters
    ----------
    openness : openness factor, 0 ≤ openness < 1
    reflectance : reflectance of the threads; the reflectance of the fabric is this
        value times (1 − openness)
    diffuse_transmittance : diffuse transmittance of the threads
    thickness : ratio of fabric thickness to thread distance; with 0 the openness does
        not depend on the angle of incidence

    Examples
    --------
    >>> cloth = fabric(openness=0.05, reflectance=0.6, diffuse_transmittance=0.1)
    >>> cloth.product.name
    'Fabric, 5.0% open'
    """
    if not 0 <= openness < 1:
        raise InputError(f"openness = {openness}; 0 ≤ openness < 1 expected")
    if not 0 <= thickness <= 10:
        raise InputError(
            f"thickness = {thickness}; 0 to 10 times the thread distance expected"
        )
    reflected = channel_values("reflectance", reflectance)
    passed = channel_values("diffuse_transmittance", diffuse_transmittance)
    cloth = diffuse_material("cloth", reflected, passed)
    hole = max(math.sqrt(openness), 1e-4) * _PITCH
    depth = thickness * _PITCH
    scene = sheet_with_holes(
        cloth, pitch=_PITCH, hole=hole, shape="square", thickness=depth, faces=1
    )
    return System(
        scene,
        unit_cell(_PITCH, depth),
        bands(solar=False),
        Product(name=f"Fabric, {openness:.1%} open", device_type="Roller Shade"),
    )


def diffuse_material(
    name: str, reflected: np.ndarray, passed: np.ndarray
) -> Plastic | Trans:
    """Return a diffuse material of given reflectance and transmittance."""
    both = reflected + passed
    if np.any(both > 1):
        raise InputError(
            f"reflectance {reflected.tolist()} and transmittance {passed.tolist()};"
            " a sum of at most 1 expected"
        )
    if not passed.any():
        return Plastic(name, reflected)
    part = np.divide(passed, both, out=np.full(3, -1.0), where=both > 0)
    known = part[part >= 0]
    if np.ptp(known) > 1e-6:
        raise InputError(
            f"reflectance {reflected.tolist()} and transmittance {passed.tolist()}"
            " differ in colour; the same ratio in each channel expected"
        )
    return Trans(name, both, transmission=float(known[0]))
