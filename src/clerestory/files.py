"""Atomic writing of files, and reading with error messages that name the file."""

import codecs
import csv
import os
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, cast

from clerestory.errors import InputError, OutputError

# Number of characters of a file name that its temporary file's name repeats
_SHOWN_NAME = 40

# Byte order marks of UTF-16
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)

# Flags that open a pipe without waiting for a writer; paths of pipes from a shell
_WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
_PASSED = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")


@contextmanager
def replace_file(path: str | Path) -> Iterator[BinaryIO]:
    """Open a binary stream to a file that replaces `path` if the `with` block succeeds.

    Data are written to a temporary file in the same folder, which is renamed at the
    end; after an error or interruption, an existing file is unchanged.
    """
    with replace_path(path) as temporary, temporary.open("wb") as stream:
        yield cast(BinaryIO, stream)


@contextmanager
def replace_path(path: str | Path) -> Iterator[Path]:
    """Yield an empty temporary file that replaces `path` as in `replace_file`."""
    path = Path(path)
    temporary = None
    if path.exists() and not path.is_file():
        raise OutputError(f"{path}: is a folder, a pipe or a device; a file expected")
    try:
        start = path.name[:_SHOWN_NAME]
        handle, name = tempfile.mkstemp(prefix=f".{start}.", dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        # mkstemp gives access to the owner only; apply the umask instead
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        temporary.replace(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"{path}: cannot be written: {reason}") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write `text` as UTF-8 to `path` atomically; lone surrogates become escapes."""
    with replace_file(path) as stream:
        stream.write(text.encode(errors="backslashreplace"))


def is_file(path: str | Path) -> bool:
    """Whether a file exists; False for names too long for the operating system."""
    try:
        return Path(path).is_file()
    except OSError:
        return False


def read_text(path: str | Path) -> str:
    """Return the text of a file: UTF-8, UTF-16 with byte order mark, else Latin-1."""
    data = read_bytes(path)
    if data.count(0) > len(data) // 4 and not data.startswith(_UTF_16):
        raise InputError("is binary, or not UTF-8; a text file expected", file=path)
    try:
        return data.decode("utf-16" if data.startswith(_UTF_16) else "utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def csv_rows(
    lines: Iterable[str], *, file: str | Path | None = None, separator: str = ","
) -> list[list[str]]:
    """Return the cells of lines of comma-separated values."""
    try:
        return list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        raise InputError(f"no table of values: {error}", file=file) from error


def read_bytes(path: str | Path) -> bytes:
    """Return the bytes of a file.

    Named pipes, devices and the files in /proc, whose size is 0, are not read, since
    they may never end; pipes that a shell passes as `/dev/fd/N` are.
    """
    try:
        with os.fdopen(os.open(path, os.O_RDONLY | _WITHOUT_WAITING), "rb") as stream:
            state = os.fstat(stream.fileno())
            regular = stat.S_ISREG(state.st_mode)
            if regular and (state.st_size or stream.read(1) == b""):
                return stream.read(state.st_size)
            passed = stat.S_ISFIFO(state.st_mode) and str(path).startswith(_PASSED)
            if not (passed or str(path) == os.devnull):
                expected = "is a pipe, a device or a folder; a file expected"
                raise InputError(expected, file=path)
            os.set_blocking(stream.fileno(), True)
            return stream.read()
    except (OSError, ValueError, MemoryError) as error:
        reason = getattr(error, "strerror", None) or str(error) or "too large"
        raise InputError(f"cannot be read: {reason}", file=path) from error


def read_start(path: str | Path, count: int) -> bytes:
    """Return at most `count` bytes from the start of a file; none of other things.

    Pipes, devices and the files in /proc have no start: reading could wait for ever.
    """
    try:
        with os.fdopen(os.open(path, os.O_RDONLY | _WITHOUT_WAITING), "rb") as stream:
            state = os.fstat(stream.fileno())
            sized = stat.S_ISREG(state.st_mode) and state.st_size > 0
            return stream.read(count) if sized else b""
    except (OSError, ValueError):
        return b""


def make_folder(path: str | Path) -> Path:
    """Create a folder for results, with parent folders, and return the path."""
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"{path}: cannot be made: {reason}") from error
    return path
