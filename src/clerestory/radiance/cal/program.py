"""Programs: definitions of a function file together with the predefined functions."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import RayValues
from clerestory.radiance.cal.library import LIBRARY, START_FILE, Native
from clerestory.radiance.cal.run import SPECIAL, Run
from clerestory.radiance.cal.syntax import (
    Call,
    Chain,
    Definition,
    Name,
    Negative,
    Node,
    Number,
    Power,
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
        """Whether an expression has a numeric value, unlike a function name."""
        return not (isinstance(node, Name) and self.arity(node.name) > 0)

    def uses(self, *nodes: Node) -> frozenset[str]:
        """Return the undefined names in expressions and in the definitions they use."""
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

        The inputs are ray variables by name, with at least the scale S; `arguments`
        are the real arguments of the primitive.
        """
        faulty = np.zeros(len(inputs["S"]), dtype=bool)
        run = Run(self.definition, inputs, arguments, faulty)
        return Computed(run.columns(nodes), ~faulty)


@dataclass(frozen=True, eq=False)
class Computed:
    """Values of expressions (columns) for rays, and whether all of them are defined."""

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
