"""Evaluation of Radiance function files with Dr.Jit arrays.

Expressions are converted to arithmetic while a kernel is traced, in double precision as
in Radiance. Both branches of a condition are computed unless the condition is constant,
so recursion must end by a condition on constants. Undefined values (division by zero,
root of a negative number) are marked as faulty.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.function_library import FUNCTIONS, Value, either_bad, where
from clerestory.engine.upload import on_device
from clerestory.errors import InputError
from clerestory.radiance.cal.evaluation import Evaluation, Frame, Nodes, Rows
from clerestory.radiance.cal.library import START_FILE, Native
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import Definition, Node


@dataclass(eq=False)
class FunctionCode(Evaluation[Value]):
    """Expressions of a function file, evaluated in a kernel.

    The inputs are the variables of the rays, as arrays of doubles; the arguments are
    the real arguments of the primitive.
    """

    deepest: ClassVar[int] = 60
    most_steps: ClassVar[int] = 20_000
    terminating: ClassVar[str] = (
        "a recursion that ends by a condition on constants expected"
    )

    program: Program
    inputs: Mapping[str, Any]
    arguments: tuple[float, ...] = ()
    rays: Rows = field(default_factory=lambda: Rows(np.zeros(1, dtype=int)))

    def value(self, node: Node) -> Value:
        """Return the value of an expression."""
        return self.node(node, self.rays, None)

    def lookup(self, name: str) -> Definition | Native | None:
        """Return the definition of a name; None if it is undefined."""
        found = self.program.definitions.get(name) or START_FILE.get(name)
        return found or FUNCTIONS.get(name)

    def constant(self, number: float, rows: Rows) -> Value:
        """Return a constant as a Python number, not as an array."""
        return Value(number)

    def negative(self, value: Value) -> Value:
        """Return the value with the opposite sign."""
        return Value(-value.value, value.bad)

    def native(self, found: Native, given: Sequence[Value], rows: Rows) -> Value:
        """Return the value of a calculator function that is written in Python."""
        value: Value = found.compute(self, *given)
        return value

    def variable(self, name: str, rows: Rows) -> Value | None:
        """Return the value of a ray variable or real argument; None if unknown."""
        if name == "AC":
            return Value(float(len(self.arguments)))
        if name[0] == "A" and name[1:].isdigit():
            return self.argument(Value(float(name[1:])))
        return Value(self.inputs[name]) if name in self.inputs else None

    def undefined(self, name: str) -> InputError:
        """Return the error to raise for a name that is not defined on surfaces."""
        return InputError(f'"{name}" is not defined for patterns of surfaces')

    def argument(self, which: Value) -> Value:
        """Return real argument number `which`; number 0 is the count of arguments."""
        if isinstance(which.value, float | int):
            place = int(np.floor(which.value + 0.5))
            if place > len(self.arguments):
                raise InputError(
                    f"real argument {place} is used, but the primitive has"
                    f" {len(self.arguments)} real arguments"
                )
            given = (float(len(self.arguments)), *self.arguments)
            return Value(given[max(place, 0)])
        table = on_device(mi.Float64, [len(self.arguments), *self.arguments])
        place = mi.Int32(dr.floor(which.value + 0.5))
        bad = (place < 0) | (place > len(self.arguments))
        index = mi.UInt32(dr.clip(place, 0, len(self.arguments)))
        return Value(dr.gather(mi.Float64, table, index), either_bad(which.bad, bad))

    def combined(self, one: Value, sign: str, other: Value, rows: Rows) -> Value:
        """Return the result of a binary operation: +, -, *, / or ^."""
        bad = either_bad(one.bad, other.bad)
        match sign:
            case "+":
                return Value(one.value + other.value, bad)
            case "-":
                return Value(one.value - other.value, bad)
            case "*":
                return Value(one.value * other.value, bad)
            case "^":
                return _power(one, other, bad)
        zero = other.value == 0
        if isinstance(zero, bool):
            return Value(0.0, True) if zero else Value(one.value / other.value, bad)
        quotient = one.value / dr.select(zero, 1, other.value)
        return Value(dr.select(zero, 0, quotient), either_bad(bad, zero))

    def choice(self, given: Nodes, rows: Rows, frame: Frame | None) -> Value:
        """Evaluate both branches; only one if the condition is constant."""
        condition = self.node(given[0], rows, frame)
        yes = condition.value > 0
        if isinstance(yes, bool):
            one = self.node(given[1 if yes else 2], rows, frame)
            return Value(one.value, either_bad(one.bad, condition.bad))
        one, other = (self.node(branch, rows, frame) for branch in given[1:3])
        return Value(
            where(yes, one.value, other.value),
            either_bad(condition.bad, _either(yes, one.bad, other.bad)),
        )

    def selection(self, given: Nodes, rows: Rows, frame: Frame | None) -> Value:
        """Evaluate all choices of select(); only one if the index is constant."""
        # select(0, …) returns the number of choices
        which = self.node(given[0], rows, frame)
        if isinstance(which.value, float | int):
            number = int(which.value + 0.5)
            if number == 0:
                return Value(float(len(given) - 1), which.bad)
            if not 0 < number < len(given):
                return Value(0.0, True)
            return self.node(given[number], rows, frame)
        number = mi.Int32(dr.floor(which.value + 0.5))
        value = mi.Float64(float(len(given) - 1))
        bad = either_bad(which.bad, (number < 0) | (number >= len(given)))
        for i, choice in enumerate(given[1:], start=1):
            one = self.node(choice, rows, frame)
            value = where(number == i, one.value, value)
            bad = either_bad(bad, _either(number == i, one.bad, False))
        return Value(value, bad)


def _either(condition: Any, yes: Any, no: Any) -> Any:
    if yes is False and no is False:
        return False
    return dr.select(condition, mi.Bool(yes), mi.Bool(no))


def _power(base: Value, exponent: Value, bad: Any) -> Value:
    # Integer exponents accept any base, other exponents only bases of 0 or more
    power = exponent.value
    if isinstance(power, float | int) and isinstance(base.value, float | int):
        made = float(np.power(float(base.value), power))
        return Value(made, bad) if np.isfinite(made) else Value(0.0, True)
    if isinstance(power, float | int) and power == int(power) and 0 < power <= 8:
        value = base.value
        for _ in range(int(power) - 1):
            value = value * base.value
        return Value(value, bad)
    b, p = mi.Float64(base.value), mi.Float64(power)
    whole = dr.floor(p) == p
    wrong = ((b < 0) & ~whole) | ((b == 0) & (p < 0))
    size = dr.power(dr.select(wrong | (b == 0), 1, dr.abs(b)), p)
    odd = whole & (dr.floor(p * 0.5) * 2 != p)
    value = dr.select((b < 0) & odd, -size, size)
    value = dr.select(b == 0, dr.select(p == 0, 1.0, 0.0), value)
    return Value(dr.select(wrong, 0, value), either_bad(bad, wrong))
