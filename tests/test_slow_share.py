"""The share of slow tests that a run executes fits its time, and turns."""

import slow_share

TESTS = [f"tests/test_{n % 5}.py::test_{n % 7}[{n}]" for n in range(200)]
KNOWN = {test: 5.0 + n % 20 for n, test in enumerate(TESTS)}


def test_a_share_takes_no_longer_than_asked():
    chosen = slow_share.choose(TESTS, seconds=600, choice="a", known=KNOWN)
    assert 400 < slow_share.expected(chosen, KNOWN) <= 600


def test_the_same_text_chooses_the_same_tests():
    first = slow_share.choose(TESTS, seconds=600, choice="a", known=KNOWN)
    again = slow_share.choose(TESTS[::-1], seconds=600, choice="a", known=KNOWN)
    assert first == again


def test_every_test_is_in_one_of_the_parts():
    seen = set()
    for commit in range(60):
        seen |= slow_share.choose(TESTS, seconds=600, choice=str(commit), known=KNOWN)
    assert seen == set(TESTS)


def test_a_test_that_was_never_timed_counts_as_a_minute():
    assert slow_share.expected(["new"], {}) == 60
