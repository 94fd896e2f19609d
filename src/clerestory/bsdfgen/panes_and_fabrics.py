"""Diffuse and clear panes, and roller-shade fabrics by openness and reflectance.

The fabric is a diffusing sheet with square holes that transmit direct light; its
thickness shades the holes at oblique incidence.
"""

import math

import numpy as np

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values
from clerestory.bsdfgen.screen_geometry import sheet_with_holes
from clerestory.bsdfgen.shading_system import System, unit_cell
from clerestory.checks import require, within
from clerestory.scene.model import Glass, Material, Plastic, Polygon, Scene, Trans

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
    product = Product(name=f"Fabric, {openness:.1%} open", device_type="Roller Shade")
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


def diffuse_pane(*, transmittance: Share, reflectance: Share = 0.0) -> System:
    """Return a Lambertian sheet.

    `transmittance` plus `reflectance` must be at most 1 in each channel.
    """
    passed, reflected = (
        channel_values("transmittance", transmittance),
        channel_values("reflectance", reflectance),
    )
    return _sheet(diffuse_material("pane", reflected, passed), "Diffuse pane")


def clear_pane(*, transmissivity: Share = 0.96, index: float = 1.52) -> System:
    """Return a thin pane of clear glass, as Radiance's material `glass`.

    `transmissivity`: internal transmittance at normal incidence. `index`: refractive
    index.
    """
    require(index >= 1, f"index is {index}; a refractive index of 1 or more expected")
    glass = Glass("pane", channel_values("transmissivity", transmissivity), index)
    return _sheet(glass, "Clear pane")


def _sheet(material: Material, name: str) -> System:
    corners = np.array([[-0.1, -0.1, 0], [1.1, -0.1, 0], [1.1, 1.1, 0], [-0.1, 1.1, 0]])
    scene = Scene({"pane": material}, (Polygon(corners, "pane", "pane"),))
    return System(scene, unit_cell(1.0, 1.0, 0.0), product=Product(name=name))
