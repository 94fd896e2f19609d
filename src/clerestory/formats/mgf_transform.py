"""Stack of nested transforms and arrays in MGF."""

import math
from dataclasses import dataclass, field

import numpy as np

from clerestory.checks import require
from clerestory.scene.transform import Transform, Transforms, array_count, parse_array

_DEEPEST = 64
_MOST_DIMENSIONS = 8
_MOST_INSTANCES = 1_000_000


@dataclass
class _Level:
    # An open transform or array; `start`: index of the first enclosed statement,
    # `instance`: index of the current instance, the last dimension the fastest
    instances: Transforms
    counts: list[int]
    outer: Transform
    start: int
    instance: int = 0

    @property
    def name(self) -> str | None:
        if not self.counts:
            return None
        return "a" + ".".join(map(str, np.unravel_index(self.instance, self.counts)))

    def transform(self) -> Transform:
        return self.instances[self.instance].then(self.outer)

    def advance(self) -> bool:
        # Go to the next instance; return False after the last one
        self.instance += 1
        return self.instance < len(self.instances)


@dataclass
class TransformStack:
    """Stack of open transforms, outermost first."""

    transform: Transform
    levels: list[_Level] = field(default_factory=list)

    @property
    def instances(self) -> list[str]:
        """Name of the current instance of each open array."""
        names = [level.name for level in self.levels]
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
            _require_few(math.prod(len(x.instances) for x in [*self.levels, level]))
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
    dimensions = words.count("-a")
    message = f"an array of more than {_MOST_DIMENSIONS} dimensions"
    require(dimensions <= _MOST_DIMENSIONS, message)
    after = [at for at, word in enumerate(words) if word == "-a"]
    count = math.prod(array_count(words, at) for at in after)
    _require_few(count)
    instances, counts, taken = parse_array(words)
    rest = " ".join(words[taken:])[:20]
    options = "-t, -rx, -ry, -rz, -s, -mx, -my, -mz, -i and -a"
    require(not rest, f"xf with {rest!r}; {options} expected")
    return _Level(instances, counts, outer, start)


def _require_few(instances: int) -> None:
    message = f"{instances:.3g} instances; {_MOST_INSTANCES} at most expected"
    require(instances <= _MOST_INSTANCES, message)
