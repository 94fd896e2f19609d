"""Request and result of BSDF tracing, for matrices and trees."""

from dataclasses import dataclass

from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdfgen.shading_system import System
from clerestory.engine.effort import Effort

Functions = dict[tuple[str, Function], ScatteringFunction]


@dataclass(frozen=True, eq=False)
class TraceRequest:
    """Request for the tracing of a BSDF.

    `backs`: sides of incidence, True for the back (room). `colour`: whether to add
    channels CIE X and Z (trees: u' and v'). `symmetry`: whether to trace only one of
    several mirror-image incident patches.
    """

    system: System
    backs: tuple[bool, ...]
    colour: bool
    effort: Effort
    symmetry: bool


@dataclass(frozen=True, eq=False)
class Traced:
    """Scattering functions with standard errors, and the number of traced ray paths.

    `reached`: whether the target error was reached in all tree blocks.
    """

    functions: Functions
    paths: int
    reached: bool
