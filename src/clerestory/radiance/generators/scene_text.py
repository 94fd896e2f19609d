"""Formatting of primitives as scene text on one line.

The output of a generator has no line breaks, so that error messages give the line of
the command.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError


def primitive(
    modifier: str,
    kind: str,
    name: str,
    *,
    strings: Sequence[str] = (),
    reals: Iterable[float] = (),
) -> str:
    """Return a primitive as text.

    Examples
    --------
    >>> primitive("void", "light", "lamp", reals=(1, 1, 0.5))
    'void light lamp 0 0 3 1 1 0.5'
    """
    words = [quoted(word) for word in strings]
    numbers = [f"{value:.12g}" for value in np.asarray(list(reals), dtype=float)]
    return " ".join(
        [
            quoted(modifier),
            kind,
            quoted(name),
            str(len(words)),
            *words,
            "0",
            str(len(numbers)),
            *numbers,
        ]
    )


def polygon(modifier: str, name: str, vertices: Float[np.ndarray, "vertices 3"]) -> str:
    """Return a polygon as text."""
    return primitive(modifier, "polygon", name, reals=vertices.ravel())


def quoted(word: str) -> str:
    """Return a word, in quotation marks if necessary."""
    plain = word and not any(letter.isspace() for letter in word)
    if plain and word[0] not in "\"'#!":
        return word
    mark = "'" if '"' in word else '"'
    if mark in word or "\n" in word:
        raise InputError(f"the name {word!r} cannot be written in a scene file")
    return mark + word + mark
