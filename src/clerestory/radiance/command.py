"""Inline commands of scene files: xform, cat and the scene generators.

Commands are evaluated without a shell or external programs.
"""

import math
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.catalogue import CONVERTERS, GENERATORS, Build
from clerestory.radiance.placement import Placement
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import parse_transform

# Maximum number of copies made by one command
_MOST_COPIES = 100_000


@dataclass(frozen=True, eq=False)
class Inclusion:
    """Files, primitives or scene inserted by a command, with a placement per copy.

    Commands include named files, primitives made by a generator, or a scene built by
    a converter such as mgf2rad.
    """

    files: tuple[str, ...]
    placements: tuple[Placement, ...]
    items: tuple[Primitive, ...] = ()
    build: Build | None = None


def parse_command(text: str, *, find: Callable[[str], Path]) -> Inclusion:
    """Return the content that a command, or a pipe of commands, inserts into a scene.

    `find` returns the path of a file named in the command.
    """
    stages = _stages(text)
    # `xform < file` is `xform file`
    words = [w for w in stages[0] if w != "<"] or [""]
    program = _program(words)
    items: list[Primitive] = []
    files: list[str] = []
    placements, build = [Placement()], None
    reader = WordReader(words[1:], program)
    if program in GENERATORS:
        items = GENERATORS[program](reader, find)
    elif program in CONVERTERS:
        build = CONVERTERS[program](reader, find)
    else:
        files, placements = _first_stage(words, text, find)
    for words in stages[1:]:
        if _program(words) != "xform":
            raise _refusal(text, " ".join(words))
        outer, more = _xform(words[1:], find)
        if more:
            raise _refusal(text, " ".join(words))
        _require_few(len(outer) * len(placements))
        placements = [inner.then(o) for o in outer for inner in placements]
    return Inclusion(tuple(files), tuple(placements), tuple(items), build)


def _stages(text: str) -> list[list[str]]:
    # Words of each command in a pipe
    lexer = shlex.shlex(text, posix=True, punctuation_chars="|<>;&()")
    lexer.whitespace_split, lexer.commenters = True, ""
    try:
        words = list(lexer)
    except ValueError as error:
        raise InputError(
            f'the command "{text.strip()}" cannot be read: {error}'
        ) from error
    stages: list[list[str]] = [[]]
    comment = [i for i, word in enumerate(words) if word.startswith("#")]
    for word in words[: min(comment, default=len(words))]:
        if word == "|":
            stages.append([])
        elif word != "<" and word and set(word) <= set("|<>;&()"):
            raise _refusal(text, word)
        else:
            stages[-1].append(word)
    require(all(stages), "a command is empty; !xform FILE expected")
    return stages


def _first_stage(
    words: list[str], text: str, find: Callable[[str], Path]
) -> tuple[list[str], list[Placement]]:
    match _program(words):
        case "cat":
            files, placements = words[1:], [Placement()]
            if any(f.startswith("-") for f in files):
                raise _refusal(text, " ".join(words))
        case "xform":
            placements, files = _xform(words[1:], find)
        case _:
            raise _refusal(text, words[0])
    missing = f'"{text.strip()}" has no file; !xform OPTIONS FILE expected'
    require(files, missing)
    return files, placements


def _program(words: list[str]) -> str:
    return words[0].replace("\\", "/").rpartition("/")[2].removesuffix(".exe")


def _refusal(text: str, part: str) -> InputError:
    known = ", ".join(["xform", "cat", *GENERATORS, *CONVERTERS])
    return InputError(
        f'"{part}" in the command "{text.strip()}" is not supported, only {known} are;'
        " save the output of the command as a .rad file and include that file"
    )


def _xform(
    words: list[str], find: Callable[[str], Path]
) -> tuple[list[Placement], list[str]]:
    # Placements of all copies, and names of the files
    placements, files = [], words
    for arguments in _copies(words, find):
        placement, files = _single(arguments)
        placements.append(placement)
        _require_few(len(placements))
    return placements, files


def _require_few(copies: int) -> None:
    most = f"the command creates more than {_MOST_COPIES} copies; fewer expected"
    require(copies <= _MOST_COPIES, most)


def _copies(
    words: list[str], find: Callable[[str], Path], reading: tuple[str, ...] = ()
) -> Iterator[list[str]]:
    # Expands the first -f, or else the first -a, into one command per copy
    if "-f" in words:
        at = words.index("-f")
        for i, line in enumerate(_option_lines(words[at + 1 : at + 2], find, reading)):
            inner = words[:at] + line + words[at + 2 :]
            yield from _copies(
                _numbered(inner, f"i{i}", i, slice(1)), find, (*reading, words[at + 1])
            )
    elif "-a" in words:
        at = words.index("-a")
        for i in range(_array_count(words)):
            inner = [*words[:at], "-i", str(i), *words[at + 2 :]]
            yield from _copies(_numbered(inner, f"a{i}", i, slice(None)), find, reading)
    else:
        yield words


def _array_count(words: list[str]) -> int:
    # Number of copies of the first -a; the product for all -a is limited
    counts = []
    for at in (i for i, word in enumerate(words) if word == "-a"):
        count = "".join(words[at + 1 : at + 2])
        require(
            count.isascii() and count.isdecimal() and int(count) > 0,
            f'xform -a is followed by "{count}"; a count above 0 expected',
        )
        counts.append(int(count))
    _require_few(math.prod(counts))
    return counts[0]


def _numbered(words: list[str], fresh: str, i: int, which: slice) -> list[str]:
    # Appends i to the name prefix (-n) of copy i. If there are several -n, xform -f
    # numbers the first one; xform -a replaces each by the last one, numbered.
    named = [at for at in range(1, len(words)) if words[at - 1] == "-n"][which]
    if not named:
        return ["-n", fresh, *words]
    prefix = f"{words[named[-1]]}.{i}"
    return [prefix if at in named else word for at, word in enumerate(words)]


def _option_lines(
    name: list[str], find: Callable[[str], Path], reading: tuple[str, ...]
) -> list[list[str]]:
    # xform options of each copy: the lines of the file named by option -f
    missing = "xform -f has no file; a file of xform options expected"
    require(name and not name[0].startswith("-"), missing)
    require(name[0] not in reading, f'xform -f: the file "{name[0]}" refers to itself')
    lines = []
    for line in read_text(find(name[0])).replace("\\\n", "").splitlines():
        if line and not line.startswith("#"):
            try:
                words = shlex.split(line.removeprefix("!"))
            except ValueError as error:
                raise InputError(f"xform -f {name[0]}: {error}") from error
            words = words[1:] if words[:1] == ["xform"] else words
            message = f"xform -f {name[0]}: a line has no options"
            require(
                not words or words[0].startswith("-"), f"{message}; -t x y z expected"
            )
            lines.append(words)
    require(lines, f'xform -f: the file "{name[0]}" is empty; options expected')
    return lines


def _single(words: list[str]) -> tuple[Placement, list[str]]:
    # Placement of one xform copy, and file names; other options precede the transform
    modifier, prefixes, inverted, at = None, [], False, 0
    while at < len(words) and words[at] in ("-m", "-n", "-c", "-e", "-I"):
        option = words[at]
        if option in ("-m", "-n"):
            at += 1
            require(at < len(words), f"xform {option} has no value; a name expected")
            if option == "-n":
                prefixes.append(words[at])
            elif modifier is None:
                modifier = words[at]
        inverted ^= option == "-I"
        at += 1
    transform, taken = parse_transform(words[at:])
    files = words[at + taken :]
    first = files[0] if files else ""
    require(
        not first.startswith("-"),
        f'xform option "{first}" is unknown or out of order; -m -n -I first, then'
        " -t -rx -ry -rz -s -mx -my -mz -i expected, with -a and -f anywhere",
    )
    return Placement(transform, modifier, ".".join(prefixes), inverted), files
