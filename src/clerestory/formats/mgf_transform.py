"""Stack of nested transforms and arrays in MGF."""

import math
from dataclasses import dataclass, field

from clerestory.checks import require
from clerestory.scene.transform import Transform, parse_transform

_DEEPEST = 64
_MOST_DIMENSIONS = 8
_MOST_INSTANCES = 1_000_000


@dataclass
class _Level:
    # An open transform or array; `start`: index of the first enclosed statement
    words: list[str]
    outer: Transform
    start: int
    counters: list[int] = field(default_factory=list)  # indices into `words`
    counts: list[int] = field(default_factory=list)

    @property
    def instance(self) -> str | None:
        if not self.counters:
            return None
        return "a" + ".".join(self.words[k] for k in self.counters)

    def transform(self) -> Transform:
        own, taken = parse_transform(self.words)
        rest = " ".join(self.words[taken:])[:20]
        options = "-t, -rx, -ry, -rz, -s, -mx, -my, -mz, -i and -a"
        require(not rest, f"xf with {rest!r}; {options} expected")
        return own.then(self.outer)

    def advance(self) -> bool:
        # Go to the next instance, last dimension first; return False after the last one
        for at, count in reversed(list(zip(self.counters, self.counts, strict=True))):
            following = int(self.words[at]) + 1
            if following < count:
                self.words[at] = str(following)
                return True
            self.words[at] = "0"
        return False


@dataclass
class TransformStack:
    """Stack of open transforms, outermost first."""

    transform: Transform
    levels: list[_Level] = field(default_factory=list)

    @property
    def instances(self) -> list[str]:
        """Name of the current instance of each open array."""
        names = [level.instance for level in self.levels]
        return [name for name in names if name is not None]

    def follow(self, words: list[str], at: int) -> int | None:
        """Open or close a transform; return the index at which an array repeats.

        `words`: options of xform; without options, the innermost transform is closed.
        `at`: index of the current statement.
        """
        if words:
            nested = len(self.levels)
            require(nested < _DEEPEST, f"more than {_DEEPEST} nested transforms")
            level = _level(words, self.transform, at + 1)
            instances = math.prod(n for x in [*self.levels, level] for n in x.counts)
            message = f"{instances:.3g} instances; {_MOST_INSTANCES} at most expected"
            require(instances <= _MOST_INSTANCES, message)
            self.transform = level.transform()
            self.levels.append(level)
            return None
        require(self.levels, "xf without options ends a transform, but none is open")
        level = self.levels[-1]
        if level.advance():
            self.transform = level.transform()
            return level.start
        self.transform = self.levels.pop().outer
        return None


def _level(words: list[str], outer: Transform, start: int) -> _Level:
    # Replace each `-a` of an array by `-i` with the instance number, from 0
    level = _Level(list(words), outer, start)
    for at, word in enumerate(words):
        if word != "-a":
            continue
        count = words[at + 1] if at + 1 < len(words) else ""
        whole = count.isascii() and count.isdecimal() and len(count) < 10
        require(whole, f"xf -a {count[:20]!r}; a number of instances expected")
        level.words[at : at + 2] = ["-i", "0"]
        level.counters.append(at + 1)
        level.counts.append(int(count))
    message = f"an array of more than {_MOST_DIMENSIONS} dimensions"
    require(len(level.counts) <= _MOST_DIMENSIONS, message)
    return level
