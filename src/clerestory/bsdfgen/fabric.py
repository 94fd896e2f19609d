"""Roller-shade fabrics from openness factor and reflectance in product catalogues.

The fabric is a diffusing sheet with square holes that transmit direct light; its
thickness shades the holes at oblique incidence.
"""

import math

import numpy as np

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values
from clerestory.bsdfgen.screen_geometry import sheet_with_holes
from clerestory.bsdfgen.shading_system import System
from clerestory.checks import require, within
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
    require(0 <= openness < 1, f"openness is {openness}; 0 ≤ openness < 1 expected")
    within(thickness, "thickness in thread distances", least=0, most=10)
    reflected = channel_values("reflectance", reflectance)
    passed = channel_values("diffuse_transmittance", diffuse_transmittance)
    cloth = diffuse_material("cloth", reflected, passed)
    hole = max(math.sqrt(openness), 1e-4) * _PITCH
    depth = thickness * _PITCH
    scene, area = sheet_with_holes(
        cloth, pitch=_PITCH, hole=hole, shape="square", thickness=depth, faces=1
    )
    name = f"Fabric, {openness:.1%} open"
    product = Product(name=name, device_type="Roller Shade")
    return System(scene, area, product=product)


def diffuse_material(
    name: str, reflected: np.ndarray, passed: np.ndarray
) -> Plastic | Trans:
    """Return a diffuse material of given reflectance and transmittance."""
    both = reflected + passed
    given = f"reflectance {reflected.tolist()} and transmittance {passed.tolist()}"
    require(np.all(both <= 1), f"{given}; a sum of at most 1 expected")
    if not passed.any():
        return Plastic(name, reflected)
    part = np.divide(passed, both, out=np.full(3, -1.0), where=both > 0)
    known = part[part >= 0]
    alike = np.ptp(known) <= 1e-6
    require(alike, f"{given} differ in colour; equal ratios in all channels expected")
    return Trans(name, both, transmission=float(known[0]))
