"""Validated access to JSON documents, with JSON paths for error messages."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np
from jaxtyping import Float

from clerestory import files
from clerestory.errors import InputError


@final
@dataclass(frozen=True, eq=False)
class Item:
    """A JSON object with its file and its path in the document.

    Attributes
    ----------
    value : members of the object
    where : path from the root of the document, such as `rooms[0].faces[2]`
    file : name of the file, for error messages
    """

    value: dict[str, Any]
    where: str
    file: str

    def wrong(self, key: str, expected: str) -> InputError:
        """Return an error about the value of a member."""
        place = f"{self.where}.{key}" if self.where else key
        shown = json.dumps(self.value.get(key), default=str)
        shown = shown if len(shown) <= 40 else shown[:37] + "…"
        return InputError(f"{place}: got {shown}; {expected} expected", file=self.file)

    def item(self, key: str) -> "Item":
        """Return a member whose value is an object; an empty object if missing."""
        value = self.value.get(key)
        if value is None:
            value = {}
        if not isinstance(value, dict):
            raise self.wrong(key, "an object")
        return Item(value, f"{self.where}.{key}".lstrip("."), self.file)

    def items(self, key: str) -> Iterator["Item"]:
        """Yield the objects in a member that is a list; none if it is missing."""
        value = self.value.get(key)
        if value is None:
            return
        if not isinstance(value, list):
            raise self.wrong(key, "a list")
        for number, one in enumerate(value):
            place = f"{self.where}.{key}[{number}]".lstrip(".")
            if not isinstance(one, dict):
                raise InputError(f"{place}: an object expected", file=self.file)
            yield Item(one, place, self.file)

    def text(self, key: str, default: str | None = None) -> str:
        """Return a member whose value is text."""
        value = self.value.get(key)
        if value is None and default is not None:
            return default
        if not isinstance(value, str):
            raise self.wrong(key, "a text")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """Return a member whose value is a finite number."""
        value = self.value.get(key)
        if value is None and default is not None:
            return default
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.wrong(key, "a number")
        try:
            number = float(value)
        except OverflowError:
            number = np.inf
        if not np.isfinite(number):
            raise self.wrong(key, "a finite number")
        return number

    def points(self, key: str, least: int = 1) -> Float[np.ndarray, "point 3"]:
        """Return a member whose value is a list of points."""
        return self._points(self.value.get(key), key, least)

    def loops(self, key: str) -> list[Float[np.ndarray, "point 3"]]:
        """Return a member that is a list of point lists; empty if it is missing."""
        value = self.value.get(key)
        if value is None:
            return []
        if not isinstance(value, list):
            raise self.wrong(key, "a list of lists of points")
        return [self._points(one, key, 3) for one in value]

    def vector(
        self, key: str, default: tuple[float, float, float] | None = None
    ) -> Float[np.ndarray, "3"]:
        """Return a member whose value is a list of three numbers."""
        if self.value.get(key) is None and default is not None:
            return np.array(default, dtype=float)
        found = self._points([self.value.get(key)], key, 1)
        return np.asarray(found[0])

    def _points(self, value: Any, key: str, least: int) -> np.ndarray:
        expected = f"{least} or more points of three numbers"
        if not isinstance(value, list) or len(value) < least:
            raise self.wrong(key, expected)
        plain = all(
            isinstance(p, list)
            and len(p) == 3
            and all(isinstance(x, int | float) and not isinstance(x, bool) for x in p)
            for p in value
        )
        if not plain:
            raise self.wrong(key, expected)
        try:
            points = np.array(value, dtype=float)
        except OverflowError as error:
            raise self.wrong(key, expected) from error
        if not np.all(np.isfinite(points)):
            raise self.wrong(key, expected)
        return points


def read_json(path: str | Path) -> Item:
    """Return the object in a JSON file."""
    value = files.read_json(path)
    if not isinstance(value, dict):
        raise InputError("an object at the root expected", file=path)
    return Item(value, "", str(path))
