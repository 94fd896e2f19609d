"""Values that several simulations have in common, computed once and kept in memory.

The variants of a study share most of what they are computed from: traced matrices,
weather, skies and the products D S. The values used last are kept, up to a number of
bytes.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, TypeVar

Value = TypeVar("Value")


@dataclass(eq=False)
class RecentValues:
    """Values by key, the most recently used last; without `most_bytes`, none is kept.

    >>> recent = RecentValues(most_bytes=100)
    >>> [recent.value("a", lambda: 3, size=60), recent.value("a", lambda: 4, size=60)]
    [3, 3]
    >>> recent.value("b", lambda: 5, size=60), recent.value("a", lambda: 6, size=60)
    (5, 6)
    """

    most_bytes: float = 0.0
    _kept: OrderedDict[Hashable, tuple[Any, float]] = field(default_factory=OrderedDict)

    def value(
        self,
        key: Hashable,
        make: Callable[[], Value],
        *,
        size: float | Callable[[Value], float] = 0.0,
        of: tuple[object, ...] = (),
    ) -> Value:
        """Return the value of a key, computed by `make` if it is not kept.

        Parameters
        ----------
        size : size of the value [bytes], or a function of the value
        of : objects that the value is computed from; they must be the same objects
        """
        if not self.most_bytes:
            return make()
        whole = (key, *map(id, of))
        if whole not in self._kept:
            made = make()
            taken = size(made) if callable(size) else size
            # The objects in `of` are kept too, so that no other object gets their id
            self._kept[whole] = ((made, of), taken)
        self._kept.move_to_end(whole)
        found: Value = self._kept[whole][0][0]
        while len(self._kept) > 1 and self._total() > self.most_bytes:
            self._kept.popitem(last=False)
        return found

    def _total(self) -> float:
        return sum(taken for _, taken in self._kept.values())
