"""Inline commands of .rad files, run natively: xform, cat and the generators.

No shell is involved, and no program is started.
"""

import math
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.catalogue import GENERATORS, generate
from clerestory.radiance.generators.converters import BUILDERS, Build
from clerestory.radiance.placement import Placement
from clerestory.scene.transform import parse_transform

# More copies than this in one command is a slip of the pen
_MOST_COPIES = 100_000


@dataclass(frozen=True, eq=False)
class Inclusion:
    """What a command includes, and the places where it puts copies.

    Attributes
    ----------
    files : what it reads
    placements : one for each copy
    text : what a generator makes, on a single line; empty if files are read
    build : makes the scene that a command stands for, or None
    """

    files: tuple[str, ...]
    placements: tuple[Placement, ...]
    text: str = ""
    build: Build | None = None


def parse_command(text: str, *, find: Callable[[str], Path]) -> Inclusion:
    """Return what `xform …`, `cat …` or a generator includes, alone or in a pipe.

    Parameters
    ----------
    text : the command, without its exclamation mark
    find : path of a file that the command names
    """
    stages = _stages(text)
    # `xform < file` reads what `xform file` reads
    words = [w for w in stages[0] if w != "<"] or [""]
    program = _program(words)
    made, build = "", None
    files: list[str] = []
    placements = [Placement()]
    if program in GENERATORS:
        made = generate(program, words[1:], find)
    elif program in BUILDERS:
        build = BUILDERS[program](WordReader(words[1:], program), find)
    else:
        files, placements = _first_stage(words, text, find)
    for words in stages[1:]:
        outer, more = (
            _xform(words[1:], find) if _program(words) == "xform" else ([], ["?"])
        )
        if more:
            raise _refusal(text, " ".join(words))
        if len(outer) * len(placements) > _MOST_COPIES:
            raise InputError(f"the command makes more than {_MOST_COPIES} copies")
        placements = [inner.then(o) for o in outer for inner in placements]
    return Inclusion(tuple(files), tuple(placements), made, build)


def _stages(text: str) -> list[list[str]]:
    # Words of each command of a pipe
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
    if not all(stages):
        raise InputError("an empty command; !xform FILE expected")
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
    if not files:
        raise InputError(
            f'"{text.strip()}" names no file; !xform OPTIONS FILE expected'
        )
    return files, placements


def _program(words: list[str]) -> str:
    return words[0].replace("\\", "/").rpartition("/")[2].removesuffix(".exe")


def _refusal(text: str, part: str) -> InputError:
    known = ", ".join(["xform", "cat", *GENERATORS, *BUILDERS])
    return InputError(
        f'"{part}" in the command "{text.strip()}" is not run, only {known} are;'
        " run the command yourself, save what it prints as a .rad file and include that"
        " file"
    )


def _xform(
    words: list[str], find: Callable[[str], Path]
) -> tuple[list[Placement], list[str]]:
    # Every copy that the arguments ask for, and the files they name
    placements, files = [], words
    for arguments in _copies(words, find):
        placement, files = _single(arguments)
        placements.append(placement)
        if len(placements) > _MOST_COPIES:
            raise InputError(f"xform makes more than {_MOST_COPIES} copies")
    return placements, files


def _copies(
    words: list[str], find: Callable[[str], Path], reading: tuple[str, ...] = ()
) -> Iterator[list[str]]:
    # Replace -f and -a, the first of each at a time, by what they stand for
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
    # The count of the first -a, if all counts together make sense
    counts = []
    for at in (i for i, word in enumerate(words) if word == "-a"):
        count = "".join(words[at + 1 : at + 2])
        if not (count.isascii() and count.isdecimal() and int(count) > 0):
            raise InputError(
                f'xform -a is followed by "{count}"; a count above 0 expected'
            )
        counts.append(int(count))
    if math.prod(counts) > _MOST_COPIES:
        raise InputError(f"xform makes more than {_MOST_COPIES} copies")
    return counts[0]


def _numbered(words: list[str], fresh: str, i: int, which: slice) -> list[str]:
    # Give copy i a prefix of its own. Of several -n, xform numbers the first for -f;
    # for -a it numbers the last and puts that in place of all.
    named = [at for at in range(1, len(words)) if words[at - 1] == "-n"][which]
    if not named:
        return ["-n", fresh, *words]
    prefix = f"{words[named[-1]]}.{i}"
    return [prefix if at in named else word for at, word in enumerate(words)]


def _option_lines(
    name: list[str], find: Callable[[str], Path], reading: tuple[str, ...]
) -> list[list[str]]:
    # The argument lists in the file of -f, one a line
    if not name or name[0].startswith("-"):
        raise InputError("xform -f names no file; a file of xform options expected")
    if name[0] in reading:
        raise InputError(f'xform -f: the file "{name[0]}" names itself')
    lines = []
    for line in read_text(find(name[0])).replace("\\\n", "").splitlines():
        if line and not line.startswith("#"):
            try:
                words = shlex.split(line.removeprefix("!"))
            except ValueError as error:
                raise InputError(f'xform -f {name[0]}: "{line}": {error}') from error
            lines.append(words[1:] if words[:1] == ["xform"] else words)
    if not lines:
        raise InputError(f'xform -f: the file "{name[0]}" is empty')
    return lines


def _single(words: list[str]) -> tuple[Placement, list[str]]:
    # One copy: options for surfaces first, then the transform, then the files
    modifier, prefixes, inverted, at = None, [], False, 0
    while at < len(words) and words[at] in ("-m", "-n", "-c", "-e", "-I"):
        option = words[at]
        if option in ("-m", "-n"):
            at += 1
            if at == len(words):
                raise InputError(
                    f"xform {option} is followed by nothing; a name expected"
                )
            if option == "-n":
                prefixes.append(words[at])
            elif modifier is None:
                modifier = words[at]
        inverted ^= option == "-I"
        at += 1
    transform, taken = parse_transform(words[at:])
    files = words[at + taken :]
    if files and files[0].startswith("-"):
        raise InputError(
            f'xform does not take "{files[0]}" here; -m -n -I come first, then'
            " -t -rx -ry -rz -s -mx -my -mz -i, with -a and -f anywhere"
        )
    return Placement(transform, modifier, ".".join(prefixes), inverted), files
