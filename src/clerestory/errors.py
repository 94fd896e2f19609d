"""Errors and warnings of the package.

    ClerestoryError
    ├── InputError      a file, an argument or a study is invalid   exit status 2
    │   └── MatrixError     two matrices are incompatible
    ├── DeviceError     no usable compute device or LLVM            exit status 1
    └── OutputError     a result could not be written               exit status 1

Every message is one line: location, fault and expected input.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# Largest number of characters of a message and of a word
_LONGEST_MESSAGE, _LONGEST_WORD = 400, 80

# Largest number of characters of the path before a message, and of both
_LONGEST_PATH, _LONGEST_TEXT = 240, 499


def one_line(text: str) -> str:
    r"""Return a text as one line of printable characters, with long words cut.

    >>> one_line("value 'a\nb'; " + 100 * "9" + " expected")[:60]
    "value 'a b'; 99999999999999999999999999999999999999999999999"
    """
    words = "".join(c if c.isprintable() else " " for c in text).split()
    cut = (w if len(w) <= _LONGEST_WORD else f"{w[:_LONGEST_WORD]}…" for w in words)
    line = " ".join(cut)
    return line if len(line) <= _LONGEST_MESSAGE else f"{line[:_LONGEST_MESSAGE]}…"


def _short_path(path: str) -> str:
    # Printable characters of a path, without the middle of a long one
    shown = "".join(c if c.isprintable() else "?" for c in path)
    half = _LONGEST_PATH // 2
    return shown if len(shown) <= 2 * half else f"{shown[:half]}…{shown[-half:]}"


class ClerestoryError(Exception):
    """Base class of the errors of this package."""

    exit_status = 1


class InputError(ClerestoryError):
    """A file, an argument or a study is invalid.

    Parameters
    ----------
    message : fault and expected input
    file, line : file and line number of the fault

    Examples
    --------
    >>> print(InputError("unknown material type 'foo'", file="room.rad", line=41))
    room.rad:41: unknown material type 'foo'
    """

    exit_status = 2

    def __init__(
        self, message: str, *, file: str | Path | None = None, line: int | None = None
    ) -> None:
        message = one_line(message)
        self.message, self.file, self.line = message, file, line
        place = "" if file is None else f"{_short_path(str(file))}:"
        place += "" if line is None else f"{line}:"
        super().__init__(f"{place} {message}".strip()[:_LONGEST_TEXT])


class MatrixError(InputError):
    """Two matrices are incompatible, or a matrix lacks the requested data."""


class DeviceError(ClerestoryError):
    """No compute device is usable, or its compiler fails."""


class OutputError(ClerestoryError):
    """A result could not be written."""


@contextmanager
def located(
    *, file: str | Path | None, line: int | None = None, subject: str = ""
) -> Iterator[None]:
    """Add a location to an `InputError` without file that the `with` block raises.

    >>> with located(file="room.rad", line=41, subject='sphere "s"'):
    ...     raise InputError("radius is 0")
    Traceback (most recent call last):
    clerestory.errors.InputError: room.rad:41: sphere "s": radius is 0
    """
    try:
        yield
    except InputError as error:
        if error.file is not None:
            raise
        message = f"{subject}: {error.message}" if subject else error.message
        raise InputError(message, file=file, line=error.line or line) from error


class ClerestoryWarning(UserWarning):
    """Input is usable but physically doubtful; the message quantifies the deviation."""
