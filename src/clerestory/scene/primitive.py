"""Primitives of Radiance's scene language as values, and checks of their arguments.

A material is defined by a primitive: a type, a name, strings and numbers. The text of
the language is read in `radiance`.
"""

import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.directions import unit
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.scene.material import Material, Source
from clerestory.scene.pattern import Pattern
from clerestory.scene.transform import LARGEST, Transform, number, parse_transform


@dataclass(frozen=True, eq=False)
class Primitive:
    """`modifier kind name`, with its string and real arguments."""

    modifier: str
    kind: str
    name: str
    strings: tuple[str, ...]
    reals: tuple[float, ...]
    line: int


@dataclass(frozen=True, eq=False)
class Arguments:
    """The arguments of a primitive, with checks that name file and line.

    Attributes
    ----------
    item : the primitive
    file : where it is
    """

    item: Primitive
    file: str

    @property
    def source(self) -> Source:
        """File and line of the primitive."""
        return Source(self.file, self.item.line)

    @property
    def labels(self) -> tuple[str, str, Source]:
        """Material, name and source of a surface."""
        return self.item.modifier, self.item.name, self.source

    def reals(self, *counts: int) -> Float[np.ndarray, " numbers"]:
        """Return the numbers, if as many as one of `counts`."""
        expected = " or ".join(map(str, counts))
        given = self.item.reals
        if len(given) not in counts:
            raise self.error(f"{len(given)} numbers; {expected} expected")
        value = np.array(given)
        if len(value) and np.abs(value).max() > LARGEST:
            raise self.error(f"a number beyond {LARGEST:.0e}")
        return value

    def no_strings(self) -> None:
        """Refuse string arguments."""
        if self.item.strings:
            raise self.error(
                f"{len(self.item.strings)} string arguments; none expected"
            )

    def share(
        self, what: str, value: Float[np.ndarray, " numbers"]
    ) -> Float[np.ndarray, " numbers"]:
        """Return the numbers, if not negative; warn of those above 1."""
        if value.min() < 0:
            raise self.error(f"{what} is {value.min():g}; 0 to 1 expected")
        if value.max() > 1:
            self.doubt(
                f"{what} is {value.max():g}, which creates energy; 0 to 1 expected"
            )
        return value

    def fraction(self, what: str, value: float) -> float:
        """Return a number from 0 to 1."""
        if not 0 <= value <= 1:
            raise self.error(f"{what} is {value:g}; 0 to 1 expected")
        return float(value)

    def radiance(self, value: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return a colour without negative channels."""
        if value.min() < 0:
            raise self.error(f"radiance is {value.min():g}; 0 or more expected")
        return value

    def direction(self, vector: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
        """Return the unit vector of a vector other than zero."""
        length = np.linalg.norm(vector)
        if not 0 < length < np.inf:
            raise self.error("its direction has no length")
        return unit(vector)

    def constant(self, what: str, at: int) -> float:
        """Return the number that a string argument spells."""
        word = self.item.strings[at]
        value = number(word)
        if value is None:
            raise self.error(f'{what} is "{word}"; a plain number expected')
        if abs(value) > LARGEST:
            raise self.error(f"a number beyond {LARGEST:.0e}")
        return value

    def transform(self, at: int) -> Transform:
        """Return the transform that the strings from `at` on spell."""
        words = list(self.item.strings[at:])
        with self.located():
            transform, taken = parse_transform(words)
        if taken < len(words):
            raise self.error(
                f'"{words[taken]}" among its transform;'
                " -t -rx -ry -rz -s -mx -my -mz -i expected"
            )
        return transform

    @property
    def subject(self) -> str:
        """Type and name, for messages."""
        return f'{self.item.kind} "{self.item.name}"'

    def located(self) -> AbstractContextManager[None]:
        """Return the context in which errors without a place concern the primitive."""
        return located(file=self.file, line=self.item.line, subject=self.subject)

    def error(self, message: str) -> InputError:
        """Return an error about the primitive."""
        message = f"{self.subject}: {message}"
        return InputError(message, file=self.file, line=self.item.line)

    def doubt(self, message: str) -> None:
        """Warn of something usable but odd."""
        text = f"{self.file}:{self.item.line}: {self.subject}: {message}"
        warnings.warn(text, ClerestoryWarning, stacklevel=2)


@dataclass(frozen=True, eq=False)
class Definition(Arguments):
    """The arguments of a material, and what they may refer to.

    Attributes
    ----------
    placed : transform of the file that holds it
    named : material of a name at this line
    bsdf : BSDF of a file name
    vector : vector that three expressions from a string argument on define, followed by
        file and transform, in the coordinates that a further transform leads to; a
        pattern where it varies
    share_of_foreground : share that the third string argument of a mixture defines
    """

    placed: Transform
    named: Callable[[str], Material]
    bsdf: Callable[[str], Bsdf]
    vector: Callable[[int, Transform], Float[np.ndarray, "3"] | Pattern]
    share_of_foreground: Callable[[], float | Pattern]

    def oriented(self, at: int) -> Transform:
        """Return the transform of strings from `at` on, then that of the file."""
        with self.located():
            return self.transform(at).then(self.placed)

    def alternate(self) -> Material | None:
        """Return the material that the only string argument names, if there is one."""
        words = self.item.strings
        if len(words) > 1:
            raise self.error(f"{len(words)} string arguments; 0 or 1 expected")
        return self.named(words[0]) if words else None
