"""Cache of lowered scenes between successive jobs.

A scene of millions of triangles takes longer to build than the daylight matrix of one
of its windows takes to trace. Mitsuba objects built for one job are therefore kept in
the executor's cache, and the next job reuses equal objects. Objects not yet reused are
released *before* a new object is built.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_in_use: ContextVar["SceneCache | None"] = ContextVar("cache", default=None)


class SceneCache:
    """Cache of the Mitsuba objects built for the last job.

    Examples
    --------
    >>> cache = SceneCache()
    >>> built = []
    >>> for name in ("hall", "hall", "room"):
    ...     with cache.preparing():
    ...         _ = cached((name,), lambda: built.append(name))
    >>> built
    ['hall', 'room']
    """

    def __init__(self) -> None:
        self._kept: dict[tuple[object, ...], Any] = {}
        self._former: set[tuple[object, ...]] = set()

    @contextmanager
    def preparing(self) -> Iterator[None]:
        """Use this cache for `cached` in a with block, then release unused objects."""
        self._former = set(self._kept)
        token = _in_use.set(self)
        try:
            yield
        finally:
            _in_use.reset(token)
            self._let_go()

    def take(self, key: tuple[object, ...], build: Callable[[], Any]) -> Any:
        """Return the object cached for a key, or build it."""
        self._former.discard(key)
        if key not in self._kept:
            self._let_go()
            self._kept[key] = build()
        return self._kept[key]

    def _let_go(self) -> None:
        for key in self._former:
            del self._kept[key]
        self._former = set()


def cached(key: tuple[object, ...], build: Callable[[], Any]) -> Any:
    """Return the object cached for a key, or build it; without a cache, always build.

    The key consists of all inputs of the object; scenes and windows are compared by
    identity.
    """
    cache = _in_use.get()
    return build() if cache is None else cache.take(key, build)
