"""Errors and warnings of the package.

    ClerestoryError
    ├── InputError      a file, an argument or a study is invalid   exit status 2
    │   └── MatrixError     two matrices are incompatible
    ├── DeviceError     no usable compute device or LLVM            exit status 1
    └── OutputError     a result could not be written               exit status 1

Every message is one line: the place, what is wrong, what was expected.
"""

from pathlib import Path


class ClerestoryError(Exception):
    """Root of all errors that this package raises on purpose."""

    exit_status = 1


class InputError(ClerestoryError):
    """Input of the user is invalid.

    Parameters
    ----------
    message : what is wrong and what was expected
    file, line : place of the fault, if it is in a file

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
    """Two matrices are incompatible, or a matrix lacks the requested data."""


class DeviceError(ClerestoryError):
    """No usable compute device, or its compiler fails."""


class OutputError(ClerestoryError):
    """A result could not be written."""


class ClerestoryWarning(UserWarning):
    """Usable but physically doubtful input; the message gives the size of the doubt."""
