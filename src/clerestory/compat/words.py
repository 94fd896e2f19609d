"""Options of Radiance's command lines.

An option is a word such as -ab, with a fixed number of arguments; a switch such as -w
may have a sign (-w-). Words that are not options are operands. Options that only affect
how Radiance samples are accepted and ignored.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.transform import number

# Numbers of arguments of options: NUMBERS takes all numbers that follow
NUMBERS = -1

_SIGNS = frozenset("+-01yntfYNTF")

# Options of rcontrib and rtrace without an equivalent, with numbers of arguments
IGNORED: Mapping[str, int] = {
    **dict.fromkeys(("-aa", "-ar", "-as", "-dc", "-dp", "-dr", "-ds"), 1),
    **dict.fromkeys(("-dt", "-lr", "-lw", "-ld", "-ms", "-ss", "-st", "-n", "-t"), 1),
    **dict.fromkeys(("-u", "-v", "-w", "-bv", "-dv", "-r", "-V"), 0),
    **dict.fromkeys(("-aw", "-bj", "-e", "-lm"), 1),
    "-av": 3,
}


@dataclass(frozen=True)
class Word:
    """An option with its arguments; an operand has the name "".

    `joined` is whether the argument follows without a space, as in -ff.
    """

    name: str
    arguments: tuple[str, ...] = ()
    sign: str = ""
    joined: bool = False

    @property
    def text(self) -> str:
        """The single argument, or the operand."""
        return self.arguments[0]

    @property
    def on(self) -> bool:
        """Whether a switch is on."""
        return self.sign not in ("-", "0", "f", "F", "n", "N")


@dataclass(frozen=True)
class Grammar:
    """Options of a program, with the number of arguments of each.

    `prefixes` are options whose argument follows without a space, as -ff.
    """

    program: str
    options: Mapping[str, int]
    prefixes: tuple[str, ...] = ()

    def words(self, given: Sequence[str]) -> Iterator[Word]:
        """Yield options and operands in their order.

        Raises
        ------
        InputError : an option is unknown, or its arguments are missing
        """
        left = list(given)
        while left:
            word = left.pop(0)
            if not word.startswith("-") or word == "-":
                yield Word("", (word,))
                continue
            name, sign = self._name(word)
            if name in self.prefixes and word not in self.options:
                yield Word(name, (word[len(name) :],), joined=True)
                continue
            count = self._count(name, left)
            require(
                len(left) >= count,
                f"{self.program}: option {name} has {len(left)} arguments; {count}"
                " expected",
            )
            yield Word(name, tuple(left[:count]), sign)
            del left[:count]

    def _name(self, word: str) -> tuple[str, str]:
        # Name and sign of an option
        if word in self.options:
            return word, ""
        if self.options.get(word[:-1]) == 0 and word[-1] in _SIGNS:
            return word[:-1], word[-1]
        for prefix in self.prefixes:
            if word.startswith(prefix) and len(word) > len(prefix):
                return prefix, ""
        known = " ".join(sorted({*self.options, *self.prefixes}))
        raise InputError(
            f"{self.program}: option is {word}, which is not supported; one of {known}"
            " expected"
        )

    def _count(self, name: str, left: Sequence[str]) -> int:
        count = self.options[name]
        if count != NUMBERS:
            return count
        numeric = [number(word) is not None for word in left]
        return numeric.index(False) if False in numeric else len(left)


def whole(word: Word, program: str, *, least: int = 0) -> int:
    """Return the argument of an option as a whole number."""
    value = number(word.text)
    if value is None or value != int(value) or value < least:
        raise InputError(
            f"{program}: the argument of {word.name} is {word.text!r}; a whole number"
            f" of at least {least} expected"
        )
    return int(value)


def reals(word: Word, program: str) -> tuple[float, ...]:
    """Return the arguments of an option as numbers."""
    values = []
    for text in word.arguments:
        value = number(text)
        if value is None:
            raise InputError(
                f"{program}: an argument of {word.name} is {text!r}; a number expected"
            )
        values.append(value)
    return tuple(values)
