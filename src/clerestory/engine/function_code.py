"""Evaluation of Radiance function files with Dr.Jit arrays.

Expressions are converted to arithmetic while a kernel is traced, in double precision as
in Radiance. Both branches of a condition are computed unless the condition is constant,
so recursion must end by a condition on constants. Undefined values (division by zero,
root of a negative number) are marked as faulty.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.function_library import FUNCTIONS, Value, either_bad, where
from clerestory.errors import InputError
from clerestory.radiance.cal.library import START_FILE
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.run import Frame
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

# Largest depth of calls, and number of nodes of an expression with all its calls
_DEEPEST = 60
_MOST_NODES = 20_000


@dataclass(eq=False)
class FunctionCode:
    """Expressions of a function file, evaluated in a kernel.

    Attributes
    ----------
    program : definitions used by the expressions
    inputs : variables of the rays, as arrays of doubles
    arguments : real arguments of the primitive
    """

    program: Program
    inputs: Mapping[str, Any]
    arguments: tuple[float, ...] = ()
    _known: dict[Any, Value] = field(default_factory=dict)
    _depth: int = 0
    _nodes: int = 0

    def value(self, node: Node) -> Value:
        """Return the value of an expression.

        Raises
        ------
        InputError : a function is not available in kernels, or a recursion has no end
        """
        return self._node(node, None)

    def call(self, name: str, given: list[Value]) -> Value:
        """Return the value of a function for array arguments."""
        names = tuple(f"$argument{i}" for i in range(len(given)))
        self._known |= dict(zip(names, given, strict=True))
        return self._node(Call(name, tuple(Name(n) for n in names)), None)

    def arity(self, name: str) -> int:
        """Return the number of arguments of a function."""
        found = self._definition(name)
        if found is not None:
            return len(found.parameters or ())
        return FUNCTIONS[name][0] if name in FUNCTIONS else 0

    def _definition(self, name: str) -> Definition | None:
        return self.program.definitions.get(name) or START_FILE.get(name)

    def _node(self, node: Node, frame: Frame | None) -> Value:
        self._depth, self._nodes = self._depth + 1, self._nodes + 1
        if self._depth > _DEEPEST or self._nodes > _MOST_NODES:
            raise InputError(
                "a function calls itself without an end that is known before rays are;"
                " one that ends by a condition on plain numbers expected"
            )
        match node:
            case Number(number):
                made = Value(number)
            case Name(name):
                made = self._variable(name, frame)
            case Negative(inner):
                one = self._node(inner, frame)
                made = Value(-one.value, one.bad)
            case Power(base, exponent):
                made = _power(self._node(base, frame), self._node(exponent, frame))
            case Chain(first, rest):
                made = self._node(first, frame)
                for sign, operand in rest:
                    made = _combined(made, sign, self._node(operand, frame))
            case Call():
                made = self._call(node, frame)
        self._depth -= 1
        return made

    def _variable(self, name: str, frame: Frame | None) -> Value:
        if frame is not None and name in frame.parameters:
            place = frame.parameters.index(name)
            key: Any = (frame, place)
            if key not in self._known:
                self._known[key] = self._node(frame.arguments[place], frame.outer)
            return self._known[key]
        if name not in self._known:
            self._known[name] = self._named(name)
        return self._known[name]

    def _named(self, name: str) -> Value:
        found = self._definition(name)
        if found is not None and found.parameters is None:
            return self._node(found.body, None)
        if name == "AC":
            return Value(float(len(self.arguments)))
        if name[0] == "A" and name[1:].isdigit():
            return self._argument(Value(float(name[1:])))
        if name in self.inputs:
            return Value(self.inputs[name])
        raise InputError(f'"{name}" is not known where light meets a surface')

    def _call(self, call: Call, frame: Frame | None) -> Value:
        name, around = call.name, frame
        while around is not None and name in around.parameters:
            # A parameter may be a function
            handed = around.arguments[around.parameters.index(name)]
            name = handed.name if isinstance(handed, Name) else ""
            around = around.outer
        found, given = self._definition(name), call.arguments
        if name == "if":
            return self._choice(given, frame)
        if name == "select":
            return self._selection(given, frame)
        if found is not None and found.parameters is not None:
            return self._node(found.body, Frame(found.parameters, given, frame))
        values = [self._node(argument, frame) for argument in given]
        if name == "arg":
            return self._argument(values[0])
        if name not in FUNCTIONS:
            raise InputError(f'the function "{name}" does not work on surfaces')
        return FUNCTIONS[name][1](*values)

    def _argument(self, which: Value) -> Value:
        if isinstance(which.value, float | int):
            place = int(np.floor(which.value + 0.5))
            if place > len(self.arguments):
                raise InputError(
                    f"real argument {place} is asked for; {len(self.arguments)} given"
                )
            given = (float(len(self.arguments)), *self.arguments)
            return Value(given[max(place, 0)])
        table = mi.Float64([float(len(self.arguments)), *self.arguments])
        dr.make_opaque(table)
        place = mi.Int32(dr.floor(which.value + 0.5))
        bad = (place < 0) | (place > len(self.arguments))
        index = mi.UInt32(dr.clip(place, 0, len(self.arguments)))
        return Value(dr.gather(mi.Float64, table, index), either_bad(which.bad, bad))

    def _choice(self, given: tuple[Node, ...], frame: Frame | None) -> Value:
        condition = self._node(given[0], frame)
        yes = condition.value > 0
        if isinstance(yes, bool):
            one = self._node(given[1 if yes else 2], frame)
            return Value(one.value, either_bad(one.bad, condition.bad))
        one, other = self._node(given[1], frame), self._node(given[2], frame)
        return Value(
            where(yes, one.value, other.value),
            either_bad(condition.bad, _either(yes, one.bad, other.bad)),
        )

    def _selection(self, given: tuple[Node, ...], frame: Frame | None) -> Value:
        # select(0, …) returns the number of choices
        which = self._node(given[0], frame)
        if isinstance(which.value, float | int):
            number = int(which.value + 0.5)
            if number == 0:
                return Value(float(len(given) - 1), which.bad)
            if not 0 < number < len(given):
                return Value(0.0, True)
            return self._node(given[number], frame)
        number = mi.Int32(dr.floor(which.value + 0.5))
        value = mi.Float64(float(len(given) - 1))
        bad = either_bad(which.bad, (number < 0) | (number >= len(given)))
        for i, choice in enumerate(given[1:], start=1):
            one = self._node(choice, frame)
            value = where(number == i, one.value, value)
            bad = either_bad(bad, _either(number == i, one.bad, False))
        return Value(value, bad)


def _either(condition: Any, yes: Any, no: Any) -> Any:
    if yes is False and no is False:
        return False
    return dr.select(condition, mi.Bool(yes), mi.Bool(no))


def _combined(one: Value, sign: str, other: Value) -> Value:
    bad = either_bad(one.bad, other.bad)
    match sign:
        case "+":
            return Value(one.value + other.value, bad)
        case "-":
            return Value(one.value - other.value, bad)
        case "*":
            return Value(one.value * other.value, bad)
    zero = other.value == 0
    if isinstance(zero, bool):
        return Value(0.0, True) if zero else Value(one.value / other.value, bad)
    quotient = one.value / dr.select(zero, 1, other.value)
    return Value(dr.select(zero, 0, quotient), either_bad(bad, zero))


def _power(base: Value, exponent: Value) -> Value:
    # Integer exponents accept any base, other exponents only bases of 0 or more
    bad, power = either_bad(base.bad, exponent.bad), exponent.value
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
