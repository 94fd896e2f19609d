"""Parallel map over one or several processes.

Linear algebra is limited to one thread per process, as the matrices are small.
"""

import functools
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

from clerestory.progress import Progress
from clerestory.threads import linear_algebra_in_one_thread

_FEWEST = 16  # smallest number of values for which parallel processes are started

_Result = TypeVar("_Result")


@dataclass(frozen=True)
class Workers:
    """Number of processes, and function that returns a progress callback per phase."""

    processes: int = 1
    progress: Callable[[str], Progress] = lambda _name: lambda _share, _note: None

    def map(
        self,
        phase: str,
        function: Callable[..., _Result],
        values: Sequence[tuple[object, ...]],
    ) -> list[_Result]:
        """Call a function with each tuple of arguments; in parallel for many tuples.

        The function must be at module level, so that other processes can import it.

        >>> Workers().map("powers", pow, [(2, 3), (3, 2)])
        [8, 9]
        """
        report, alone = self.progress(phase), functools.partial(_alone, function)
        if self.processes <= 1 or len(values) < _FEWEST:
            return _reported(map(alone, values), report, len(values))
        with _pool(self.processes) as pool:
            return _reported(pool.map(alone, values, chunksize=4), report, len(values))


IN_SERIES = Workers()


@contextmanager
def _pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    # Pool of processes that end with the `with` block; errors terminate them
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        processes, multiprocessing.get_context("spawn"), initializer=_attend
    )
    try:
        yield pool
    except BaseException:
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _attend() -> None:
    # Leave interruptions to the parent process, and end when it ends
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _reported(
    results: Iterable[_Result], report: Progress, count: int
) -> list[_Result]:
    done = []
    for number, result in enumerate(results, 1):
        done.append(result)
        report(number / count, f"{number} of {count}")
    return done


def _alone(function: Callable[..., _Result], values: tuple[object, ...]) -> _Result:
    with linear_algebra_in_one_thread():
        return function(*values)
