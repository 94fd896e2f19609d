"""Views in Radiance's options, view files and image headers.

Each line `rvu -vtv -vp … -vd …` of a view file changes the parameters in the line; the
view after the last line is returned.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.checks import require
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

# Beginnings of lines that define a view (Radiance, image.c: isview)
_OPENING = re.compile(
    r"(?:\S*/)?(?:VIEW=|rpict|rview|rvu|rpiece|pinterp)|-v[tpduhvslo]"
)

# Maximum length of an image header [bytes]; an empty line ends the header
_LONGEST_HEADER = 1 << 20


def parse_view(text: str, base: View | None = None) -> View:
    """Return the view given by options such as "-vta -vp 1 2 1.2 -vh 180".

    Words other than view options are ignored, as are -vf and its file.

    Parameters
    ----------
    text : options, with or without a program name before them
    base : view that gives the values of omitted options; None: Radiance's default view

    Raises
    ------
    InputError : an option lacks its numbers or is unknown, or the view is invalid

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
    require(
        word[3:] in LETTERS,
        f'unknown view type "{word}"; -vt and one of {" ".join(LETTERS)} expected',
    )
    return LETTERS[word[3:]]


def _numbers(option: str, words: list[str], count: int) -> list[float]:
    values = [number(word) for word in words]
    found = [value for value in values if value is not None]
    noun = "1 number" if count == 1 else f"{count} numbers"
    require(len(found) == count, f"view option {option} without {noun} after it")
    return found


def format_view(view: View) -> str:
    """Return a view as Radiance's options, including default values.

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
    """Whether a line of a header or a view file defines a view."""
    return _OPENING.match(line) is not None


def read_view(path: str | Path) -> View:
    """Return the last view of a view file, or the view in an image header."""
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
    """Return the view given by options, or by the name of a view file."""
    return parse_view(text) if text.lstrip().startswith("-v") else read_view(text)
