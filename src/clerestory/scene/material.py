"""Materials that reflect, transmit or refract by a formula, as plain values.

A material has its key in the scene as `name`, and the line of the file it comes from
as `source`.

Colours are RGB. Roughness is the rms slope of the facets; 0 makes a highlight a
mirror image. Materials act alike on either side unless their page says otherwise.

References: G. Ward, "Measuring and modeling anisotropic reflection", SIGGRAPH 1992;
"The RADIANCE 6.0 Synthetic Imaging System" (ray.html), section 2.1.3.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.scene.pattern import Pattern


@dataclass(frozen=True)
class Source:
    """Where an item stands: file and line."""

    file: str
    line: int


@dataclass(frozen=True, eq=False)
class Plastic:
    """Radiance's plastic: a diffuse colour under an uncoloured Gaussian highlight.

    Attributes
    ----------
    name : key in the scene
    reflectance : diffuse reflectance before the highlight takes its share
    specularity : share reflected by the highlight, 0…1
    roughness : rms slope of the facets; 0 is a mirror-like coat
    """

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float = 0.0
    roughness: float = 0.0
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Metal:
    """Radiance's metal: as plastic, with a highlight of the metal's own colour."""

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float = 0.0
    roughness: float = 0.0
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Trans:
    """Radiance's trans: a translucent sheet.

    Attributes
    ----------
    reflectance : colour of all that is not the highlight, reflected or transmitted
    specularity : share reflected by the uncoloured highlight
    roughness : of the reflected and of the transmitted highlight
    transmission : share of the rest that is transmitted
    transmitted_specular : share of the transmitted light that is not diffused
    """

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float = 0.0
    roughness: float = 0.0
    transmission: float = 0.0
    transmitted_specular: float = 0.0
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Plastic2:
    """Plastic with an elliptical highlight.

    Attributes
    ----------
    roughness : rms slope along `up` laid into the surface, and across it
    up : vector in the scene's coordinates, or expressions for it in those of a
        function; where it is along the normal the highlight is round
    """

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float
    roughness: Float[np.ndarray, "2"]
    up: Float[np.ndarray, "3"] | Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Metal2:
    """Metal with an elliptical highlight; see `Plastic2`."""

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float
    roughness: Float[np.ndarray, "2"]
    up: Float[np.ndarray, "3"] | Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Trans2:
    """Trans with elliptical highlights; see `Trans` and `Plastic2`."""

    name: str
    reflectance: Float[np.ndarray, "3"]
    specularity: float
    roughness: Float[np.ndarray, "2"]
    transmission: float
    transmitted_specular: float
    up: Float[np.ndarray, "3"] | Pattern
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Glass:
    """Radiance's glass: one thin pane, given by what passes on one crossing.

    Attributes
    ----------
    name : key in the scene
    transmissivity : share left after one passage at normal incidence, surfaces excluded
    index : index of refraction
    """

    name: str
    transmissivity: Float[np.ndarray, "3"]
    index: float = 1.52
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Dielectric:
    """A solid that refracts; its surface has the inside behind its front.

    Attributes
    ----------
    transmissivity : share left after 1 m inside
    index : index of refraction at the wavelength of 500 nm
    """

    name: str
    transmissivity: Float[np.ndarray, "3"]
    index: float
    source: Source | None = None


@dataclass(frozen=True, eq=False)
class Interface:
    """The surface between two dielectrics; the inside lies behind its front.

    Attributes
    ----------
    inside_transmissivity, outside_transmissivity : share left after 1 m
    inside_index, outside_index : indices of refraction
    """

    name: str
    inside_transmissivity: Float[np.ndarray, "3"]
    inside_index: float
    outside_transmissivity: Float[np.ndarray, "3"]
    outside_index: float
    source: Source | None = None
