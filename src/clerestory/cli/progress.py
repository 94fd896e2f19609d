"""Progress display and printed lines of commands.

Progress is shown as a bar on a terminal, otherwise as a line every ten seconds.
"""

import importlib
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import typer

from clerestory.escaping import terminal_text
from clerestory.progress import Progress, silent

# Delay before progress is shown [s]
_PATIENCE = 2.0

# Interval between progress lines without a terminal [s]
_LINE_EVERY = 10.0

# Interval at which the completed fraction is recorded [s]; largest ratio of the rates
# in the last half and the last quarter of the elapsed time at which the remaining time
# is shown
_SAMPLE_EVERY, _STEADY = 0.5, 1.25


def say(*lines: str, quiet: bool = False) -> None:
    """Print lines of text unless `quiet`."""
    for line in () if quiet else lines:
        typer.echo(terminal_text(line))


@contextmanager
def progress_display(*, quiet: bool) -> Iterator[Callable[[str], Progress]]:
    """Yield a function that starts the progress display of a phase, given its name.

    The function returns a callback for the completed fraction 0…1 and a short note.
    """
    if quiet:
        yield silent
    elif sys.stderr.isatty():
        with _bars() as bars:
            yield lambda name: _bar(bars, name)
    else:
        yield _lines


def _bars() -> Any:
    # Imported on demand, because Rich takes 0.1 s to load
    rich = importlib.import_module("rich.progress")
    columns = (
        rich.TextColumn("{task.description}", markup=False),
        rich.BarColumn(),
        rich.TextColumn("{task.percentage:3.0f} %  {task.fields[note]}", markup=False),
        rich.TimeElapsedColumn(),
        rich.TextColumn("{task.fields[left]}", markup=False),
    )
    console = importlib.import_module("rich.console").Console(stderr=True)
    return rich.Progress(*columns, console=console, transient=True)


def _bar(bars: Any, name: str) -> Progress:
    # A timer shows the bar, even before the first progress report
    task = bars.add_task(
        terminal_text(name), total=1.0, visible=False, note="", left=""
    )
    remaining = _RemainingTime()
    timer = threading.Timer(_PATIENCE, lambda: bars.update(task, visible=True))
    timer.daemon = True
    timer.start()

    def report(share: float, note: str) -> None:
        left = remaining.words(share)
        bars.update(task, completed=share, note=terminal_text(note), left=left)
        if share >= 1:
            timer.cancel()
            bars.update(task, visible=False)

    return report


def _lines(name: str) -> Progress:
    remaining = _RemainingTime()
    due = [time.monotonic() + _PATIENCE]

    def report(share: float, note: str) -> None:
        left, now = remaining.words(share), time.monotonic()
        if now >= due[0] and 0 < share < 1:
            due[0] = now + _LINE_EVERY
            line = ", ".join(filter(None, (f"{name}: {share:.0%}", note, left)))
            typer.echo(terminal_text(line), err=True)

    return report


class _RemainingTime:
    """Remaining time of a computation, from the rate in the second half of its time.

    Compilation, pilot runs and longer batches make the first fractions poor estimates.
    """

    def __init__(self) -> None:
        self._begin = time.monotonic()
        # Elapsed time [s] and completed fraction, one a second or fewer
        self._reached = [(0.0, 0.0)]

    def words(self, share: float) -> str:
        """Return the remaining time as text; empty until the rate is steady."""
        now = time.monotonic() - self._begin
        half, later = self._before(now / 2), self._before(0.75 * now)
        if now >= self._reached[-1][0] + _SAMPLE_EVERY:
            self._reached.append((now, share))
        if not half[0] < later[0] < now or not half[1] < later[1] < share < 1:
            return ""
        rates = [(share - then) / (now - at) for at, then in (half, later)]
        if not 1 / _STEADY <= rates[0] / rates[1] <= _STEADY:
            return ""
        left = (1 - share) / rates[0]
        return f"{left / 60:.0f} min left" if left >= 120 else f"{left:.0f} s left"

    def _before(self, elapsed: float) -> tuple[float, float]:
        return max(point for point in self._reached if point[0] <= elapsed)
