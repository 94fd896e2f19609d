"""Interruption of a command by SIGINT, SIGTERM or SIGHUP.

Job schedulers stop a process by SIGTERM, closed terminals by SIGHUP. All of them end a
command as Ctrl-C does: `with` blocks delete temporary files, release locks and stop
worker processes. The next run reuses the stored matrices.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


class Interruption:
    """Signal that interrupted a command.

    Attributes
    ----------
    signal : number of the signal; SIGINT until another one is received
    happened : whether a signal was received
    """

    signal: int = signal.SIGINT
    happened: bool = False

    def status(self) -> int:
        """Return the exit status of shells for the signal: 130, 143 or 129."""
        return 128 + self.signal

    def receive(self, number: int, _frame: FrameType | None) -> None:
        """Handle a signal as Python handles SIGINT."""
        self.signal, self.happened = number, True
        raise KeyboardInterrupt


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Make SIGINT, SIGTERM and SIGHUP raise `KeyboardInterrupt` in the `with` block.

    Signals that are ignored, as SIGHUP under `nohup`, remain ignored.
    """
    received = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield received
        return
    known = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    before = {each: signal.getsignal(each) for each in known}
    usual = (signal.SIG_DFL, signal.default_int_handler)
    taken = [each for each in known if before[each] in usual]
    for each in taken:
        signal.signal(each, received.receive)
    try:
        yield received
    finally:
        for each in taken:
            signal.signal(each, before[each])
