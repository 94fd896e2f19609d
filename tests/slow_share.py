"""Choice of the slow tests that one run executes.

All slow tests together take hours. Continuous integration runs a share of them that
takes a given time, chosen by a text such as the name of the commit, so that every test
has its turn. What each test took last is kept in a file beside this one
(`scripts/test --all --record-slow`).
"""

import hashlib
import json
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

RECORD = Path(__file__).with_name("slow_seconds.json")

# Assumed of a test that was never recorded [s]
UNKNOWN = 60.0

# Most cases of one function that are chosen as a whole
GROUP = 8


def read_record() -> dict[str, float]:
    """Seconds that each slow test took when it was recorded."""
    return json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}


def choose(
    tests: Iterable[str], *, seconds: float, choice: str, known: Mapping[str, float]
) -> set[str]:
    """Return tests that together take at most some time.

    Cases of one test function stay together, eight at a time, since they often share
    a fixture that takes longest.

    >>> known = {"a": 30.0, "b": 40.0, "c": 50.0}
    >>> sorted(choose(known, seconds=90, choice="1f3a", known=known))
    ['b', 'c']
    """

    def order(text: str) -> str:
        return hashlib.sha256(f"{choice} {text}".encode()).hexdigest()

    functions = defaultdict(list)
    for test in sorted(tests, key=order):
        functions[test.split("[")[0]].append(test)
    groups = [
        cases[first : first + GROUP]
        for cases in functions.values()
        for first in range(0, len(cases), GROUP)
    ]
    chosen, left = set(), seconds
    for group in sorted(groups, key=lambda group: order(group[0])):
        needed = expected(group, known)
        if needed <= left:
            chosen.update(group)
            left -= needed
    return chosen


def expected(tests: Iterable[str], known: Mapping[str, float]) -> float:
    """Return what tests take in all, by their record [s]."""
    return sum(known.get(test, UNKNOWN) for test in tests)


def describe(chosen: set[str], count: int, known: Mapping[str, float]) -> str:
    """Return one line on the slow tests of a run."""
    minutes = expected(chosen, known) / 60
    new = len(chosen - set(known))
    guess = f", {new} of them never timed" if new else ""
    return f"slow tests: {len(chosen)} of {count}, about {minutes:.0f} min{guess}"


class Durations:
    """Plugin that adds up what slow tests take: set-up, call and tear-down."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)

    def pytest_runtest_logreport(self, report) -> None:
        """Add one phase of a test that was run, here or in a worker process."""
        if "slow" in report.keywords and not report.skipped:
            self.seconds[report.nodeid] += report.duration

    def pytest_sessionfinish(self, session) -> None:
        """Write the record, if asked for, after all worker processes."""
        in_worker = hasattr(session.config, "workerinput")
        if session.config.getoption("--record-slow") and not in_worker:
            record = read_record() | {
                test: round(spent, 1) for test, spent in self.seconds.items()
            }
            lines = json.dumps(record, indent=0, sort_keys=True)
            RECORD.write_text(f"{lines}\n", "utf-8")
