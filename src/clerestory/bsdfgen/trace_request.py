"""Request and result of tracing a BSDF, for matrices and trees."""

from collections.abc import Mapping
from dataclasses import dataclass

from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdfgen.channel_weights import Weights
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.engine.effort import Effort

Functions = dict[tuple[str, Function], ScatteringFunction]


@dataclass(frozen=True, eq=False)
class TraceRequest:
    """Request of tracing a BSDF.

    Attributes
    ----------
    area : sample area
    backs : for each incident side, whether it is that of the room
    bands : of the result, with weights of the bands of the scene
    colour : whether to add colour
    effort : sampling effort
    symmetry : whether only one of two mirror-symmetric patches is traced
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
    functions : by band and function, with their standard errors
    paths : number of traced paths
    reached : whether the target error was reached everywhere
    """

    functions: Functions
    paths: int
    reached: bool
