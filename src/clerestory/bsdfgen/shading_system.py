"""Shading systems as geometry, with the sample area that rays are traced through.

The frame is that of genBSDF: +x along the width, +y up, +z into the room; the system is
at z ≤ 0.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import VISIBLE, Weights
from clerestory.errors import InputError
from clerestory.scene.model import Scene

# Distance of the faces from the system, as a share of its size.
_CLEARANCE = 1e-5


@dataclass(frozen=True, eq=False)
class SampleArea:
    """A box whose front and back faces rays enter and leave through.

    Attributes
    ----------
    bounds : lower and upper corner [m]
    periodic : whether the box is the unit cell of an endless system; rays that leave
        one side re-enter at the opposite one, otherwise they are lost

    Raises
    ------
    InputError : no width or height, or a negative depth

    Examples
    --------
    >>> SampleArea(np.array([[0, 0, -0.08], [1, 0.72, 0]])).thickness
    0.08
    """

    bounds: Float[np.ndarray, "2 3"]
    periodic: bool = False

    def __post_init__(self) -> None:
        bounds = np.asarray(self.bounds, dtype=float)
        object.__setattr__(self, "bounds", bounds)
        size = bounds[1] - bounds[0]
        if not np.all(np.isfinite(bounds)) or not (size[:2] > 0).all() or size[2] < 0:
            raise InputError(
                f"sample area from {bounds[0].tolist()} to {bounds[1].tolist()};"
                " a box with width and height expected"
            )

    @property
    def thickness(self) -> float:
        """Depth of the system behind z = 0 [m]."""
        return max(0.0, -float(self.bounds[0, 2]))

    @property
    def size(self) -> Vector:
        """Width, height and depth of the box [m]."""
        return np.asarray(self.bounds[1] - self.bounds[0])

    def slab(self) -> Float[np.ndarray, "2 3"]:
        """Corners of the box with its faces slightly off the system [m]."""
        off = _CLEARANCE * float(self.size.max())
        return np.asarray(self.bounds + np.outer([-off, off], [0, 0, 1]))


def area_from_dimensions(
    dimensions: Sequence[float], *, periodic: bool = False
) -> SampleArea:
    """Return the box of genBSDF's `-dim xmin xmax ymin ymax zmin zmax`."""
    if len(dimensions) != 6:
        raise InputError(
            f"{len(dimensions)} dimensions; xmin xmax ymin ymax zmin zmax expected"
        )
    return SampleArea(np.reshape(dimensions, (3, 2)).T.astype(float), periodic)


def area_of(scene: Scene, *, periodic: bool = False) -> SampleArea:
    """Return the bounding box of a system."""
    if not scene.surfaces:
        raise InputError(
            "the scene has no surfaces; some, or the dimensions of an empty sample"
            " area, expected"
        )
    return SampleArea(scene.bounds(), periodic)


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
