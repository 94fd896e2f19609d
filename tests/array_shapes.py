"""The check of array shapes at every call, for pytest's --jaxtyping-packages.

Other types are left to mypy: tests that pass a wrong one on purpose expect the
message of the package itself. jaxtyping hands over two copies of each function, one
to check arguments before the call, and one to check them again with the result.
"""

import itertools
import random
from typing import Any, get_args

from jaxtyping import AbstractArray

# Beartype checks one item of each sequence, drawn at random. Count instead of drawing:
# each run checks the same items, and the two copies of a function check different ones.
_drawn, _number = random.getrandbits, itertools.count()
random.getrandbits = lambda _: next(_number)
from beartype import beartype


@beartype
def _first_use(items: list[int]) -> None: ...


random.getrandbits = _drawn


def check(function):
    """Beartype that sees the annotations of arrays and no others."""
    hints = {k: v for k, v in function.__annotations__.items() if names_an_array(v)}

    # Values check themselves on creation: let them speak first, in their own words
    before = function.__annotations__.get("return") is Any
    if function.__name__ == "__init__" and before:
        hints = {}
    function.__annotations__ = hints
    return beartype(function)


def names_an_array(hint):
    if isinstance(hint, type) and issubclass(hint, AbstractArray):
        return True
    return any(names_an_array(part) for part in get_args(hint))
