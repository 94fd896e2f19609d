"""Evaluation of function files for many rays at once, for arrays of any library.

At a condition the rays are divided: each branch is evaluated only for the rays that
take it, so that recursion terminates. Arguments and variables are evaluated when first
used, once per set of rays. Nesting depth and number of evaluated nodes are limited.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
from jaxtyping import Bool, Int

from clerestory.errors import InputError
from clerestory.radiance.cal.library import Native
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

# Conditional functions, which evaluate only the selected argument
SPECIAL = ("if", "select")


Value = TypeVar("Value")
Nodes = tuple[Node, ...]


class Rows:
    """Indices of a subset of the rays, with a cache of computed values.

    `place` is the mask that selects the subset of rays from the superset `parent`.
    """

    def __init__(
        self,
        index: Int[np.ndarray, " rays"],
        parent: "Rows | None" = None,
        place: Bool[np.ndarray, " all"] | None = None,
    ) -> None:
        self.index, self.parent, self.place = index, parent, place
        self.known: dict[Hashable, Any] = {}

    def part(self, place: Bool[np.ndarray, " all"]) -> "Rows":
        """Return the rays selected by a mask."""
        return Rows(self.index[place], self, place)

    def find(self, key: Hashable) -> Any:
        """Return a value cached for these rays or a superset; None if not cached."""
        value = self.known.get(key)
        if value is None and self.parent is not None:
            outer = self.parent.find(key)
            if outer is not None:
                value = self.known[key] = outer[self.place]
        return value

    def once(self, key: Hashable, compute: Callable[[], Value]) -> Value:
        """Return the value cached under a key; compute it if it is not cached."""
        value: Value | None = self.find(key)
        if value is None:
            value = self.known[key] = compute()
        return value


@dataclass(frozen=True, eq=False)
class Frame:
    """Arguments of a function call; `outer` is the frame of the caller, if any."""

    parameters: tuple[str, ...]
    arguments: tuple[Node, ...]
    outer: "Frame | None"


class Evaluation(ABC, Generic[Value]):
    """Evaluator of expression trees for many rays, for arrays of any library."""

    deepest: ClassVar[int]
    most_steps: ClassVar[int]
    terminating: ClassVar[str]

    # Current depth of nesting, and number of nodes evaluated so far
    depth: int = 0
    steps: int = 0

    @abstractmethod
    def lookup(self, name: str) -> Definition | Native | None:
        """Return the definition of a name; None if it is undefined."""

    @abstractmethod
    def constant(self, number: float, rows: Rows) -> Value:
        """Return a constant for each ray."""

    @abstractmethod
    def negative(self, value: Value) -> Value:
        """Return the value with the opposite sign."""

    @abstractmethod
    def combined(self, one: Value, sign: str, other: Value, rows: Rows) -> Value:
        """Return the result of an operation: +, -, *, / or ^."""

    @abstractmethod
    def native(self, found: Native, given: Sequence[Value], rows: Rows) -> Value:
        """Return the value of a predefined function or variable."""

    @abstractmethod
    def choice(self, given: Nodes, rows: Rows, frame: Frame | None) -> Value:
        """Return the value of if(condition, yes, no)."""

    @abstractmethod
    def selection(self, given: Nodes, rows: Rows, frame: Frame | None) -> Value:
        """Return the value of select(number, one, two, …)."""

    @abstractmethod
    def variable(self, name: str, rows: Rows) -> Value | None:
        """Return the value of a ray variable or real argument; None if unknown."""

    @abstractmethod
    def undefined(self, name: str) -> InputError:
        """Return the error for a name without a definition."""

    def node(self, node: Node, rows: Rows, frame: Frame | None) -> Value:
        """Evaluate an expression for some rays; `frame` has the function arguments."""
        self.depth, self.steps = self.depth + 1, self.steps + 1
        if self.depth > self.deepest or self.steps > self.most_steps:
            raise self.endless()
        value = self._value(node, rows, frame)
        self.depth -= 1
        return value

    def endless(self) -> InputError:
        """Return the error for a function that may not terminate."""
        return InputError(
            f"the expression needs more than {self.most_steps} evaluation steps or"
            f" {self.deepest} nested calls; {self.terminating}"
        )

    def _value(self, node: Node, rows: Rows, frame: Frame | None) -> Value:
        match node:
            case Number(value):
                return self.constant(value, rows)
            case Name(name):
                return self._named(name, rows, frame)
            case Negative(value):
                return self.negative(self.node(value, rows, frame))
            case Power(base, exponent):
                one = self.node(base, rows, frame)
                other = self.node(exponent, rows, frame)
                return self.combined(one, "^", other, rows)
            case Chain(first, rest):
                total = self.node(first, rows, frame)
                for sign, operand in rest:
                    other = self.node(operand, rows, frame)
                    total = self.combined(total, sign, other, rows)
                return total
            case Call():
                return self._call(node, rows, frame)

    def _named(self, name: str, rows: Rows, frame: Frame | None) -> Value:
        if frame is not None and name in frame.parameters:
            place = frame.parameters.index(name)
            argument = frame.arguments[place]
            return rows.once(
                (frame, place), lambda: self.node(argument, rows, frame.outer)
            )
        found = self.lookup(name)
        if isinstance(found, Definition) and found.parameters is None:
            return rows.once(name, lambda: self.node(found.body, rows, None))
        if isinstance(found, Native) and found.arity is None:
            return rows.once(name, lambda: self.native(found, (), rows))
        value = self.variable(name, rows)
        if value is not None:
            return value
        if found is not None:
            raise InputError(f'function "{name}" needs arguments; {name}(…) expected')
        raise self.undefined(name)

    def _call(self, call: Call, rows: Rows, frame: Frame | None) -> Value:
        name = self._function_name(call.name, frame)
        found = self.lookup(name)
        given = call.arguments
        if isinstance(found, Definition):
            if found.parameters is None or len(given) < len(found.parameters):
                raise _too_few(name, len(given), len(found.parameters or ()))
            return self.node(found.body, rows, Frame(found.parameters, given, frame))
        if isinstance(found, Native):
            if found.arity is None or len(given) < found.arity:
                raise _too_few(name, len(given), found.arity or 0)
            values = [self.node(argument, rows, frame) for argument in given]
            return self.native(found, values, rows)
        if name == "if" and len(given) >= 3:
            return self.choice(given, rows, frame)
        if name == "select" and len(given) >= 2:
            return self.selection(given, rows, frame)
        if name in SPECIAL:
            raise _too_few(name, len(given), 3 if name == "if" else 2)
        raise self.undefined(name)

    def _function_name(self, name: str, frame: Frame | None) -> str:
        # Replaces the name of a parameter by that of its argument
        while frame is not None and name in frame.parameters:
            handed = frame.arguments[frame.parameters.index(name)]
            if not isinstance(handed, Name):
                message = f'"{name}" is called, but its argument is an expression'
                raise InputError(f"{message}; the name of a function expected")
            name, frame = handed.name, frame.outer
        return name


def _too_few(name: str, given: int, expected: int) -> InputError:
    return InputError(
        f'{given} argument(s) of the function "{name}"; {expected} expected'
    )
