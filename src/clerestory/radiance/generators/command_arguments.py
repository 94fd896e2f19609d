"""The words of a generator's command, taken one by one with checks."""

from dataclasses import dataclass

from clerestory.errors import InputError
from clerestory.scene.transform import LARGEST, number


@dataclass
class Words:
    """A command read from left to right.

    Attributes
    ----------
    program : its name
    words : what stands behind it
    at : how many words have been taken

    Examples
    --------
    >>> words = Words("genbox", ["wood", "desk", "1.5"])
    >>> words.name("a material"), words.name("a name"), words.positive("its width")
    ('wood', 'desk', 1.5)
    """

    program: str
    words: list[str]
    at: int = 0

    @property
    def left(self) -> bool:
        """Whether words are left."""
        return self.at < len(self.words)

    def name(self, what: str) -> str:
        """Take a word."""
        if not self.left:
            raise self.error(f"the command ends where {what} is expected")
        self.at += 1
        return self.words[self.at - 1]

    def real(self, what: str) -> float:
        """Take a number."""
        word = self.name(what)
        value = number(word)
        if value is None or abs(value) > LARGEST:
            raise self.error(f'"{word}" stands where {what} is expected')
        return value

    def positive(self, what: str) -> float:
        """Take a number above 0."""
        value = self.real(what)
        if value <= 0:
            raise self.error(f"{what} is {value:g}; a number above 0 expected")
        return value

    def whole(self, what: str, least: int, most: int) -> int:
        """Take a whole number within limits."""
        value = self.real(what)
        if not (least <= value <= most and value == int(value)):
            raise self.error(
                f"{what} is {value:g}; a whole number from {least} to {most} expected"
            )
        return int(value)

    def option(self) -> str:
        """Take a word that begins with a dash or a plus."""
        word = self.name("an option")
        if word[:1] not in ("-", "+"):
            raise self.error(f'"{word}" stands where an option is expected')
        return word

    def unknown(self, option: str) -> InputError:
        """Return the error for an option that the program does not have here."""
        return self.error(f'the option "{option}" is not known here')

    def error(self, message: str) -> InputError:
        """Return an error that names the program."""
        return InputError(f"{self.program}: {message}")
