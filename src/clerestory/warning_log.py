"""Log of warnings: one entry for each kind of warning, with its number of occurrences.

Warnings are of one kind if their texts differ only in numbers. Digits in names, such as
those of files or sensors, distinguish kinds.
"""

import re
from dataclasses import dataclass, field

# A number that is a word by itself, with or without a unit sign: 12, 1.4, 3e-5, 20 %
_NUMBER = re.compile(r"(?<![\w.\"'/-])\d[\d,.]*(?:e[+-]?\d+)?(?![\w/-])")


@dataclass
class WarningLog:
    """Warnings by kind: first text and number of occurrences.

    >>> log = WarningLog()
    >>> [log.add(f"step {n}: the sky is dark") for n in range(1200)].count(True)
    1
    >>> log.add('sensor "desk.1" is outside'), log.add('sensor "desk.2" is outside')
    (True, True)
    >>> log.lines()[0]
    'step 0: the sky is dark (1,200 such warnings)'
    """

    _first: dict[str, str] = field(default_factory=dict)
    _count: dict[str, int] = field(default_factory=dict)

    def add(self, text: str) -> bool:
        """Add a warning; return whether it is the first of its kind."""
        kind = _NUMBER.sub("0", text)
        self._first.setdefault(kind, text)
        self._count[kind] = self._count.get(kind, 0) + 1
        return self._count[kind] == 1

    def lines(self) -> tuple[str, ...]:
        """Return the first text of each kind, with the number of occurrences if > 1."""
        return tuple(
            text
            if self._count[kind] == 1
            else f"{text} ({self._count[kind]:,} such warnings)"
            for kind, text in self._first.items()
        )

    def repeated(self) -> tuple[str, ...]:
        """Return the lines of the kinds that occurred more than once."""
        pairs = zip(self.lines(), self._count.values(), strict=True)
        return tuple(line for line, count in pairs if count > 1)
