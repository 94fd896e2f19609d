"""Materials that shine, as plain values; they reflect nothing.

They shine from their front; the back is black.

Reference: "The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.3.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.scene.material import Source
from clerestory.scene.pattern import Pattern


@dataclass(frozen=True, eq=False)
class Light:
    """A lamp: a surface of known radiance [W/(m²·sr)], shining from its front.

    Attributes
    ----------
    pattern : how the radiance varies; None: not at all
    """

    name: str
    radiance: Float[np.ndarray, "3"]
    source: Source | None = None
    pattern: Pattern | None = None


@dataclass(frozen=True, eq=False)
class Glow:
    """A surface that shines and is no target of shadow rays beyond `radius` [m].

    Attributes
    ----------
    name : key in the scene
    radiance : [W/(m²·sr)]
    radius : reach of the direct light [m]; 0 none, negative: never lights the scene
    pattern : how the radiance varies; None: not at all
    """

    name: str
    radiance: Float[np.ndarray, "3"]
    radius: float = 0.0
    source: Source | None = None
    pattern: Pattern | None = None


@dataclass(frozen=True, eq=False)
class Spotlight:
    """A lamp that shines within a cone only.

    Attributes
    ----------
    radiance : [W/(m²·sr)]
    angle_deg : full angle of the cone
    direction : unit vector of its axis
    length : distance to its apex behind the surface [m]
    pattern : how the radiance varies; None: not at all
    """

    name: str
    radiance: Float[np.ndarray, "3"]
    angle_deg: float
    direction: Float[np.ndarray, "3"]
    length: float
    source: Source | None = None
    pattern: Pattern | None = None
