"""What is asked of a trace, and what comes back, be it matrices or trees."""

from collections.abc import Mapping
from dataclasses import dataclass

from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdfgen.area import SampleArea
from clerestory.bsdfgen.channel_weights import Weights
from clerestory.engine.effort import Effort

Functions = dict[tuple[str, Function], ScatteringFunction]


@dataclass(frozen=True, eq=False)
class TraceRequest:
    """What is asked for.

    Attributes
    ----------
    area : the piece of the system
    backs : for each side that light comes from, whether it is that of the room
    bands : of the result, with weights of the three channels
    colour : whether to add colour to them
    effort : how long to trace
    symmetry : whether light is traced from one of two directions that are alike
    """

    area: SampleArea
    backs: tuple[bool, ...]
    bands: Mapping[str, Weights]
    colour: bool
    effort: Effort
    symmetry: bool = True


@dataclass(frozen=True, eq=False)
class Traced:
    """What was traced.

    Attributes
    ----------
    functions : by band and function, with their standard errors
    paths : traced in all
    reached : whether the relative error aimed at was reached everywhere
    """

    functions: Functions
    paths: int
    reached: bool
