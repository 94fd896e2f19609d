"""Evaluation of function files with NumPy arrays."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Bool, Float

from clerestory.errors import InputError
from clerestory.radiance.cal.evaluation import Evaluation, Frame, Nodes, Rows
from clerestory.radiance.cal.library import Native, Values, divide, power
from clerestory.radiance.cal.syntax import Definition, Name


@dataclass(eq=False)
class _Env:
    # Ray variables and real arguments for predefined functions
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
class Run(Evaluation[Values]):
    """Evaluator of expressions for NumPy arrays of rays.

    Attributes
    ----------
    definition : function that returns the definition of a name
    inputs : values of the ray variables by name; at least the scale S
    arguments : real arguments of the primitive
    faulty : for each ray, whether an expression is undefined
    """

    deepest: ClassVar[int] = 100
    most_steps: ClassVar[int] = 100_000
    terminating: ClassVar[str] = "a recursion that terminates expected"

    definition: Callable[[str], Definition | Native | None]
    inputs: Mapping[str, Float[np.ndarray, " rays"]]
    arguments: tuple[float, ...]
    faulty: Bool[np.ndarray, " rays"]

    def columns(self, nodes: Nodes) -> Float[np.ndarray, "rays expressions"]:
        """Evaluate expressions for all rays."""
        rows = Rows(np.arange(len(self.faulty)))
        try:
            with np.errstate(all="ignore"):
                return np.stack([self.node(n, rows, None) for n in nodes], axis=1)
        except RecursionError:
            raise self.endless() from None

    def lookup(self, name: str) -> Definition | Native | None:
        return self.definition(name)

    def constant(self, number: float, rows: Rows) -> Values:
        return np.full(len(rows.index), number)

    def negative(self, value: Values) -> Values:
        return -value

    def combined(self, one: Values, sign: str, other: Values, rows: Rows) -> Values:
        match sign:
            case "+":
                value: Values = one + other
            case "-":
                value = one - other
            case "*":
                value = one * other
            case "/":
                value = divide(_Env(self, rows), one, other)
            case _:
                value = power(_Env(self, rows), one, other)
        return value

    def native(self, found: Native, given: Sequence[Values], rows: Rows) -> Values:
        value: Values = found.compute(_Env(self, rows), *given)
        return value

    def variable(self, name: str, rows: Rows) -> Values | None:
        """Return the values of a ray variable; None if unknown."""
        given = self.inputs.get(name)
        return None if given is None else np.asarray(given[rows.index])

    def undefined(self, name: str) -> InputError:
        return InputError(f'"{name}" is not defined')

    def choice(self, given: Nodes, rows: Rows, frame: Frame | None) -> Values:
        """Evaluate if(…): each branch for the rays that take it."""
        yes = self.node(given[0], rows, frame) > 0
        if yes.all():
            return self.node(given[1], rows, frame)
        if not yes.any():
            return self.node(given[2], rows, frame)
        value = np.empty(len(yes))
        for place, branch in ((yes, given[1]), (~yes, given[2])):
            value[place] = self.node(branch, rows.part(place), frame)
        return value

    def selection(self, given: Nodes, rows: Rows, frame: Frame | None) -> Values:
        """Evaluate select(…): each argument only for the rays that select it."""
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
