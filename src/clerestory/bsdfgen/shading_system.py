"""Geometry of shading systems and the sample area through which rays are traced.

Coordinates are as in genBSDF: +x along the width, +y up, +z into the room; the system
is at z ≤ 0.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.bands import Bands
from clerestory.brief_repr import brief
from clerestory.bsdf.product_data import Product
from clerestory.bsdfgen.channel_weights import VISIBLE, Weights, default_weights
from clerestory.checks import require
from clerestory.scene.band_conversion import in_bands
from clerestory.scene.model import Scene
from clerestory.spectra import Spectrum

# Distance between box faces and system, relative to the size of the system.
_CLEARANCE = 1e-5


@dataclass(frozen=True, eq=False)
class SampleArea:
    """A box around a shading system; rays enter and leave through its z faces.

    The bounds are the lower and the upper corner [m]. A periodic box is the unit cell
    of an infinite system: rays that leave through a side re-enter through the opposite
    side.
    """

    bounds: Float[np.ndarray, "2 3"]
    periodic: bool = False

    __repr__ = brief

    def __post_init__(self) -> None:
        bounds = np.asarray(self.bounds, dtype=float)
        object.__setattr__(self, "bounds", bounds)
        size = bounds[1] - bounds[0]
        require(
            np.all(np.isfinite(bounds)) and (size[:2] > 0).all() and size[2] >= 0,
            f"sample area from {bounds[0].tolist()} to {bounds[1].tolist()};"
            " a box with positive width and height expected",
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
        """Corners [m] of the box, with z faces slightly away from the system."""
        off = _CLEARANCE * float(self.size.max())
        return np.asarray(self.bounds + np.outer([-off, off], [0, 0, 1]))


def area_from_dimensions(
    dimensions: Sequence[float], *, periodic: bool = False
) -> SampleArea:
    """Return the box from genBSDF's option `-dim xmin xmax ymin ymax zmin zmax`."""
    numbers = f"{len(dimensions)} dimensions"
    require(len(dimensions) == 6, f"{numbers}; xmin xmax ymin ymax zmin zmax expected")
    return SampleArea(np.reshape(dimensions, (3, 2)).T.astype(float), periodic)


def area_of(scene: Scene, *, periodic: bool = False) -> SampleArea:
    """Return the bounding box of a system as sample area."""
    require(
        scene.surfaces,
        "the scene has no surfaces; surfaces, or the dimensions of the sample area,"
        " expected",
    )
    return SampleArea(scene.bounds(), periodic)


def unit_cell(width: float, height: float, depth: float) -> SampleArea:
    """Return a periodic box at z ≤ 0, with one corner at the origin."""
    return SampleArea(np.array([[0, 0, -depth], [width, height, 0]]), periodic=True)


@dataclass(frozen=True, eq=False)
class System:
    """Shading system, the input of BSDF generation, in coordinates of genBSDF [m].

    `bands` has the weights of the scene bands for each BSDF channel, by channel name.
    """

    scene: Scene
    area: SampleArea
    bands: Mapping[str, Weights] = field(default_factory=lambda: dict(VISIBLE))
    product: Product = field(default_factory=Product)

    __repr__ = brief


def system_in_bands(
    system: System, bands: Bands, *, spectra: Mapping[str, Spectrum]
) -> System:
    """Return a system in other spectral bands, each a channel of its BSDF.

    Parameters
    ----------
    spectra : spectra of materials by name; other materials must be grey

    Raises
    ------
    InputError : the system has channels other than "visible", or cannot be converted
        (`in_bands`)
    """
    require(
        dict(system.bands) == dict(VISIBLE),
        f"the system has the channels {', '.join(system.bands)}; only visible expected"
        " for a BSDF in spectral bands",
    )
    scene = in_bands(system.scene, bands, spectra=spectra)
    return replace(system, scene=scene, bands=default_weights(bands))
