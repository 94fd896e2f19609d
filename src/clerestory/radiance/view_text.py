"""Views as text: Radiance's options, view files and the headers of pictures.

A view file has a line `rvu -vtv -vp … -vd …` for each change; what a line does not
say stays as the lines before left it. The last state counts.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.errors import InputError, located
from clerestory.files import read_bytes
from clerestory.scene.projection import LETTERS, Kind
from clerestory.scene.transform import number
from clerestory.scene.view import View

_VECTORS = {"-vp": "position", "-vd": "direction", "-vu": "up"}
_NUMBERS = {
    "-vh": "horizontal",
    "-vv": "vertical",
    "-vs": "shift",
    "-vl": "lift",
    "-vo": "fore",
    "-va": "aft",
}

# Words that begin a line with a view (image.c: isview), and bare options
_OPENING = re.compile(
    r"(?:\S*/)?(?:VIEW=|rpict|rview|rvu|rpiece|pinterp)|-v[tpduhvslo]"
)

# A header is text; what follows its empty line may be pixels
_LONGEST_HEADER = 1 << 20


def parse_view(text: str, base: View | None = None) -> View:
    """Return the view that options such as "-vta -vp 1 2 1.2 -vh 180" describe.

    Words that are no view options are passed over, as are -vf and its file.

    Parameters
    ----------
    text : options, with or without a program's name in front
    base : supplies what the options leave open; else Radiance's standard view

    Raises
    ------
    InputError : an option without its numbers, an unknown view option, a view that
        cannot be

    Examples
    --------
    >>> parse_view("rvu -vth -vp 1 2 1.5 -vd 0 2 0 -vh 180 -vv 180").kind
    'hemispherical'
    """
    words = text.removeprefix("VIEW=").split()
    changes: dict[str, Any] = {}
    i = 0
    while i < len(words):
        word = words[i]
        if word.startswith("-vt"):
            changes["kind"] = _kind(word)
        elif word in _VECTORS:
            changes[_VECTORS[word]] = np.array(_numbers(word, words[i + 1 : i + 4], 3))
            i += 3
        elif word in _NUMBERS:
            changes[_NUMBERS[word]] = _numbers(word, words[i + 1 : i + 2], 1)[0]
            i += 1
        elif word == "-vf":
            i += 1
        elif re.match(r"-v[a-z]", word):
            known = " ".join([*_VECTORS, *_NUMBERS])
            raise InputError(f'unknown view option "{word}"; -vt… {known} expected')
        i += 1
    return replace(base or View(), **changes)


def _kind(word: str) -> Kind:
    if word[3:] not in LETTERS:
        raise InputError(
            f'unknown view type "{word}"; -vt and one of {" ".join(LETTERS)} expected'
        )
    return LETTERS[word[3:]]


def _numbers(option: str, words: list[str], count: int) -> list[float]:
    values = [number(word) for word in words]
    found = [value for value in values if value is not None]
    if len(found) < count or len(values) < count:
        noun = "a number" if count == 1 else f"{count} numbers"
        raise InputError(f"view option {option} without {noun} behind it")
    return found


def format_view(view: View) -> str:
    """Return the options that describe a view, all of them, for Radiance.

    >>> format_view(View())
    '-vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45 -vo 0 -va 0 -vs 0 -vl 0'
    """
    letter = next(key for key, kind in LETTERS.items() if kind == view.kind)
    words = [f"-vt{letter}"]
    for option, name in _VECTORS.items():
        words += [option, *(f"{x + 0.0:.9g}" for x in getattr(view, name))]
    for option in ("-vh", "-vv", "-vo", "-va", "-vs", "-vl"):
        words += [option, f"{getattr(view, _NUMBERS[option]) + 0.0:.9g}"]
    return " ".join(words)


def opens_view(line: str) -> bool:
    """Whether a line of a header or view file tells about the view."""
    return _OPENING.match(line) is not None


def read_view(path: str | Path) -> View:
    """Return the last view of a view file, or the view in a picture's header.

    Raises
    ------
    InputError : the file is missing, holds no view, or one that cannot be
    """
    text = read_bytes(path)[:_LONGEST_HEADER].decode("latin-1")
    if text.startswith("#?"):
        text = text.partition("\n\n")[0]
    view = None
    for i, line in enumerate(text.split("\n"), start=1):
        if opens_view(line) and "-v" in line:
            with located(file=path, line=i):
                view = parse_view(line, view)
    if view is None:
        raise InputError(
            "no view; a line such as rvu -vtv -vp x y z -vd x y z expected", file=path
        )
    return view


def view_of(text: str) -> View:
    """Return the view that a text describes, or that the file of this name holds.

    >>> view_of("-vta -vh 180 -vv 180").kind
    'angular'
    """
    return parse_view(text) if text.lstrip().startswith("-v") else read_view(text)
