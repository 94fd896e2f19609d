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
        rich.TextColumn("left"),
        rich.TimeRemainingColumn(),
    )
    console = importlib.import_module("rich.console").Console(stderr=True)
    return rich.Progress(*columns, console=console, transient=True)


def _bar(bars: Any, name: str) -> Progress:
    # A timer shows the bar, even before the first progress report
    task = bars.add_task(terminal_text(name), total=1.0, visible=False, note="")
    timer = threading.Timer(_PATIENCE, lambda: bars.update(task, visible=True))
    timer.daemon = True
    timer.start()

    def report(share: float, note: str) -> None:
        bars.update(task, completed=share, note=terminal_text(note))
        if share >= 1:
            timer.cancel()
            bars.update(task, visible=False)

    return report


def _lines(name: str) -> Progress:
    begin = time.monotonic()
    due = [begin + _PATIENCE]

    def report(share: float, note: str) -> None:
        now = time.monotonic()
        if now >= due[0] and 0 < share < 1:
            due[0] = now + _LINE_EVERY
            left = (now - begin) * (1 - share) / share
            line = f"{name}: {share:.0%}, {note}, {left:.0f} s left"
            typer.echo(terminal_text(line), err=True)

    return report
