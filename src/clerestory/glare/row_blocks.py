"""Parallel evaluation of pictures in blocks of rows that fit in the cache."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

# Pixels per block, so that several arrays fit in the cache of a processor core
_PIXELS = 24_000
_MOST_THREADS = 8


def by_rows(work: Callable[[slice], None], rows: int, columns: int) -> None:
    """Call `work` in parallel with slices that cover all rows.

    >>> seen = []
    >>> by_rows(lambda some: seen.append(some.stop - some.start), 100, 1000)
    >>> sum(seen)
    100
    """
    size = max(1, _PIXELS // columns)
    blocks = [slice(at, min(at + size, rows)) for at in range(0, rows, size)]
    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_THREADS)) as pool:
        list(pool.map(work, blocks))
