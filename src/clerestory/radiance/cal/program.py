"""Function files combined with the predefined functions of Radiance.

`FUNCTION_FILES` replaces the function files of Radiance's library.

References: CIE 22-1973 (clear sky); P. Moon, D. E. Spencer 1942 (overcast sky);
J. Matsuura, T. Iwata 1990 (intermediate sky); R. Perez, R. Seals, J. Michalsky, Solar
Energy 50 (3), 1993. Names, arguments and horizon blend: Radiance's files.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import RayValues
from clerestory.radiance.cal.evaluation import SPECIAL
from clerestory.radiance.cal.library import LIBRARY, START_FILE, Native
from clerestory.radiance.cal.run import Run
from clerestory.radiance.cal.syntax import (
    Call,
    Chain,
    Definition,
    Name,
    Negative,
    Node,
    Number,
    Power,
    parse_definitions,
)


@dataclass(frozen=True, eq=False)
class Program:
    """Definitions of a function file together with the predefined functions.

    >>> from clerestory.radiance.cal.syntax import parse_definitions
    >>> program = Program(parse_definitions("fall(n) = if(n-.5, n*fall(n-1), 1);"))
    >>> [four] = parse_definitions("x = fall(4);").values()
    >>> program.values((four.body,), {"S": np.ones(1)}).value.tolist()
    [[24.0]]
    """

    definitions: Mapping[str, Definition] = field(default_factory=dict)

    def definition(self, name: str) -> Definition | Native | None:
        """Return the definition of a name; None if it is undefined."""
        for names in (self.definitions, START_FILE, LIBRARY):
            if name in names:
                return names[name]
        return None

    def arity(self, name: str) -> int:
        """Return the number of arguments of a function; 0 for variables."""
        found = self.definition(name)
        if isinstance(found, Definition):
            return len(found.parameters or ())
        return 0 if found is None else found.arity or 0

    def is_value(self, node: Node) -> bool:
        """Whether an expression is numeric, not the name of a function."""
        return not (isinstance(node, Name) and self.arity(node.name) > 0)

    def uses(self, *nodes: Node) -> frozenset[str]:
        """Return the undefined names, such as ray variables, that expressions use."""
        open_names, seen = set().union(*(_names(node) for node in nodes)), set()
        missing = set()
        while open_names:
            name = open_names.pop()
            seen.add(name)
            found = self.definition(name)
            if isinstance(found, Definition):
                inner = _names(found.body) - set(found.parameters or ())
            elif isinstance(found, Native):
                inner = set(found.uses)
            else:
                inner = set()
                missing |= set() if name in SPECIAL else {name}
            open_names |= inner - seen
        return frozenset(missing)

    def values(
        self,
        nodes: tuple[Node, ...],
        inputs: Mapping[str, RayValues],
        arguments: tuple[float, ...] = (),
    ) -> "Computed":
        """Return the values of expressions for each ray.

        `inputs` are the values of the ray variables by name, at least the scale S;
        `arguments` are the real arguments of the primitive.
        """
        faulty = np.zeros(len(inputs["S"]), dtype=bool)
        run = Run(self.definition, inputs, arguments, faulty)
        return Computed(run.columns(nodes), ~faulty)


@dataclass(frozen=True, eq=False)
class Computed:
    """Values of expressions per ray, and whether all values of a ray are defined."""

    value: Float[np.ndarray, "rays expressions"]
    valid: Bool[np.ndarray, " rays"]


def _names(node: Node) -> set[str]:
    # Names that occur in an expression tree
    found, left = set(), [node]
    while left:
        match left.pop():
            case Name(name):
                found.add(name)
            case Call(name, arguments):
                found.add(name)
                left += arguments
            case Negative(value):
                left.append(value)
            case Chain(first, rest):
                left += [first, *(operand for _, operand in rest)]
            case Power(base, exponent):
                left += [base, exponent]
            case Number():
                pass
    return found


# Skies of gensky: A1 type, A2 zenith radiance, A3 ground radiance, A4 relative zenith
# radiance, A5 to A7 direction to the sun. At the horizon, sky and ground radiance are
# blended with the weights (z + 1.01)^10 and (z + 1.01)^-10.
_SKYBRIGHT = """
blend : (Dz + 1.01)^20;
skybr : (blend*select(A1, clear, A2*(1 + 2*Dz)/3, A2, between) + A3)/(blend + 1);
cosine : Dx*A5 + Dy*A6 + Dz*A7; gamma : Acos(cosine);
clear : A2/A4*(.91 + 10*exp(-3*gamma) + .45*cosine*cosine)*(1 - exp(-.32/max(Dz, .01)));
eta : Acos(Dz); zeta : Acos(A7);
between : A2*((1.35*sin(5.631 - 3.59*eta) + 3.12)*sin(4.396 - 2.6*zeta) + 6.37 - eta)
    /2.326*exp(gamma*-.563*((2.629 - eta)*(1.562 - zeta) + .812))/A4;
"""

# Sky of gendaylit: A1 scale, A2 ground radiance, A3 to A7 Perez's parameters a to e, A8
# to A10 direction to the sun. The gradation is constant where sin(elevation) < 0.01.
_PEREZLUM = """
blend : (Dz + 1.01)^20;
skybright : (blend*A1*gradation*indicatrix + A2)/(blend + 1);
cosine : Dx*A8 + Dy*A9 + Dz*A10;
gradation : 1 + A3*exp(max(A4/max(Dz, .01), -700));
indicatrix : 1 + A5*exp(A6*Acos(cosine)) + A7*cosine*cosine;
"""

# Luminaires: photometric angles [deg] of the emission direction -D (theta from the
# nadir, phi from +x towards +y; phi is folded for symmetric luminaires), and radiance
# as intensity per projected area of a flat, box-shaped or cylindrical luminaire
_SOURCE = """
src_theta : Acos(Dz)/DEGREE; src_phi : mod(atan2(-Dy, -Dx)/DEGREE, 360);
fold(period) : period - abs(mod(src_phi, 2*period) - period);
src_phi2 : fold(180); src_phi4 : fold(90);
srcB_vert : atan2(-Dx, Dz)/DEGREE; srcB_vert2 : abs(srcB_vert);
srcB_horiz : atan2(Dy, Dz)/DEGREE; srcB_horiz2 : abs(srcB_horiz);
corr(v) : if(AC - .5, A1*v, v); flatcorr(v) : corr(v)/Rdot;
boxcorr(v) : A1*v/(abs(Dx)*A3*A4 + abs(Dy)*A2*A4 + abs(Dz)*A2*A3);
cylcorr(v) : A1*v/(A2*A3*Sqrt(1 - Dz*Dz) + PI/4*A2*A2*abs(Dz));
"""

# Normal perturbation of a gensurf patch, bilinear in two coordinates; A1 is the third
_SURF = """
u = select(A1 + 1, Py, Pz, Px); v = select(A1 + 1, Pz, Px, Py);
bent(i) = u*v*arg(i) + u*arg(i + 3) + v*arg(i + 6) + arg(i + 9);
surf_dx = bent(2); surf_dy = bent(3); surf_dz = bent(4);
"""

# Normal of a surface of revolution: A3 r + A4 radially, A1 z + A2 along the axis
_REV = """
r = sqrt(Px*Px + Py*Py); outwards = A3*r + A4;
rev_dx = outwards*Px/r; rev_dy = outwards*Py/r; rev_dz = A1*Pz + A2;
"""

# Triangle normal: each component is linear in two coordinates; A1 is the third axis
_TMESH = """
p = select(A1 + 1, Py, Pz, Px); q = select(A1 + 1, Pz, Px, Py);
along(i) = p*arg(i) + q*arg(i + 1) + arg(i + 2);
v1 = along(2); v2 = along(5); v3 = along(8);
size = sqrt(v1*v1 + v2*v2 + v3*v3);
dx = v1/size - Nx; dy = v2/size - Ny; dz = v3/size - Nz;
u = frac(v1); v = frac(v2);
"""

FUNCTION_FILES: Mapping[str, Mapping[str, Definition]] = {
    "skybright.cal": parse_definitions(_SKYBRIGHT),
    "perezlum.cal": parse_definitions(_PEREZLUM),
    "source.cal": parse_definitions(_SOURCE),
    "surf.cal": parse_definitions(_SURF),
    "rev.cal": parse_definitions(_REV),
    "tmesh.cal": parse_definitions(_TMESH),
}
