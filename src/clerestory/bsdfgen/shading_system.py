"""A shading system as geometry, ready to be traced to a BSDF."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.channel_weights import VISIBLE, Weights
from clerestory.scene.model import Scene


@dataclass(frozen=True, eq=False)
class System:
    """Geometry with all that tracing it takes.

    Attributes
    ----------
    scene : in the frame of genBSDF [m]
    area : the piece that stands for the whole
    bands : for each band of the BSDF, the share of the scene's three channels in it
    product : name and dimensions, for the file
    """

    scene: Scene
    area: SampleArea
    bands: Mapping[str, Weights] = field(default_factory=lambda: dict(VISIBLE))
    product: Product = field(default_factory=Product)
