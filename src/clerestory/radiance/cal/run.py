"""Evaluation of function files for many rays at once.

At conditions the rays are divided: each branch is evaluated only for the rays that take
it, so that recursion terminates. Arguments and variables are evaluated lazily, once per
set of rays. The depth of nesting and the number of evaluated nodes are limited.
"""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.errors import InputError
from clerestory.radiance.cal.library import Native, Values, divide, power
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

# Maximum depth of nested expressions and calls
_DEEPEST = 100

# Maximum number of nodes evaluated in one run
MOST_STEPS = 100_000

# Functions of which only the selected argument is evaluated
SPECIAL = ("if", "select")


class Rows:
    """A subset of the rays, with a cache of values.

    Attributes
    ----------
    index : indices among all rays
    parent, place : superset from which the rays were selected, and selection mask
    known : cached values by key
    """

    def __init__(
        self,
        index: Int[np.ndarray, " rays"],
        parent: "Rows | None" = None,
        place: Bool[np.ndarray, " all"] | None = None,
    ) -> None:
        self.index, self.parent, self.place = index, parent, place
        self.known: dict[Hashable, Values] = {}

    def part(self, place: Bool[np.ndarray, " all"]) -> "Rows":
        """Return a subset of these rays."""
        return Rows(self.index[place], self, place)

    def find(self, key: Hashable) -> Values | None:
        """Return the value cached for these rays or a superset; None if not cached."""
        value = self.known.get(key)
        if value is None and self.parent is not None:
            outer = self.parent.find(key)
            if outer is not None:
                value = self.known[key] = outer[self.place]
        return value

    def once(self, key: Hashable, compute: Callable[[], Values]) -> Values:
        """Return the cached value; compute it first if necessary."""
        value = self.find(key)
        if value is None:
            value = self.known[key] = compute()
        return value


@dataclass(frozen=True, eq=False)
class Frame:
    """Arguments of a function call.

    Attributes
    ----------
    parameters : names of the parameters
    arguments : expressions of the arguments
    outer : frame in which the arguments are evaluated; None outside functions
    """

    parameters: tuple[str, ...]
    arguments: tuple[Node, ...]
    outer: "Frame | None"


@dataclass(eq=False)
class _Env:
    # The evaluation context of native functions
    run: "Run"
    rows: Rows

    @property
    def arguments(self) -> tuple[float, ...]:
        return self.run.arguments

    def value(self, name: str) -> Values:
        return self.run.node(Name(name), self.rows, None)

    def fault(self, where: Bool[np.ndarray, " rays"]) -> None:
        self.run.faulty[self.rows.index[where]] = True


@dataclass(eq=False)
class Run:
    """One evaluation of expressions.

    Attributes
    ----------
    definition : function that returns the definition of a name
    inputs : values of the ray variables by name; at least the scale S
    arguments : real arguments of the primitive
    faulty : whether the ray is invalid
    depth, steps : current depth of nesting; number of nodes evaluated so far
    """

    definition: Callable[[str], Definition | Native | None]
    inputs: Mapping[str, Float[np.ndarray, " rays"]]
    arguments: tuple[float, ...]
    faulty: Bool[np.ndarray, " rays"]
    depth: int = 0
    steps: int = 0

    def columns(self, nodes: tuple[Node, ...]) -> Float[np.ndarray, "rays expressions"]:
        """Evaluate expressions for all rays."""
        rows = Rows(np.arange(len(self.faulty)))
        try:
            with np.errstate(all="ignore"):
                return np.stack([self.node(n, rows, None) for n in nodes], axis=1)
        except RecursionError:
            raise _too_deep() from None

    def node(self, node: Node, rows: Rows, frame: Frame | None) -> Values:
        """Evaluate an expression for some rays, with the arguments of a call if any."""
        self.depth, self.steps = self.depth + 1, self.steps + 1
        if self.depth > _DEEPEST:
            raise _too_deep()
        if self.steps > MOST_STEPS:
            raise InputError(
                f"the function takes more than {MOST_STEPS} steps; does it terminate?"
            )
        value = self._value(node, rows, frame)
        self.depth -= 1
        return value

    def _value(self, node: Node, rows: Rows, frame: Frame | None) -> Values:
        match node:
            case Number(value):
                return np.full(len(rows.index), value)
            case Name(name):
                return self._variable(name, rows, frame)
            case Negative(value):
                return -self.node(value, rows, frame)
            case Power(base, exponent):
                return power(
                    _Env(self, rows),
                    self.node(base, rows, frame),
                    self.node(exponent, rows, frame),
                )
            case Chain(first, rest):
                total = self.node(first, rows, frame)
                for sign, operand in rest:
                    total = self._combined(
                        total, sign, self.node(operand, rows, frame), rows
                    )
                return total
            case Call():
                return self._call(node, rows, frame)

    def _combined(self, one: Values, sign: str, other: Values, rows: Rows) -> Values:
        match sign:
            case "+":
                value: Values = one + other
            case "-":
                value = one - other
            case "*":
                value = one * other
            case _:
                value = divide(_Env(self, rows), one, other)
        return value

    def _variable(self, name: str, rows: Rows, frame: Frame | None) -> Values:
        if frame is not None and name in frame.parameters:
            place = frame.parameters.index(name)
            argument = frame.arguments[place]
            return rows.once(
                (frame, place), lambda: self.node(argument, rows, frame.outer)
            )
        found = self.definition(name)
        if isinstance(found, Definition) and found.parameters is None:
            return rows.once(name, lambda: self.node(found.body, rows, None))
        if isinstance(found, Native) and found.arity is None:
            return rows.once(name, lambda: found.compute(_Env(self, rows)))
        if name in self.inputs:
            return np.asarray(self.inputs[name][rows.index])
        if found is not None:
            raise InputError(f'the function "{name}" has no arguments')
        raise InputError(f'"{name}" is not defined')

    def _call(self, call: Call, rows: Rows, frame: Frame | None) -> Values:
        name = self._function_name(call.name, frame)
        found = self.definition(name)
        given = call.arguments
        if isinstance(found, Definition):
            if found.parameters is None or len(given) < len(found.parameters):
                raise _too_few(name, len(given), len(found.parameters or ()))
            return self.node(found.body, rows, Frame(found.parameters, given, frame))
        if isinstance(found, Native):
            if found.arity is None or len(given) < found.arity:
                raise _too_few(name, len(given), found.arity or 0)
            values = [self.node(argument, rows, frame) for argument in given]
            result: Values = found.compute(_Env(self, rows), *values)
            return result
        if name == "if" and len(given) >= 3:
            return self._choice(
                self.node(given[0], rows, frame) > 0, given[1:3], rows, frame
            )
        if name == "select" and len(given) >= 2:
            return self._selection(given, rows, frame)
        if name in SPECIAL:
            raise _too_few(name, len(given), 3 if name == "if" else 2)
        raise InputError(f'the function "{name}" is not defined')

    def _function_name(self, name: str, frame: Frame | None) -> str:
        # Name of the function passed as an argument
        while frame is not None and name in frame.parameters:
            handed = frame.arguments[frame.parameters.index(name)]
            if not isinstance(handed, Name):
                raise InputError(f'"{name}" is called, but its argument is no function')
            name, frame = handed.name, frame.outer
        return name

    def _choice(
        self,
        yes: Bool[np.ndarray, " rays"],
        branches: tuple[Node, ...],
        rows: Rows,
        frame: Frame | None,
    ) -> Values:
        if yes.all():
            return self.node(branches[0], rows, frame)
        if not yes.any():
            return self.node(branches[1], rows, frame)
        value = np.empty(len(yes))
        for place, branch in ((yes, branches[0]), (~yes, branches[1])):
            value[place] = self.node(branch, rows.part(place), frame)
        return value

    def _selection(
        self, given: tuple[Node, ...], rows: Rows, frame: Frame | None
    ) -> Values:
        # select(0, …) returns the number of choices
        which = self.node(given[0], rows, frame)
        number = np.trunc(np.where(which < -0.5, -1.0, which + 0.5))
        value = np.where(number == 0, float(len(given) - 1), 0.0)
        _Env(self, rows).fault((number < 0) | (number >= len(given)))
        for i, choice in enumerate(given[1:], start=1):
            place = number == i
            if place.all():
                return self.node(choice, rows, frame)
            if place.any():
                value[place] = self.node(choice, rows.part(place), frame)
        return value


def _too_deep() -> InputError:
    return InputError(
        f"calls are nested more than {_DEEPEST} deep; does the recursion terminate?"
    )


def _too_few(name: str, given: int, expected: int) -> InputError:
    return InputError(
        f'{given} argument(s) of the function "{name}"; {expected} expected'
    )
