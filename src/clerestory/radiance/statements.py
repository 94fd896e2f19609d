"""Parser of the statements of scene files (.rad).

For speed in long files, polygons with plain numbers are matched by one regular
expression and converted together; other statements are read word by word.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Int

from clerestory.array_types import Vertices
from clerestory.errors import InputError
from clerestory.scene.material import Source
from clerestory.scene.primitive import Primitive
from clerestory.scene.surface import Polygon
from clerestory.scene.transform import number


@dataclass(frozen=True, eq=False)
class PolygonRun:
    """Consecutive polygons; polygon i has the vertices first[i]:first[i+1]."""

    modifier: list[str]
    name: list[str]
    source: list[Source]
    first: Int[np.ndarray, " polygons_and_end"]
    vertices: Vertices

    def polygons(
        self, key: Callable[[str, Source], str] = lambda name, _: name
    ) -> Iterator[Polygon]:
        """Yield the polygons; `key` returns the key of the material of a modifier."""
        ends = self.first.tolist()
        for i, modifier in enumerate(self.modifier):
            source = self.source[i]
            vertices = self.vertices[ends[i] : ends[i + 1]]
            yield Polygon(vertices, key(modifier, source), self.name[i], source)


@dataclass(frozen=True)
class Command:
    """An inline command, without its exclamation mark."""

    text: str
    line: int


@dataclass(frozen=True)
class Directive:
    """The variables of a `#@rfluxmtx` comment."""

    text: str
    line: int


Statement = Primitive | PolygonRun | Command | Directive

# Types of primitives (Radiance reference manual, section 2.1)
_SURFACES = "polygon sphere bubble cone cup cylinder tube ring source instance mesh"
_MODIFIERS = """
    plastic metal glass trans dielectric plastic2 metal2 trans2 interface plasfunc
    metfunc brightfunc brightdata brighttext colorpict glow light illum spotlight
    mist mirror transfunc BRTDfunc BSDF aBSDF plasdata metdata transdata colorfunc
    antimatter colordata colortext texfunc texdata mixfunc mixdata mixtext mixpict
    prism1 prism2 ashik2 WGMDfunc spectrum specfile specfunc specdata specpict
"""
SURFACE_KINDS = frozenset(_SURFACES.split())
MODIFIER_KINDS = frozenset(_MODIFIERS.split())

_NUMBER = r"[-+]?(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][-+]?\d++)?+(?!\S)"
# Largest number of digits of a number of arguments
_MOST_DIGITS = 9

_POLYGON = re.compile(
    rf"""([^\s"'\#!]\S*)\s+polygon\s+([^\s"']\S*)\s+0\s+0\s+(\d+)((?:\s+{_NUMBER})++)""",
    re.ASCII,
)
_SKIP = re.compile(r"(?:\s++|#(?!@rfluxmtx\b)[^\n]*+)*+", re.ASCII)
_LINE = re.compile(r"[^\n]*")
_COMMAND = re.compile(r"!((?:[^\\\n]|\\.|\\\n|\\)*)")
_WORD = re.compile(r"""\s*(?:"([^"]*)(")?|'([^']*)(')?|(\S+))""", re.ASCII)


def parse_statements(text: str, *, file: str) -> list[Statement]:
    """Return the statements in the text of a scene file, in order."""
    statements: list[Statement] = []
    polygons = _PolygonCollector()
    cursor = _Cursor(text, file)
    while cursor.skip():
        if polygons.take(cursor):
            continue
        statements.extend(polygons.flush())
        polygons = _PolygonCollector()
        statements.append(_statement(cursor))
    statements.extend(polygons.flush())
    return statements


@dataclass
class _Cursor:
    # Current position and line number in the text
    text: str
    file: str
    at: int = 0
    counted: int = 0
    newlines: int = 0

    def skip(self) -> bool:
        # Skips blanks and comments; returns whether any text remains
        match = _SKIP.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return self.at < len(self.text)

    def line(self) -> int:
        self.newlines += self.text.count("\n", self.counted, self.at)
        self.counted = self.at
        return self.newlines + 1

    def matched(self, pattern: re.Pattern[str]) -> str:
        # Reads the text that matches a regular expression
        match = pattern.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return match.group() if match else ""

    def word(self, what: str) -> str:
        match = _WORD.match(self.text, self.at)
        if match is None:
            end = len(self.text.rstrip())
            raise self.error(f"the file ends where {what} is expected", at=end)
        double, double_end, single, single_end, plain = match.groups()
        if plain is None and double_end is None and single_end is None:
            raise self.error("a quotation mark is not closed", at=match.start())
        self.at = match.end()
        return next(w for w in (plain, double, single) if w is not None)

    def error(self, message: str, *, at: int | None = None) -> InputError:
        line = self.text.count("\n", 0, self.at if at is None else at) + 1
        return InputError(message, file=self.file, line=line)


def _statement(cursor: _Cursor) -> Statement:
    line = cursor.line()
    start = cursor.text[cursor.at]
    if start == "#":
        return Directive(cursor.matched(_LINE).removeprefix("#@rfluxmtx"), line)
    if start == "!":
        return Command(cursor.matched(_COMMAND)[1:].replace("\\\n", ""), line)

    modifier = cursor.word("a modifier")
    here = cursor.at
    kind = cursor.word(f'the type of a primitive modified by "{modifier}"')
    known = kind == "alias" or kind in SURFACE_KINDS or kind in MODIFIER_KINDS
    name = cursor.word(f"the name of the {kind}") if known else ""
    if kind == "alias":
        target = cursor.word(f'the original of alias "{name}"')
        return Primitive(modifier, kind, name, (target,), (), line)
    if not known:
        hint = "a type such as polygon or plastic expected"
        if number(modifier) is not None and number(kind) is not None:
            hint = "does the previous primitive have more numbers than its count?"
        cursor.at = here + len(cursor.text[here:]) - len(cursor.text[here:].lstrip())
        raise cursor.error(f'unknown type "{kind}" of primitive; {hint}')
    return _primitive(cursor, modifier=modifier, kind=kind, name=name, line=line)


def _primitive(
    cursor: _Cursor, *, modifier: str, kind: str, name: str, line: int
) -> Primitive:
    label = f'{kind} "{name}"'
    strings = tuple(
        cursor.word(f"string {i + 1} of {label}")
        for i in range(_count(cursor, f"the count of strings of {label}"))
    )
    if _count(cursor, f"the count of integers of {label}") != 0:
        raise cursor.error(f"{label} has integer arguments; a count of 0 expected")
    count = _count(cursor, f"the count of numbers of {label}")
    if count > len(cursor.text) - cursor.at:
        raise cursor.error(f"{label}: the file ends before its {count} numbers")
    reals = []
    for i in range(count):
        word = cursor.word(f"number {i + 1} of {count} of {label}")
        value = number(word)
        if value is None:
            raise cursor.error(
                f'{label} has "{word}" where number {i + 1} of {count} is expected'
            )
        reals.append(value)
    return Primitive(modifier, kind, name, strings, tuple(reals), line)


def _count(cursor: _Cursor, what: str) -> int:
    word = cursor.word(what)
    if not (word.isascii() and word.isdecimal() and len(word) < 12):
        raise cursor.error(f'"{word}" is found where {what} is expected')
    return int(word)


@dataclass
class _PolygonCollector:
    # Consecutive polygons; coordinates are still text
    modifier: list[str] = field(default_factory=list)
    name: list[str] = field(default_factory=list)
    source: list[Source] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    numbers: list[str] = field(default_factory=list)

    def take(self, cursor: _Cursor) -> bool:
        # Reads the polygon at the cursor if the regular expression matches
        match = _POLYGON.match(cursor.text, cursor.at)
        if match is None:
            return False
        modifier, name, announced, numbers = match.groups()
        if len(announced) > _MOST_DIGITS:
            return False
        count = int(announced)
        if count < 9 or count % 3 or len(numbers.split()) != count:
            return False
        self.modifier.append(modifier)
        self.name.append(name)
        self.source.append(Source(cursor.file, cursor.line()))
        self.count.append(count // 3)
        self.numbers.append(numbers)
        cursor.at = match.end()
        return True

    def flush(self) -> list[PolygonRun]:
        if not self.count:
            return []
        vertices = np.fromstring("".join(self.numbers), sep=" ").reshape(-1, 3)
        first = np.concatenate([[0], np.cumsum(self.count)])
        return [PolygonRun(self.modifier, self.name, self.source, first, vertices)]
