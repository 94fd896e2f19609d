"""The check of array shapes at every call, for pytest's --jaxtyping-packages.

Other types are left to mypy: tests that pass a wrong one on purpose expect the
message of the package itself. jaxtyping hands over two copies of each function, one
to check arguments before the call, and one to check them again with the result.
"""

from typing import Any, get_args

from beartype import beartype
from jaxtyping import AbstractArray


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
