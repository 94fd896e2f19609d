"""Flat panes as parametric systems: diffuse sheets and clear glass."""

import numpy as np

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import Share, channel_values
from clerestory.bsdfgen.fabric import diffuse_material
from clerestory.bsdfgen.shading_system import System, unit_cell
from clerestory.checks import require
from clerestory.scene.model import Glass, Material, Polygon, Scene


def diffuse_pane(*, transmittance: Share, reflectance: Share = 0.0) -> System:
    """Return a Lambertian sheet.

    `transmittance`, `reflectance`: values with a sum of at most 1 in each channel.

    >>> diffuse_pane(transmittance=0.5).area.periodic
    True
    """
    passed, reflected = (
        channel_values("transmittance", transmittance),
        channel_values("reflectance", reflectance),
    )
    return _sheet(diffuse_material("pane", reflected, passed), "Diffuse pane")


def clear_pane(*, transmissivity: Share = 0.96, index: float = 1.52) -> System:
    """Return a thin pane of clear glass, as Radiance's material `glass`.

    Parameters
    ----------
    transmissivity : internal transmittance at normal incidence
    index : refractive index

    Examples
    --------
    >>> clear_pane().scene.surfaces[0].name
    'pane'
    """
    require(index >= 1, f"index is {index}; a refractive index of 1 or more expected")
    glass = Glass("pane", channel_values("transmissivity", transmissivity), index)
    return _sheet(glass, "Clear pane")


def _sheet(material: Material, name: str) -> System:
    corners = np.array([[-0.1, -0.1, 0], [1.1, -0.1, 0], [1.1, 1.1, 0], [-0.1, 1.1, 0]])
    scene = Scene({"pane": material}, (Polygon(corners, "pane", "pane"),))
    return System(scene, unit_cell(1.0, 1.0, 0.0), product=Product(name=name))
