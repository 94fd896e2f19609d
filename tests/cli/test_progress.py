"""Progress is shown only if work takes long."""

import pytest

from clerestory.cli import progress
from clerestory.cli.progress import progress_display


@pytest.fixture
def clock(monkeypatch):
    """A clock that a test moves."""
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def work(clock, seconds, steps, *, quiet=False):
    with progress_display(quiet=quiet) as display:
        report = display("view matrix")
        for step in range(1, steps + 1):
            clock[0] += seconds / steps
            report(step / steps, "1 M paths/s")


def test_short_work_says_nothing(clock, capsys):
    work(clock, 1.9, 100)
    assert capsys.readouterr() == ("", "")


def test_long_work_says_a_line_every_ten_seconds_with_what_is_left(clock, capsys):
    work(clock, 40, 400)
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert captured.out == ""
    assert len(lines) == 4
    assert lines[0] == "view matrix: 5%, 1 M paths/s, 38 s left"


def test_what_is_left_is_said_once_the_rate_is_steady(clock, capsys):
    """Work of 100 s after 20 s of compilation: 1 % after 20 s would mean 2,000 s."""
    with progress_display(quiet=False) as display:
        report = display("view matrix")
        for second in range(1, 120):
            clock[0] += 1
            report(max(0.01, (second - 20) / 100), "note")
    lines = capsys.readouterr().err.splitlines()
    said = {}
    for line in lines:
        share, _, *left = line.removeprefix("view matrix: ").split(", ")
        said[int(share.removesuffix("%"))] = left
    assert not any(left for share, left in said.items() if share < 15)
    later = {share: left for share, left in said.items() if share > 25}
    assert len(later) >= 7
    for share, (left,) in later.items():
        assert int(left.split()[0]) == pytest.approx(100 - share, abs=2)


def test_quiet_work_says_nothing_however_long(clock, capsys):
    work(clock, 400, 400, quiet=True)
    assert capsys.readouterr() == ("", "")


def test_a_terminal_gets_a_bar_that_vanishes(monkeypatch, capsys):
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    monkeypatch.setattr(progress.sys.stderr, "isatty", lambda: True)
    with progress_display(quiet=False) as display:
        report = display("view matrix")
        for share in (0.2, 0.7, 1.0):
            report(share, "1 M paths/s")
    assert capsys.readouterr().out == ""
