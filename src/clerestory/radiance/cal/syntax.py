"""Parser of function files (.cal).

A definition is `name = expression;`, `name : expression;` or `f(x, y) = expression;`.
Powers are right-associative and precede products, products precede sums; a sign binds
more tightly than a power, so -2^2 is 4. Comments are in braces. A chain of sums or of
products is one node, so that long expressions are not deeply nested.

Reference: G. Ward, Radiance, "calcomp" (icalc manual page, section Expressions).
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

from clerestory.checks import require
from clerestory.errors import InputError

# Maximum depth of nested brackets, which limits recursion
_DEEPEST = 40

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"|(?P<name>[A-Za-z`][\w.`]*)|(?P<channel>\$\d{1,3})|(?P<sign>[-+*/^(),;=:]))",
    re.ASCII,
)


@dataclass(frozen=True)
class Number:
    """A constant."""

    value: float


@dataclass(frozen=True)
class Name:
    """A variable, a parameter, or a function passed as an argument."""

    name: str


@dataclass(frozen=True)
class Call:
    """A function call with its arguments."""

    name: str
    arguments: tuple["Node", ...]


@dataclass(frozen=True)
class Negative:
    """An expression preceded by a minus sign."""

    value: "Node"


@dataclass(frozen=True)
class Chain:
    """A left-associative chain: a + b - c, or a * b / c."""

    first: "Node"
    rest: tuple[tuple[str, "Node"], ...]


@dataclass(frozen=True)
class Power:
    """A base raised to an exponent."""

    base: "Node"
    exponent: "Node"


Node = Number | Name | Call | Negative | Chain | Power


@dataclass(frozen=True)
class Definition:
    """The definition of a name; `parameters` is None for a variable."""

    name: str
    parameters: tuple[str, ...] | None
    body: Node


def parse_definitions(text: str, *, file: str | None = None) -> dict[str, Definition]:
    """Return the definitions in a text by name; the last definition of a name applies.

    >>> made = parse_definitions("{ square } sq(x) : x*x; two = 2;")
    >>> sorted(made), made["sq"].parameters
    (['sq', 'two'], ('x',))
    """
    cursor = _Cursor(_without_comments(text, file), file)
    definitions = {}
    while cursor.kind != "end":
        if not cursor.skip(";"):
            definition = _definition(cursor)
            definitions[definition.name] = definition
            if cursor.kind != "end":
                cursor.expect(";")
    return definitions


def parse_expression(text: str, *, file: str | None = None) -> Node:
    """Return the expression tree of a single expression.

    >>> parse_expression("-x^2")
    Power(base=Negative(value=Name(name='x')), exponent=Number(value=2.0))
    """
    cursor = _Cursor(_without_comments(text, file), file)
    node = _expression(cursor)
    if cursor.kind != "end":
        raise cursor.error(f'"{cursor.text}" follows a complete expression')
    return node


def _without_comments(text: str, file: str | None) -> str:
    # Replaces nested comments by blanks, but preserves line breaks
    kept, depth, opened = [], 0, 0
    for at, letter in enumerate(text):
        if letter == "{":
            opened = at if depth == 0 else opened
            depth += 1
        kept.append(letter if depth == 0 or letter == "\n" else " ")
        if letter == "}":
            depth = max(depth - 1, 0)
    line = text.count("\n", 0, opened) + 1
    unclosed = 'a comment is not closed; "}" expected'
    require(depth == 0, unclosed, file=file, line=line)
    return "".join(kept)


class _Cursor:
    # Current token and its position in the text

    def __init__(self, text: str, file: str | None) -> None:
        self.source, self.file, self.line = text, file, 1
        self.at, self.depth = 0, 0
        self.kind, self.text = "", ""
        self.take()

    def take(self) -> str:
        # Returns the current token and reads the next
        taken = self.text
        match = _TOKEN.match(self.source, self.at)
        if match is None:
            left = self.source[self.at :].lstrip()
            self.line += self.source.count("\n", self.at, len(self.source) - len(left))
            if left:
                raise self.error(f'unexpected character "{left[0]}"')
            self.kind, self.text, self.at = "end", "", len(self.source)
        else:
            self.kind = match.lastgroup or ""
            self.line += self.source.count("\n", self.at, match.start(self.kind))
            self.text, self.at = match[self.kind], match.end()
        return taken

    def skip(self, sign: str) -> bool:
        # Reads the sign if it is the current token
        found = self.text == sign
        if found:
            self.take()
        return found

    def expect(self, sign: str) -> None:
        if not self.skip(sign):
            raise self.unexpected(f'"{sign}"')

    def name(self, what: str) -> str:
        if self.kind != "name":
            raise self.unexpected(what)
        return plain_name(self.take())

    def unexpected(self, expected: str) -> InputError:
        found = f'"{self.text}"' if self.text else "the end"
        return self.error(f"unexpected {found}; {expected} expected")

    def error(self, message: str) -> InputError:
        line = None if self.file is None else self.line
        return InputError(message, file=self.file, line=line)


def _definition(cursor: _Cursor) -> Definition:
    name, parameters = cursor.name("a name"), None
    if cursor.skip("("):
        names = [cursor.name("the name of a parameter")]
        while cursor.skip(","):
            names.append(cursor.name("the name of a parameter"))
        cursor.expect(")")
        parameters = tuple(names)
    if not (cursor.skip("=") or cursor.skip(":")):
        raise cursor.unexpected('"=" or ":"')
    return Definition(name, parameters, _expression(cursor))


def plain_name(name: str) -> str:
    """Return a name without the marks ` that denote its context."""
    return name.strip("`") or "`"


def _expression(cursor: _Cursor) -> Node:
    try:
        return _sum(cursor)
    except RecursionError:
        raise cursor.error("brackets are nested too deep") from None


def _sum(cursor: _Cursor) -> Node:
    return _chain(cursor, "+-", _product)


def _product(cursor: _Cursor) -> Node:
    return _chain(cursor, "*/", _power)


def _chain(cursor: _Cursor, signs: str, operand: Callable[[_Cursor], Node]) -> Node:
    first, rest = operand(cursor), []
    while cursor.kind == "sign" and cursor.text in signs:
        sign = cursor.take()
        rest.append((sign, operand(cursor)))
    return Chain(first, tuple(rest)) if rest else first


def _power(cursor: _Cursor) -> Node:
    # a ^ b ^ c is right-associative
    operands = [_signed(cursor)]
    while cursor.skip("^"):
        operands.append(_signed(cursor))
        if len(operands) > _DEEPEST:
            raise cursor.error(
                f"powers are nested too deep; at most {_DEEPEST} expected"
            )
    return reduce(lambda exponent, base: Power(base, exponent), reversed(operands))


def _signed(cursor: _Cursor) -> Node:
    if cursor.skip("-"):
        value = _primary(cursor)
        return Number(-value.value) if isinstance(value, Number) else Negative(value)
    cursor.skip("+")
    return _primary(cursor)


def _primary(cursor: _Cursor) -> Node:
    match cursor.kind:
        case "number":
            return Number(float(cursor.take()))
        case "channel":
            return Name(cursor.take())
        case "name":
            name = cursor.name("a name")
            return Call(name, _inside(cursor)) if cursor.text == "(" else Name(name)
    if cursor.text == "(":
        (node,) = _inside(cursor, one=True)
        return node
    raise cursor.unexpected("a value")


def _inside(cursor: _Cursor, *, one: bool = False) -> tuple[Node, ...]:
    # Reads one or more expressions in brackets
    cursor.depth += 1
    if cursor.depth > _DEEPEST:
        raise cursor.error(f"brackets are nested too deep; at most {_DEEPEST} expected")
    cursor.expect("(")
    nodes = [_sum(cursor)]
    while not one and cursor.skip(","):
        nodes.append(_sum(cursor))
    cursor.expect(")")
    cursor.depth -= 1
    return tuple(nodes)
