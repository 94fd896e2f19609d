"""Items are evaluated in a second thread while they are computed."""

import os
import sys
import threading

import pytest
from threadpoolctl import threadpool_info

from clerestory.threads import (
    computed_in_threads,
    evaluated_meanwhile,
    linear_algebra_in_one_thread,
)


def test_items_are_evaluated_in_order_while_they_are_computed():
    together = threading.Barrier(2, timeout=20)

    def computed():
        yield 0
        # Passed only if the first item is evaluated before the second is computed
        together.wait()
        yield from range(1, 50)

    def evaluate(items):
        found = [next(items)]
        together.wait()
        return found + list(items)

    assert evaluated_meanwhile(evaluate, computed(), most=3) == list(range(50))


def test_errors_of_the_evaluation_end_the_computation():
    made = []

    def computed():
        for number in range(1000):
            made.append(number)
            yield number

    def evaluate(items):
        next(items)
        raise ValueError("dark")

    with pytest.raises(ValueError, match="dark"):
        evaluated_meanwhile(evaluate, computed(), most=2)
    assert len(made) < 10


def test_errors_of_the_computation_end_the_evaluation():
    def computed():
        yield 1
        raise ValueError("no light")

    before = threading.active_count()
    with pytest.raises(ValueError, match="no light"):
        evaluated_meanwhile(list, computed(), most=2)
    assert threading.active_count() == before


def test_no_items_are_an_empty_sequence():
    assert evaluated_meanwhile(list, iter(()), most=1) == []


def test_linear_algebra_is_limited_to_one_thread():
    with linear_algebra_in_one_thread():
        assert all(each["num_threads"] == 1 for each in threadpool_info())


def test_the_interval_of_switching_is_restored():
    before = sys.getswitchinterval()
    inside = evaluated_meanwhile(
        lambda items: (list(items), sys.getswitchinterval()), range(3), most=1
    )
    assert inside[0] == [0, 1, 2]
    assert inside[1] < before
    assert sys.getswitchinterval() == before


def test_items_computed_in_threads_keep_their_order():
    """The first item ends last; the results are in the order of the items."""
    last = threading.Event()

    def compute(number):
        if number == 0 and (os.cpu_count() or 1) > 1:
            assert last.wait(timeout=20)
        last.set()
        return number

    assert list(computed_in_threads(compute, range(20))) == list(range(20))


def test_an_error_in_a_thread_ends_the_computation():
    def compute(number):
        if number == 3:
            raise ValueError("dark")
        return number

    with pytest.raises(ValueError, match="dark"):
        list(computed_in_threads(compute, range(20)))
