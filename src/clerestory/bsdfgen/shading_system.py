"""Geometry of a shading system, ready for BSDF generation."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.channel_weights import VISIBLE, Weights
from clerestory.scene.model import Scene


@dataclass(frozen=True, eq=False)
class System:
    """Geometry and all else that BSDF generation needs.

    Attributes
    ----------
    scene : in the frame of genBSDF [m]
    area : sample area
    bands : for each band of the BSDF, weights of the bands of the scene
    product : name and dimensions, for the file
    """

    scene: Scene
    area: SampleArea
    bands: Mapping[str, Weights] = field(default_factory=lambda: dict(VISIBLE))
    product: Product = field(default_factory=Product)
