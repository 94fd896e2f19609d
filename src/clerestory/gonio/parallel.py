"""Parallel map over one or several processes.

Linear algebra is limited to one thread per process, as its matrices are small.
"""

import functools
import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from clerestory.progress import Progress

# Smallest number of values for which parallel processes are started.
_WORTH_IT = 16

_Value = TypeVar("_Value")
_Result = TypeVar("_Result")


def silent(_share: float, _note: str) -> None:
    """Report nothing."""


def map_in_order(
    function: Callable[[_Value], _Result],
    values: Sequence[_Value],
    *,
    processes: int = 1,
    report: Progress = silent,
) -> list[_Result]:
    """Apply a function to each value; the result does not depend on `processes`.

    Parameters
    ----------
    function : function at module level, so that other processes can import it
    report : function called with the fraction done and a note

    Examples
    --------
    >>> map_in_order(abs, [-1, 2])
    [1, 2]
    """
    results: list[_Result] = []

    def add(result: _Result) -> None:
        results.append(result)
        done = len(results)
        report(done / len(values), f"{done} of {len(values)}")

    alone = functools.partial(_alone, function)
    if processes <= 1 or len(values) < _WORTH_IT:
        for value in values:
            add(alone(value))
        return results
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        for result in pool.map(alone, values, chunksize=4):
            add(result)
    return results


def _alone(function: Callable[[_Value], _Result], value: _Value) -> _Result:
    with _libraries().limit(limits=1):
        return function(value)


@functools.cache
def _libraries() -> ThreadpoolController:
    # Controller of the number of threads of the linear algebra libraries
    return ThreadpoolController()
