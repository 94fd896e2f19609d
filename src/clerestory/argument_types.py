"""Types of the arguments of public functions and classes, checked at each call.

A value of a wrong type, such as the name of a file in place of what it contains, is an
`InputError` that names the argument. Types are those of the annotations; values within
a type, such as names of choices and ranges of numbers, are checked by the functions.
Sequences of numbers are converted to arrays where arrays are expected.
"""

import functools
import inspect
import numbers
import os
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from itertools import islice
from typing import Any, TypeVar

import numpy as np
from jaxtyping import AbstractArray

from clerestory.errors import InputError

_Function = TypeVar("_Function", bound=Callable[..., Any])
_Class = TypeVar("_Class")

# Functions that return values of a type, for errors about its place
_READERS = {
    "Bsdf": "read_bsdf",
    "Picture": "read_picture",
    "Scene": "read_rad",
    "Sensors": "read_sensors",
    "SkyMatrix": "sky_matrix",
    "Study": "read_study",
    "SunMatrix": "sun_matrix",
    "View": "read_view",
    "Weather": "read_weather",
    "Window": "read_window",
}

# Types of plain values: what is accepted, and the words for it
_PLAIN: dict[Any, tuple[tuple[type, ...], str]] = {
    float: ((numbers.Real,), "a number"),
    int: ((numbers.Integral,), "a whole number"),
    bool: ((bool, np.bool_), "True or False"),
    str: ((str,), "a text"),
    np.ndarray: ((np.ndarray,), "an array"),
    None: ((types.NoneType,), "None"),
    types.NoneType: ((types.NoneType,), "None"),
}

# Largest number of characters of a text in a message, and of items that are checked
_SHOWN, _ITEMS = 40, 64


def checked_arguments(function: _Function) -> _Function:
    """Return a function that requires arguments of the annotated types.

    A list or tuple of numbers becomes an array where an array is expected.

    >>> def area(width: float) -> float:
    ...     return width**2
    >>> checked_arguments(area)("wide")
    Traceback (most recent call last):
    clerestory.errors.InputError: area(): width is 'wide', a str; a number expected
    """
    return typing.cast(_Function, _checked(function, function.__name__, to_arrays=True))


def checked_fields(cls: type[_Class]) -> type[_Class]:
    """Return a dataclass that requires fields of the annotated types.

    >>> from dataclasses import dataclass
    >>> @checked_fields
    ... @dataclass
    ... class Pane:
    ...     width: float
    >>> Pane(width=[1])
    Traceback (most recent call last):
    clerestory.errors.InputError: Pane(): width is a list of int; a number expected
    """
    initialize = _checked(vars(cls)["__init__"], cls.__name__, to_arrays=False)
    type.__setattr__(cls, "__init__", initialize)
    return cls


def _checked(
    function: Callable[..., Any], shown: str, *, to_arrays: bool
) -> Callable[..., Any]:
    # A function that checks its arguments. `to_arrays`: it makes arrays of lists of
    # numbers, as dataclasses do themselves
    signature = inspect.signature(function)

    @functools.wraps(function)
    def checked(*arguments: Any, **keywords: Any) -> Any:
        try:
            bound = signature.bind(*arguments, **keywords)
        except TypeError:
            # Missing or unknown arguments: Python's own message
            return function(*arguments, **keywords)
        for name, value, hint in list(_annotated(signature, bound.arguments)):
            if accepts(value, hint):
                continue
            alone = bound.arguments.get(name) is value
            array = _as_array(value, hint) if alone else None
            if array is None:
                raise InputError(
                    f"{shown}(): {name} is {_described(value)};"
                    f" {_expected(hint)} expected{_source(hint)}"
                )
            if to_arrays:
                bound.arguments[name] = array
        return function(*bound.args, **bound.kwargs)

    return checked


def _annotated(
    signature: inspect.Signature, given: Mapping[str, Any]
) -> Iterable[tuple[str, Any, Any]]:
    # Name, value and type of each argument that is annotated
    for name, value in given.items():
        parameter = signature.parameters[name]
        hint = parameter.annotation
        if parameter.kind is parameter.VAR_POSITIONAL:
            yield from ((name, each, hint) for each in value)
        elif parameter.kind is parameter.VAR_KEYWORD:
            # Keywords of a TypedDict, as those of an effort
            [kind] = typing.get_args(hint) or (None,)
            known = getattr(kind, "__annotations__", {})
            yield from ((key, value[key], known[key]) for key in value if key in known)
        elif hint is not parameter.empty:
            yield name, value, hint


def accepts(value: Any, hint: Any) -> bool:
    """Whether a value is of an annotated type; types that cannot be told are accepted.

    >>> accepts([1, 2.5], list[float]), accepts("two", float | None)
    (True, False)
    """
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return any(accepts(value, each) for each in inner)
    if origin is typing.Literal:
        # Misspelt names are for the function, which lists the right ones
        return isinstance(value, tuple({type(each) for each in inner}))
    if hint in _PLAIN:
        return isinstance(value, _PLAIN[hint][0]) and (
            hint is bool or not isinstance(value, bool)
        )
    if _is_array(hint):
        return isinstance(value, np.ndarray | np.generic) and value.dtype.kind in "biuf"
    if origin is tuple:
        items = value if inner[1:] == (...,) and isinstance(value, tuple | list) else ()
        return isinstance(value, tuple | list | np.ndarray) and all(
            accepts(each, inner[0]) for each in items[:_ITEMS]
        )
    if inspect.isclass(origin):
        return _accepts_items(value, origin, inner)
    if isinstance(hint, type) and issubclass(hint, os.PathLike):
        return isinstance(value, os.PathLike)
    try:
        return not isinstance(hint, type) or isinstance(value, hint)
    except TypeError:
        # A protocol that cannot be tested
        return True


def _accepts_items(value: Any, kind: type, inner: tuple[Any, ...]) -> bool:
    # A text is a sequence of texts by accident only
    if not isinstance(value, kind) or (isinstance(value, str) and kind is not str):
        return False
    if isinstance(value, Mapping):
        return all(accepts(v, inner[1]) for v in islice(value.values(), _ITEMS))
    # Iterators are not consumed
    items = value if isinstance(value, list | tuple) and inner else ()
    return all(accepts(each, inner[0]) for each in items[:_ITEMS])


def _as_array(value: Any, hint: Any) -> np.ndarray | None:
    # The array that a sequence of numbers stands for; None where none is expected
    kinds = [kind for kind in typing.get_args(hint) or (hint,) if _is_array(kind)]
    if not kinds or not isinstance(value, list | tuple):
        return None
    try:
        array = np.asarray(value)
    except ValueError:
        return None  # rows of different lengths
    if array.dtype.kind not in "biuf":
        return None
    fractions = not any("int" in str(name) for name in kinds[0].dtypes)
    return array.astype(float) if fractions and array.dtype.kind != "b" else array


def _is_array(hint: Any) -> bool:
    return isinstance(hint, type) and issubclass(hint, AbstractArray)


def _described(value: Any) -> str:
    kind = type(value).__name__
    if isinstance(value, str | int | float):
        shown = repr(value)
        shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}…'"
        return f"{shown}, {_with_article(kind)}"
    if isinstance(value, list | tuple) and value:
        return f"{_with_article(kind)} of {type(value[0]).__name__}"
    return _with_article(kind) if value is not None else "None"


def _expected(hint: Any) -> str:
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(dict.fromkeys(map(_expected, inner)))
    if origin is typing.Literal:
        return f"one of {', '.join(map(repr, inner))}"
    if hint in _PLAIN:
        return _PLAIN[hint][1]
    if _is_array(hint):
        return "a NumPy array of numbers"
    if inspect.isclass(origin) and issubclass(origin, Mapping):
        return f"a mapping to {_name(inner[1])}"
    if inspect.isclass(origin) and issubclass(origin, Iterable):
        return f"a sequence of {_name(inner[0])}"
    if origin is not None:
        return "a function"
    return _with_article(_name(hint))


def _name(hint: Any) -> str:
    # Name of one class or of the alternatives
    if _is_array(hint):
        return "arrays"
    inner = typing.get_args(hint)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return " or ".join(map(_name, inner))
    return str(getattr(hint, "__name__", "values"))


def _source(hint: Any) -> str:
    # The function that gives the expected value, if there is one
    kinds = [hint, *typing.get_args(hint)]
    known = [_READERS[_name(kind)] for kind in kinds if _name(kind) in _READERS]
    return f", as from {known[0]}()" if known else ""


def _with_article(name: str) -> str:
    return f"{'an' if name[:1] in 'AEIOaeio' else 'a'} {name}"
