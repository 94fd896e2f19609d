"""Values that several simulations have in common, computed once and kept in memory.

The variants of a study share most of what they are computed from: traced matrices,
weather, skies and the products D S. The values used last are kept, up to a number of
bytes.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from threading import RLock
from typing import Any, TypeVar

Value = TypeVar("Value")


@dataclass(eq=False)
class RecentValues:
    """Values by key, the most recently used last; without `most_bytes`, none is kept.

    Several threads may ask for values.

    >>> recent = RecentValues(most_bytes=100)
    >>> [recent.value("a", lambda: 3, size=60), recent.value("a", lambda: 4, size=60)]
    [3, 3]
    >>> recent.value("b", lambda: 5, size=60), recent.value("a", lambda: 6, size=60)
    (5, 6)
    """

    most_bytes: float = 0.0
    _kept: OrderedDict[Hashable, tuple[Any, float]] = field(default_factory=OrderedDict)
    _lock: Any = field(default_factory=RLock)

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
        with self._lock:
            kept = self._kept.get(whole)
        if kept is None:
            made = make()
            taken = size(made) if callable(size) else size
            # The objects in `of` are kept too, so that no other object gets their id
            kept = (made, of), taken
        with self._lock:
            self._kept[whole] = kept
            self._kept.move_to_end(whole)
            while len(self._kept) > 1 and self._total() > self.most_bytes:
                self._kept.popitem(last=False)
        found: Value = kept[0][0]
        return found

    def _total(self) -> float:
        return sum(taken for _, taken in self._kept.values())
