"""Warnings are listed by kind, with their number."""

import warnings

import pytest

from clerestory.errors import ClerestoryWarning
from clerestory.study.method_run import RunLog
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


def test_a_run_issues_each_kind_once_and_counts_all():
    log = RunLog()
    with pytest.warns(ClerestoryWarning) as shown:
        for name in ("one", "two"):
            with log.phase(name):
                for step in range(5000):
                    warnings.warn(f"step {step}", ClerestoryWarning, stacklevel=1)
    assert [str(item.message) for item in shown] == ["step 0"]
    assert log.warnings.lines() == ("step 0 (10,000 such warnings)",)


def test_warnings_before_an_error_are_issued():
    log = RunLog()
    with (
        pytest.warns(ClerestoryWarning, match="dark"),
        pytest.raises(ValueError, match="broken"),
        log.phase("read"),
    ):
        warnings.warn("dark", ClerestoryWarning, stacklevel=1)
        raise ValueError("broken")
