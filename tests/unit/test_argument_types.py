"""Public functions and classes refuse values of wrong types, naming the argument.

Functions and classes are those of the public interface, all of them; the wrong value is
given for one argument at a time, among values of the right types without content.
"""

import dataclasses
import inspect
import types
import typing
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from jaxtyping import Float, Int

import clerestory
from clerestory.argument_types import accepts, checked_arguments, checked_fields
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems

PUBLIC = {name: getattr(clerestory, name) for name in clerestory.__all__}
CHECKED = {
    name: value
    for name, value in PUBLIC.items()
    if inspect.isfunction(value)
    or (dataclasses.is_dataclass(value) and name != "Effort")
}


class Wrong:
    """Of no type that a function expects."""


def parameters(name):
    """Parameters with a type, but for those that accept any value."""
    found = inspect.signature(CHECKED[name]).parameters.values()
    named = [each for each in found if each.kind is not each.VAR_KEYWORD]
    return [each for each in named if not accepts(Wrong(), each.annotation)]


def stand_in(hint):
    """A value of a type, without content."""
    inner = typing.get_args(hint)
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        return stand_in(inner[0])
    if typing.get_origin(hint) is typing.Literal:
        return inner[0]
    origin = typing.get_origin(hint) or hint
    plain = 1, 0.5, "", True, None, Path(), np.zeros(3), {}, (), np.float32
    candidates = *plain, datetime(2026, 1, 1, tzinfo=UTC), lambda: None
    for each in candidates:
        if accepts(each, hint):
            return each
    return blank(origin)


def blank(cls):
    """An object of a class that was never initialized."""
    concrete = type(cls.__name__, (cls,), {})
    concrete.__abstractmethods__ = frozenset()
    return object.__new__(concrete)


def call_with(name, wrong):
    """Call a function with one wrong argument."""
    positional, keywords = [], {}
    known = {each.name for each in parameters(name)}
    for each in inspect.signature(CHECKED[name]).parameters.values():
        if each.name not in known:  # any value is accepted
            if each.default is each.empty and each.kind is each.POSITIONAL_OR_KEYWORD:
                positional.append(None)
            continue
        value = Wrong() if each.name == wrong else stand_in(each.annotation)
        if each.kind is each.KEYWORD_ONLY:
            keywords[each.name] = value
        else:
            positional.append(value)
    CHECKED[name](*positional, **keywords)


@pytest.mark.parametrize("name", CHECKED)
def test_a_wrong_type_is_an_error_that_names_the_argument(name):
    for each in parameters(name):
        with pytest.raises(InputError, match=r" expected") as caught:
            call_with(name, each.name)
        message = str(caught.value)
        assert message.startswith(f"{name}(): {each.name} is a Wrong; ")
        assert "\n" not in message


def test_every_function_that_takes_values_is_checked():
    unchecked = {name for name in CHECKED if not parameters(name)}
    assert not unchecked


def test_keywords_of_an_effort_are_checked():
    given = blank(clerestory.Scene), blank(clerestory.Window)
    with pytest.raises(InputError, match=r"samples is 'many', a str; a whole number"):
        clerestory.daylight_matrix(*given, samples="many")


def test_a_file_name_in_place_of_its_content_names_the_reader():
    expected = r"scene is 'room.rad', a str; a Scene expected, as from read_rad\(\)"
    with pytest.raises(InputError, match=expected):
        clerestory.render("room.rad", clerestory.View(), columns=4, rows=4)


def test_items_of_sequences_are_checked():
    message = r"ShadedWindow\(\): states is a tuple of str; a sequence of ShadeState"
    with pytest.raises(InputError, match=message):
        clerestory.ShadedWindow(blank(clerestory.Window), ("up", "down"))


def test_one_window_in_place_of_several_is_an_error():
    room, window = blank(clerestory.Scene), blank(clerestory.Window)
    with pytest.raises(InputError, match=r"windows is a Window; a sequence of Window"):
        clerestory.view_matrices(room, window, sensors=blank(clerestory.Sensors))


def test_classes_accept_lists_that_they_make_arrays_of():
    @checked_fields
    @dataclasses.dataclass
    class Desk:
        position: Float[np.ndarray, "3"]

    assert Desk([1, 2, 0.8]).position == [1, 2, 0.8]
    with pytest.raises(InputError, match="position is a list of str; a NumPy array"):
        Desk(["one", "two", "three"])


def test_functions_make_arrays_of_lists():
    @checked_arguments
    def total(
        weight: Float[np.ndarray, " n"], index: Int[np.ndarray, " n"] | None = None
    ):
        return weight if index is None else weight[index]

    assert total([1, 2]).dtype == float
    assert total((1.0, 2.5), [1]).tolist() == [2.5]
    with pytest.raises(InputError, match="weight is a list of list; a NumPy array"):
        total([[1.0], [1.0, 2.0]])
    with pytest.raises(InputError, match="weight is 'x', a str; a NumPy array"):
        total("x")


@pytest.mark.parametrize(
    ("value", "hint", "valid"),
    [
        (np.float32(0.5), float, True),
        (np.int64(3), int, True),
        (True, float, False),
        (2.0, int, False),
        ("a", typing.Sequence[str], False),
        (["a"], typing.Sequence[str], True),
        ({"a": 1.0}, Mapping[str, float], True),
        ({"a": "b"}, Mapping[str, float], False),
        (Path("room.rad"), str | Path, True),
        (None, float | None, True),
        (iter(["a"]), typing.Iterable[str], True),
        (klems("quarter"), typing.Any, True),
    ],
)
def test_values_of_plain_types(value, hint, valid):
    assert accepts(value, hint) == valid
