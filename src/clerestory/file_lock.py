"""Locks of result files and folders, so that two runs do not write the same one.

A lock is a small file with the process, machine and time of the run that holds it. The
operating system releases it however the process ends. Locks are valid between machines
on network file systems that support them (NFS with its lock service, Lustre, GPFS).
"""

import os
import platform
import stat
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

from clerestory.errors import ClerestoryWarning, OutputError, one_line

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

# First word of a lock file; largest number of its bytes that are read
_HEAD, _LONGEST = b"process ", 300


@contextmanager
def locked(path: str | Path, *, lock: str | Path | None = None) -> Iterator[None]:
    """Keep other runs from writing a file or folder during the `with` block.

    Parameters
    ----------
    path : file or folder that is written
    lock : path of the lock file; by default, `path` with ".lock" added

    Raises
    ------
    OutputError : another run holds the lock, or its file cannot be written
    """
    path = Path(path)
    place = Path(lock or f"{path}.lock")
    if fcntl is None:
        yield
        return
    try:
        stream = _acquired(path, place)
    except OSError as error:
        reason = error.strerror or str(error)
        message = f"{path}: cannot be written: {place.name}: {reason}"
        raise OutputError(message) from error
    with stream:
        now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
        stream.truncate(0)
        stream.write(_HEAD + f"{os.getpid()} on {platform.node()}, {now}".encode())
        try:
            yield
        finally:
            place.unlink(missing_ok=True)


def _acquired(path: Path, place: Path) -> BinaryIO:
    # Open and lock the lock file; another run may delete it at the same time
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK
    while True:
        stream = os.fdopen(os.open(place, flags, 0o666), "r+b", buffering=0)
        opened = os.fstat(stream.fileno())
        written = stream.read(_LONGEST) if stat.S_ISREG(opened.st_mode) else b"?"
        if written and not written.startswith(_HEAD):
            stream.close()
            raise OutputError(f"{place}: not a lock file of clerestory; delete it")
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            stream.close()
            owner = one_line(written.decode(errors="replace")) or "started just now"
            message = f"{path}: another run writes here ({owner}); wait until it ends"
            raise OutputError(f"{message}, or choose another output") from None
        except OSError as error:
            message = f"{path}: the file system has no locks ({error.strerror})"
            message += "; do not start a second run with the same output"
            warnings.warn(message, ClerestoryWarning, stacklevel=5)
            return stream
        if _is(place, opened):
            return stream
        stream.close()


def _is(place: Path, opened: os.stat_result) -> bool:
    # Whether an open file still has its name
    try:
        return os.path.samestat(opened, place.lstat())
    except FileNotFoundError:
        return False
