"""Threads: linear algebra in one thread, parallel computation and evaluation."""

import functools
import os
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import copy_context
from queue import Full, Queue
from typing import TypeVar

from threadpoolctl import ThreadpoolController

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")

# Interval at which a full queue is checked for the end of the evaluation [s]
_WAIT = 0.5

# Largest number of threads, as each holds the results of an item
_MOST_THREADS = 8

# Time after which a thread hands over to another [s]: Python's 5 ms would make each of
# the two threads wait for the other in most of its array operations
_SWITCH = 2e-4


@contextmanager
def linear_algebra_in_one_thread() -> Iterator[None]:
    """Limit the linear algebra libraries to one thread.

    This is faster where other threads or processes occupy the processor.
    """
    with _libraries().limit(limits=1):
        yield


@functools.cache
def _libraries() -> ThreadpoolController:
    # Controller of the number of threads of the linear algebra libraries
    return ThreadpoolController()


def computed_in_threads(
    compute: Callable[[_Item], _Result], items: Iterable[_Item]
) -> Iterator[_Result]:
    """Yield `compute(item)` for each item in order, with a thread per processor.

    This is faster than threads of the linear algebra library, which wait for each other
    in every product, if the products of an item are small.

    >>> list(computed_in_threads(abs, [-1, 2, -3]))
    [1, 2, 3]
    """
    count = min(os.cpu_count() or 1, _MOST_THREADS)
    waiting: deque[Future[_Result]] = deque()
    with (
        linear_algebra_in_one_thread(),
        _switching(_SWITCH),
        ThreadPoolExecutor(count) as pool,
    ):
        for item in items:
            waiting.append(pool.submit(copy_context().run, compute, item))
            # One item more than threads: none is idle while the caller uses a result
            if len(waiting) > count:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


def evaluated_meanwhile(
    evaluate: Callable[[Iterator[_Item]], _Result], items: Iterable[_Item], *, most: int
) -> _Result:
    """Return `evaluate(items)`, evaluated in a second thread as items are computed.

    `most` is the largest number of items that wait for their evaluation.

    >>> evaluated_meanwhile(sum, (n * n for n in range(4)), most=2)
    14
    """
    # Each item in a tuple; an empty tuple is the end
    waiting: Queue[tuple[_Item, ...]] = Queue(most)

    def computed() -> Iterator[_Item]:
        while found := waiting.get():
            yield from found

    with _switching(_SWITCH), ThreadPoolExecutor(1) as pool:
        future = pool.submit(copy_context().run, evaluate, computed())
        try:
            for item in items:
                if not _put(waiting, (item,), future):
                    break
        finally:
            _put(waiting, (), future)
        return future.result()


@contextmanager
def _switching(interval: float) -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(interval)
    try:
        yield
    finally:
        sys.setswitchinterval(before)


def _put(queue: "Queue[_Item]", item: _Item, future: "Future[_Result]") -> bool:
    # Wait until there is room; false if the evaluation has ended
    while not future.done():
        try:
            queue.put(item, timeout=_WAIT)
        except Full:
            continue
        return True
    return False
