"""Parallel map over one or several processes.

Linear algebra is limited to one thread per process, as the matrices are small.
"""

import functools
import multiprocessing
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from clerestory.progress import Progress

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
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(self.processes, mp_context=context) as pool:
            return _reported(pool.map(alone, values, chunksize=4), report, len(values))


IN_SERIES = Workers()


def _reported(
    results: Iterable[_Result], report: Progress, count: int
) -> list[_Result]:
    done = []
    for number, result in enumerate(results, 1):
        done.append(result)
        report(number / count, f"{number} of {count}")
    return done


def _alone(function: Callable[..., _Result], values: tuple[object, ...]) -> _Result:
    with _libraries().limit(limits=1):
        return function(*values)


@functools.cache
def _libraries() -> ThreadpoolController:
    # Controller of the number of threads of the linear algebra libraries
    return ThreadpoolController()
