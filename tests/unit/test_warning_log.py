"""Warnings are listed by kind, with their number."""

import warnings

import pytest

from clerestory.errors import ClerestoryWarning
from clerestory.study.run_log import RunLog
from clerestory.warning_log import WarningLog


def test_texts_that_differ_in_numbers_are_of_one_kind():
    log = WarningLog()
    texts = [
        "picture 1: 1.4 pixels, 3e-5 sr, 12 % (2,000 of 4,000)",
        "picture 17: 2 pixels, 1 sr, 3 % (1 of 9)",
        'window "north1" is dark',
        'window "north2" is dark',
        "room2.rad:41: face without area",
        "room2.rad:42: face without area",
        "room3.rad:41: face without area",
    ]
    first = [log.add(text) for text in texts]
    assert first == [True, False, True, True, True, False, True]
    assert log.repeated() == (
        f"{texts[0]} (2 such warnings)",
        f"{texts[4]} (2 such warnings)",
    )


def steps(log, name, count=5000):
    with log.phase(name):
        for step in range(count):
            warnings.warn(f"step {step}", ClerestoryWarning, stacklevel=1)


def test_a_run_issues_each_kind_once_and_counts_all():
    log = RunLog()
    with pytest.warns(ClerestoryWarning) as shown:
        steps(log, "one")
    steps(log, "two")
    assert [str(item.message) for item in shown] == ["step 0"]
    assert log.warnings.lines() == ("step 0 (10,000 such warnings)",)


def test_warnings_before_an_error_are_issued():
    def broken(log):
        with log.phase("read"):
            warnings.warn("dark", ClerestoryWarning, stacklevel=1)
            int("broken")

    def tried():
        with pytest.raises(ValueError, match="broken"):
            broken(RunLog())

    with pytest.warns(ClerestoryWarning, match="dark"):
        tried()
