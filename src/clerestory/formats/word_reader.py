"""Sequential reader of the words of a file or command."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.scene.transform import LARGEST, number


@dataclass
class WordReader:
    """Reader of words that checks the values.

    Attributes
    ----------
    words : words of a file, or arguments of a command
    program : name of the command; empty for a file
    lines : line number of each word
    decimal_comma : whether a comma is a decimal separator and an empty word means 0
    at : number of words read so far
    """

    words: Sequence[str]
    program: str = ""
    path: str | Path | None = None
    lines: Sequence[int] = ()
    decimal_comma: bool = False
    at: int = 0

    @property
    def left(self) -> bool:
        """Whether unread words remain."""
        return self.at < len(self.words)

    def word(self, what: str) -> str:
        """Read a word."""
        if not self.left:
            text = "command" if self.program else "file"
            raise self.error(f"the {text} ends where {what} is expected")
        self.at += 1
        return self.words[self.at - 1]

    def skip(self, count: int) -> None:
        """Skip a number of words."""
        for _ in range(count):
            self.word("a value")

    def real(self, what: str) -> float:
        """Read a number."""
        word = text = self.word(what)
        if self.decimal_comma:
            text = word.replace(",", ".") or "0"
        value = number(text)
        if value is None or abs(value) > LARGEST:
            raise self.error(f'"{word}" is found where {what} is expected')
        return value

    def positive(self, what: str) -> float:
        """Read a number above 0."""
        value = self.real(what)
        if value <= 0:
            raise self.error(f"{what} is {value:g}; a number above 0 expected")
        return value

    def whole(self, what: str, least: int, most: int) -> int:
        """Read an integer within limits."""
        value = self.real(what)
        if not (least <= value <= most and value == int(value)):
            raise self.error(
                f"{what} is {value:g}; a whole number from {least} to {most} expected"
            )
        return int(value)

    def several(self, count: int, what: str) -> Float[np.ndarray, " count"]:
        """Read `count` numbers."""
        return np.array([self.real(what) for _ in range(count)])

    def option(self) -> str:
        """Read a word that begins with a dash or a plus."""
        word = self.word("an option")
        if word[:1] not in ("-", "+"):
            raise self.error(f'"{word}" is found where an option is expected')
        return word

    def unknown(self, option: str) -> InputError:
        """Return the error for an unknown option."""
        return self.error(f'the option "{option}" is not supported')

    def error(self, message: str) -> InputError:
        """Return an error about the last word read; it names the command or file."""
        if self.path is None:
            return InputError(f"{self.program}: {message}")
        line = self.lines[max(self.at - 1, 0)] if self.lines else None
        return InputError(message, file=self.path, line=line)
