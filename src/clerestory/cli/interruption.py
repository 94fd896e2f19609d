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

_NAMES = ("SIGTERM", "SIGHUP")


class Interruption:
    """Signal that interrupted a command.

    Attributes
    ----------
    signal : number of the signal; SIGINT until another one is received
    """

    signal: int = signal.SIGINT

    def status(self) -> int:
        """Return the exit status of shells for the signal: 130, 143 or 129."""
        return 128 + self.signal

    def receive(self, number: int, _frame: FrameType | None) -> None:
        """Handle a signal as Python handles SIGINT."""
        self.signal = number
        raise KeyboardInterrupt


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Make SIGTERM and SIGHUP raise `KeyboardInterrupt` during the `with` block.

    Signals that are ignored, as SIGHUP under `nohup`, remain ignored.
    """
    received = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield received
        return
    known = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    before = {each: signal.getsignal(each) for each in known}
    taken = [each for each in known if before[each] == signal.SIG_DFL]
    for each in taken:
        signal.signal(each, received.receive)
    try:
        yield received
    finally:
        for each in taken:
            signal.signal(each, signal.SIG_DFL)
