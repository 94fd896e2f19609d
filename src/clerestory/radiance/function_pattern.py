"""Patterns and textures of function or data files (brightfunc, colordata, texfunc …).

Ray variables are Radiance's, in function coordinates; the transform after the function
file converts these to scene coordinates. D points from the viewer to the surface.
"""

import warnings
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clerestory.array_types import RayVectors, Vector
from clerestory.brief_repr import brief
from clerestory.errors import ClerestoryWarning
from clerestory.radiance.cal.program import Computed, Program
from clerestory.radiance.cal.syntax import Call, Name, Node
from clerestory.radiance.data_array import DataArray
from clerestory.scene.material import Source
from clerestory.scene.pattern import Pattern, Product
from clerestory.scene.transform import Transform

_DIRECTION = {f"D{a}" for a in "xyz"}
_NORMAL = {f"N{a}" for a in "xyz"} | {f"N{a}P" for a in "xyz"} | {"Rdot", "RdotP"}
_POINT = {f"P{a}" for a in "xyz"}
_FRAME = {"S"} | {f"{k}{a}" for k in "TIJK" for a in "xyz"}

# Names of the values interpolated in the data tables
READINGS = ("$101", "$102", "$103")

# Ray variables available to patterns, in the order of Radiance's numbers $1, $2, …
_CHANNELS = (
    *("Dx", "Dy", "Dz", "Nx", "Ny", "Nz", "Px", "Py", "Pz", "T", "Rdot", "S"),
    *("Tx", "Ty", "Tz", "Ix", "Iy", "Iz", "Jx", "Jy", "Jz", "Kx", "Ky", "Kz"),
)
NUMBERED = {f"${i}": name for i, name in enumerate(_CHANNELS, start=1) if name != "T"}
KNOWN = frozenset(_DIRECTION | _NORMAL | _POINT | _FRAME | set(NUMBERED))


@dataclass(frozen=True, eq=False)
class FunctionPattern:
    """A pattern or texture of Radiance: expressions, or functions of table values.

    The expressions of brightfunc, colorfunc and texfunc directly give the values.
    In brightdata, colordata and texdata, each table is interpolated at
    `coordinates`, and each expression names a function of the interpolated values.
    There is one expression for all channels, or one per channel, and one table per
    expression. `transform` converts function coordinates to scene coordinates.
    """

    program: Program
    expressions: tuple[Node, ...]
    arguments: tuple[float, ...] = ()
    transform: Transform = field(default_factory=Transform)
    source: Source | None = None
    tables: tuple[DataArray, ...] = ()
    coordinates: tuple[Node, ...] = ()

    __repr__ = brief

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of the ray variables used in expressions and coordinates."""
        used = self.program.uses(*self.coordinates, *self.expressions)
        return frozenset(NUMBERED.get(name, name) for name in used)

    @property
    def grey(self) -> bool:
        """Whether one expression is used for all bands."""
        return len(self.expressions) == 1

    @property
    def needs_normal(self) -> bool:
        """Whether the expressions depend on the surface normal."""
        return bool(self.names & _NORMAL)

    @property
    def needs_point(self) -> bool:
        """Whether the expressions depend on the surface point."""
        return bool(self.names & _POINT)

    def value(
        self,
        direction: RayVectors,
        normal: RayVectors | None = None,
        point: RayVectors | None = None,
    ) -> RayVectors:
        """Return the multiplier of radiance, 1 where an expression is undefined."""
        computed = self.computed(_inputs(self.transform, direction, normal, point))
        return _multipliers(computed, self.source)

    def computed(self, inputs: dict[str, np.ndarray]) -> Computed:
        """Return the values of the expressions for each ray; see `Computed`."""
        if not self.tables:
            return self.program.values(self.expressions, inputs, self.arguments)
        position = self.program.values(self.coordinates, inputs, self.arguments)
        readings = [table.value(position.value) for table in self.tables]
        inputs = inputs | dict(zip(READINGS, readings, strict=False))
        found = self.program.values(self.calls(), inputs, self.arguments)
        return Computed(found.value, position.valid & found.valid)

    def calls(self) -> tuple[Node, ...]:
        """Return the expressions as function calls on the interpolated table values.

        A function of three arguments receives the values of all tables; any other
        function receives the value of the table with the same index.
        """
        readings = tuple(Name(name) for name in READINGS[: len(self.tables)])
        names = [node.name for node in self.expressions if isinstance(node, Name)]
        return tuple(
            Call(name, readings if self.program.arity(name) >= 3 else (reading,))
            for name, reading in zip(names, readings, strict=True)
        )


def constant_value(pattern: Pattern) -> Vector | None:
    """Return the value of a constant pattern; None if the pattern varies."""
    match pattern:
        case FunctionPattern() if not pattern.names - _FRAME:
            along = np.array([[0.0, 0.0, 1.0]])
            return np.asarray(pattern.value(along, along, np.zeros((1, 3)))[0])
        case Product(factors):
            values = [constant_value(factor) for factor in factors]
            known = [value for value in values if value is not None]
            return np.prod(known, axis=0) if len(known) == len(values) else None
        case _:
            return None


def constant_vector(pattern: FunctionPattern) -> Vector | None:
    """Return three constant expressions as a vector in scene coordinates.

    Returns None if the expressions vary or are undefined.
    """
    if pattern.names - _FRAME:
        return None
    along = np.array([[0.0, 0.0, 1.0]])
    inputs = _inputs(pattern.transform, along, along, np.zeros((1, 3)))
    made = pattern.program.values(pattern.expressions, inputs, pattern.arguments)
    if not made.valid[0]:
        return None
    vector: np.ndarray = pattern.transform.vectors(made.value[0])
    return vector / pattern.transform.scale


def _inputs(
    transform: Transform,
    direction: RayVectors,
    normal: RayVectors | None,
    point: RayVectors | None,
) -> dict[str, np.ndarray]:
    # Radiance's ray variables in function coordinates
    count = len(direction)
    back = np.linalg.inv(transform.matrix)
    scale = 1 / transform.scale
    sight = direction if point is None else -direction
    facing = -sight if normal is None else normal
    vectors = {
        "D": sight @ back[:3, :3] / scale,
        "N": facing @ back[:3, :3] / scale,
        "P": np.zeros((count, 3))
        if point is None
        else point @ back[:3, :3] + back[3, :3],
    }
    rows = {"I": back[0] / scale, "J": back[1] / scale, "K": back[2] / scale}
    for name, row in (rows | {"T": back[3]}).items():
        vectors[name] = np.broadcast_to(row[:3], (count, 3))
    given = {k + a: v[:, i] for k, v in vectors.items() for i, a in enumerate("xyz")}
    given |= {f"N{a}P": given[f"N{a}"] for a in "xyz"}
    rdot = np.clip(-np.einsum("rx,rx->r", sight, facing), -1, 1)
    given |= {"Rdot": rdot, "RdotP": rdot, "S": np.full(count, scale)}
    return given | {number: given[name] for number, name in NUMBERED.items()}


def _multipliers(computed: Computed, source: Source | None) -> RayVectors:
    # Where an expression is undefined, the multiplier is 1, as in Radiance
    bad = int(np.count_nonzero(~computed.valid))
    if bad:
        place = "" if source is None else f"{source.file}:{source.line}: "
        warnings.warn(
            f"{place}the pattern has no value for {bad} of {len(computed.valid)}"
            " directions (division by zero or similar); it is ignored there, as in"
            " Radiance",
            ClerestoryWarning,
            stacklevel=3,
        )
    value = np.where(computed.valid[:, None], computed.value, 1.0)
    colour = np.broadcast_to(value, (len(value), 3)) if value.shape[1] == 1 else value
    return np.asarray(np.maximum(colour, 0.0))
