"""Primitives of Radiance scene files, with checks of the arguments.

A primitive has a modifier, a type, a name, string arguments and real arguments. The
parser of scene files is in the package `radiance`.
"""

import warnings
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import finite, not_negative
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.scene.material import Material, Source
from clerestory.scene.pattern import Pattern
from clerestory.scene.transform import LARGEST, Transform, number, parse_transform


@dataclass(frozen=True, eq=False)
class Primitive:
    """A primitive `modifier kind name` with its string and real arguments."""

    modifier: str
    kind: str
    name: str
    strings: tuple[str, ...]
    reals: tuple[float, ...]
    line: int


def primitive(
    modifier: str,
    kind: str,
    name: str,
    reals: npt.ArrayLike = (),
    strings: tuple[str, ...] = (),
) -> Primitive:
    """Return a primitive that is not from a file, with line number 0."""
    finite(reals, f'a number of {kind} "{name}"')
    return Primitive(modifier, kind, name, strings, tuple(np.ravel(reals).tolist()), 0)


@dataclass(frozen=True, eq=False)
class Arguments:
    """Arguments of a primitive, with checks; errors give file and line."""

    item: Primitive
    file: str

    @property
    def source(self) -> Source:
        """File and line of the primitive."""
        return Source(self.file, self.item.line)

    @property
    def labels(self) -> tuple[str, str, Source]:
        """Modifier and name of a surface, with its file and line."""
        return self.item.modifier, self.item.name, self.source

    def reals(
        self, *counts: int, strings: bool = False
    ) -> Float[np.ndarray, " numbers"]:
        """Return the real arguments; `counts` are the valid numbers of arguments.

        String arguments are an error unless `strings` is set.
        """
        if not strings and self.item.strings:
            raise self.error(
                f"{len(self.item.strings)} string arguments; none expected"
            )
        expected = " or ".join(map(str, counts))
        given = self.item.reals
        if len(given) not in counts:
            raise self.error(f"{len(given)} numbers; {expected} expected")
        self._limit(max(map(abs, given), default=0))
        return np.array(given)

    def strings(self, least: int, what: str) -> tuple[str, ...]:
        """Return the string arguments; at least `least` are required."""
        words = self.item.strings
        if len(words) < least:
            raise self.error(f"{len(words)} string arguments; {what} expected")
        return words

    def share(
        self, what: str, value: Float[np.ndarray, " numbers"]
    ) -> Float[np.ndarray, " numbers"]:
        """Return reflectances or transmittances; warn if above 1, fail if negative."""
        not_negative(value, what)
        if value.max() > 1:
            self.doubt(
                f"{what} is {value.max():g}, which violates energy conservation;"
                " 0 to 1 expected"
            )
        return value

    def full_angle(self, degrees: float) -> None:
        """Raise an error unless the full angle of a cone is above 0 and at most 360."""
        if not 0 < degrees <= 360:
            raise self.error(f"angle is {degrees:g}°; more than 0 to 360 expected")

    def constant(self, what: str, at: int) -> float:
        """Return the string argument of index `at` as a number."""
        word = self.item.strings[at]
        value = number(word)
        if value is None:
            raise self.error(f'{what} is "{word}"; a plain number expected')
        self._limit(value)
        return value

    def _limit(self, value: float) -> None:
        if abs(value) > LARGEST:
            raise self.error(
                f"an argument exceeds {LARGEST:.0e}; a smaller number expected"
            )

    def transform(self, at: int) -> Transform:
        """Return the transform in the string arguments from index `at` on."""
        words = list(self.item.strings[at:])
        with self.located():
            transform, taken = parse_transform(words)
        if taken < len(words):
            raise self.error(
                f'"{words[taken]}" in the transform;'
                " -t -rx -ry -rz -s -mx -my -mz -i expected"
            )
        return transform

    @property
    def subject(self) -> str:
        """Type and name of the primitive, for messages."""
        return f'{self.item.kind} "{self.item.name}"'

    def located(self) -> AbstractContextManager[None]:
        """Return a context manager that adds the file and line to error messages."""
        return located(file=self.file, line=self.item.line, subject=self.subject)

    def error(self, message: str) -> InputError:
        """Return an error about the primitive."""
        message = f"{self.subject}: {message}"
        return InputError(message, file=self.file, line=self.item.line)

    def doubt(self, message: str) -> None:
        """Warn about an unusual but valid argument."""
        text = f"{self.file}:{self.item.line}: {self.subject}: {message}"
        warnings.warn(text, ClerestoryWarning, stacklevel=2)


@dataclass(frozen=True, eq=False)
class Definition(Arguments):
    """Arguments of a material, with access to the materials and files that they name.

    `placed` is the transform of the scene file. The functions return a material by
    name, the BSDF in a file, the vector of three expressions from an index on (a
    pattern if it varies), the foreground fraction of a mixture, and the specular
    reflection and transmission of a BRTDfunc.
    """

    placed: Transform
    named: Callable[[str], Material]
    bsdf: Callable[[str], Bsdf]
    vector: Callable[[int, Transform], Vector | Pattern]
    share_of_foreground: Callable[[], float | Pattern]
    coefficients: Callable[[], tuple[Pattern, Pattern]]

    def oriented(self, at: int) -> Transform:
        """Return the transform in the string arguments, followed by `placed`."""
        with self.located():
            return self.transform(at).then(self.placed)

    def alternate(self) -> Material | None:
        """Return the material named by the optional single string argument."""
        words = self.item.strings
        if len(words) > 1:
            raise self.error(f"{len(words)} string arguments; 0 or 1 expected")
        return self.named(words[0]) if words else None


Readers = Mapping[str, Callable[[Definition], Material]]
