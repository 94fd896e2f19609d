"""Request and result of BSDF tracing, for matrices and trees."""

from collections.abc import Mapping
from dataclasses import dataclass

from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdfgen.channel_weights import Weights
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.engine.effort import Effort

Functions = dict[tuple[str, Function], ScatteringFunction]


@dataclass(frozen=True, eq=False)
class TraceRequest:
    """Request for the tracing of a BSDF.

    Attributes
    ----------
    area : sample area
    backs : sides of incidence: True for back (room), False for front (outdoors)
    bands : weights of the scene bands for each BSDF channel, by channel name
    colour : whether to add channels CIE X and Z (trees: u' and v')
    effort : sampling effort
    symmetry : whether to trace only one of several mirror-image incident patches
    """

    area: SampleArea
    backs: tuple[bool, ...]
    bands: Mapping[str, Weights]
    colour: bool
    effort: Effort
    symmetry: bool = True


@dataclass(frozen=True, eq=False)
class Traced:
    """Result of tracing a BSDF.

    Attributes
    ----------
    functions : scattering functions with standard errors, by band and name
    paths : number of traced paths
    reached : whether the target error was reached everywhere
    """

    functions: Functions
    paths: int
    reached: bool
