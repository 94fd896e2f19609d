"""Errors and warnings of the package, one tree.

    ClerestoryError
    ├── InputError      a file, an argument or a study is wrong     exit status 2
    │   └── MatrixError     two matrices do not fit each other
    ├── DeviceError     no usable compute device or LLVM            exit status 1
    └── OutputError     a result could not be written               exit status 1

Every message is one line: where, what was wrong, what was expected.
"""

from pathlib import Path


class ClerestoryError(Exception):
    """Root of all errors raised on purpose by this package."""

    exit_status = 1


class InputError(ClerestoryError):
    """Something the user handed in is wrong.

    Parameters
    ----------
    message : what was wrong and what was expected
    file, line : where, if the fault lies in a file

    Examples
    --------
    >>> print(InputError("unknown material type 'foo'", file="room.rad", line=41))
    room.rad:41: unknown material type 'foo'
    """

    exit_status = 2

    def __init__(
        self, message: str, *, file: str | Path | None = None, line: int | None = None
    ) -> None:
        self.message, self.file, self.line = message, file, line
        place = "" if file is None else f"{file}:"
        place += "" if line is None else f"{line}:"
        super().__init__(f"{place} {message}".strip())


class MatrixError(InputError):
    """Two matrices do not fit each other, or a matrix lacks what was asked of it."""


class DeviceError(ClerestoryError):
    """No usable compute device, or the compiler behind it does not work."""


class OutputError(ClerestoryError):
    """A result could not be written."""


class ClerestoryWarning(UserWarning):
    """Usable but physically doubtful input; the message gives the size of the doubt."""
