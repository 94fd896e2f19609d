"""Radiance matrix files, as written by rfluxmtx, gendaymtx, rmtxop and dctimestep.

A text header names the size (NROWS, NCOLS, NCOMP), the encoding (FORMAT) and the
byte order (BigEndian, absent in ASCII); after an empty line follow the values, row by
row, with the components (bands) of an entry interleaved. The file does not label its
rows, columns and components; the caller passes their labels.
"""

import re
import sys
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB, Bands, unnamed_bands
from clerestory.checks import one_of, require
from clerestory.errors import InputError, located
from clerestory.escaping import header_line
from clerestory.files import read_bytes, replace_file
from clerestory.matrix.axis import Axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

Encoding = Literal["ascii", "float", "double"]

_ITEM = {"float": "f4", "double": "f8"}
_LONGEST_HEADER = 1 << 20
_RESERVED = ("NROWS", "NCOLS", "NCOMP", "FORMAT", "BigEndian")


@dataclass(frozen=True)
class _Header:
    # Variables of the text header
    rows: int | None  # None without NROWS: the length of the data gives the number
    columns: int
    channels: int
    encoding: Encoding
    big_endian: bool
    length: int  # length of the header in bytes, with the empty line

    def require_size(self, found: int, what: str, size: int) -> None:
        # Require as many values or bytes as in the header; without NROWS, whole rows
        row = self.columns * self.channels * size
        expected = (self.rows or found // row or 1) * row
        require(
            found == expected,
            f"{found} {what}; {expected} expected for {self.rows or 'whole'} rows of"
            f" {self.columns} columns and {self.channels} components in"
            f" {self.encoding}",
        )


def read_matrix(
    path: str | Path,
    *,
    rows: Axis | None = None,
    columns: Axis | None = None,
    bands: Bands | None = None,
) -> TransferMatrix:
    r"""Return the matrix of a Radiance file.

    Sky matrices of gendaymtx have a row per patch and a column per time step.

    Parameters
    ----------
    rows, columns : axes of the matrix; default: unlabelled
    bands : bands of the components; default: RGB for one or three components, otherwise
        unnamed bands

    Raises
    ------
    InputError : the file is damaged, has another format or values that are not finite,
        or its size differs from `rows`, `columns` and `bands`

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "a.mtx"
    >>> size = path.write_text("#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\n\n0.5 2\n")
    >>> read_matrix(path).values.tolist()
    [[[0.5, 2.0]]]
    """
    data = read_bytes(path)
    return parse_matrix(data, path, rows=rows, columns=columns, bands=bands)[0]


def parse_matrix(
    data: bytes,
    path: str | Path,
    *,
    rows: Axis | None = None,
    columns: Axis | None = None,
    bands: Bands | None = None,
) -> tuple[TransferMatrix, Encoding]:
    """Return the matrix in the content of a file, and its encoding; see `read_matrix`.

    `path` is for messages.
    """
    with located(file=path):
        header = _read_header(data)
        body = memoryview(data)[header.length :]
        read = _read_ascii if header.encoding == "ascii" else _read_binary
        table = read(body, header).reshape(-1, header.columns, header.channels)
        _require_finite(table)
        rows = rows or unknown_axis(table.shape[0])
        columns = columns or unknown_axis(table.shape[1])
        require(
            (rows.size, columns.size) == table.shape[:2],
            f"{table.shape[0]} rows and {table.shape[1]} columns; {rows.describe()} by"
            f" {columns.describe()} expected",
        )
        bands = bands or unnamed_bands(header.channels)
        require(
            header.channels in (1, len(bands)),
            f"{header.channels} components; one, or one for each of the {len(bands)}"
            " bands, expected",
        )
    values = np.ascontiguousarray(np.moveaxis(table, -1, 0))
    return TransferMatrix(values, rows, columns, bands=bands), header.encoding


def write_matrix(
    path: str | Path,
    matrix: TransferMatrix,
    *,
    encoding: Encoding = "float",
    command: str = "",
    header: Mapping[str, str] | None = None,
) -> None:
    """Write the values of a matrix in Radiance's format.

    ASCII numbers have all significant digits. Statistical errors and axis labels are
    not written; use `matrix.netcdf` to store them.

    Parameters
    ----------
    command : command line recorded in the header
    header : further variables of the header, such as LATLONG

    Raises
    ------
    InputError : unknown encoding, or a name of a header variable that is not valid
    OutputError : the file cannot be written
    """
    channels, rows, columns = matrix.values.shape
    write_rows(
        path,
        (row[None] for row in np.moveaxis(matrix.values, 0, -1)),
        shape=(rows, columns, channels),
        encoding=encoding,
        command=command,
        header=header,
    )


def write_rows(
    path: str | Path,
    blocks: Iterable[Float[np.ndarray, "_ column channel"]],
    *,
    shape: tuple[int, int, int],
    encoding: Encoding = "float",
    command: str = "",
    header: Mapping[str, str] | None = None,
) -> None:
    """Write a matrix given as blocks of rows, with one block in memory at a time.

    `shape` gives the numbers of rows, columns and channels of the matrix; `command` and
    `header` are as in `write_matrix`.
    """
    one_of(encoding, "matrix encoding", choices=("ascii", *_ITEM))
    for name in header or {}:
        require(
            re.fullmatch(r"[A-Z][A-Z0-9_]*", name) and name not in _RESERVED,
            f"header variable is {name!r}; capitals, digits and _ expected, and not"
            f" {', '.join(_RESERVED)}",
        )
    rows, columns, channels = shape
    lines = ["#?RADIANCE"]
    lines += [f"\t{header_line(command)}"] if command else []
    lines += [f"{name}= {header_line(text)}" for name, text in (header or {}).items()]
    lines += [f"NROWS={rows}", f"NCOLS={columns}", f"NCOMP={channels}"]
    lines += [] if encoding == "ascii" else [f"BigEndian={int(sys.byteorder == 'big')}"]
    lines += [f"FORMAT={encoding}", "", ""]
    with replace_file(path) as stream:
        stream.write("\n".join(lines).encode())
        for block in blocks:
            if encoding == "ascii":
                stream.writelines(_format_row(row).encode() for row in block)
            else:
                stream.write(np.ascontiguousarray(block, _ITEM[encoding]).data)


def _format_row(row: Float[np.ndarray, "column channel"]) -> str:
    # Write enough digits for the same floating-point numbers to be read back
    digits = 9 if row.dtype == np.float32 else 17
    entry = " ".join([f"%.{digits}g"] * row.shape[1])
    return "\t".join([entry] * row.shape[0]) % tuple(row.ravel().tolist()) + "\n"


def _read_header(data: bytes) -> _Header:
    # Read the variables before the empty line
    require(
        data.startswith(b"#?"),
        "does not start with #?RADIANCE; a Radiance matrix with header expected",
        line=1,
    )
    end = re.compile(rb"\r?\n\r?\n").search(data, 0, _LONGEST_HEADER)
    if end is None:
        raise InputError(
            "no empty line after the header; a complete Radiance matrix expected"
        )
    variables: dict[str, tuple[str, int]] = {}
    for number, line in enumerate(data[: end.start()].decode("latin-1").split("\n"), 1):
        name, found, value = line.partition("=")
        if found:
            variables[name] = (value.strip(), number)

    def count(name: str) -> int | None:
        if name not in variables:
            return None
        text, line = variables[name]
        require(
            re.fullmatch(r"0*[1-9]\d{0,11}", text),
            f"{name}={text[:40]}; a positive whole number expected",
            line=line,
        )
        return int(text)

    encoding, at = variables.get("FORMAT", ("ascii", 1))
    require(
        encoding in ("ascii", *_ITEM),
        f"format is {encoding!r}; ascii, float or double expected",
        line=at,
    )
    columns = count("NCOLS")
    if columns is None:
        raise InputError("no NCOLS in the header; the number of columns expected")
    channels, rows = count("NCOMP") or len(RGB), count("NROWS")
    big_endian = variables.get("BigEndian", ("0", 0))[0] == "1"
    return _Header(rows, columns, channels, encoding, big_endian, end.end())  # type: ignore[arg-type]


def _read_binary(body: memoryview, header: _Header) -> np.ndarray:
    # Check the size before memory is allocated
    item = np.dtype((">" if header.big_endian else "<") + _ITEM[header.encoding])
    header.require_size(len(body), "bytes of data", item.itemsize)
    return np.frombuffer(body, item).astype(item.newbyteorder("="), copy=False)


def _read_ascii(body: memoryview, header: _Header) -> np.ndarray:
    # Parse without preallocation: the size in the header may be wrong
    text = str(body, "latin-1")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            flat = np.fromstring(text, dtype=float, sep=" ")
    except (DeprecationWarning, ValueError) as error:
        raise _bad_number(text) from error
    header.require_size(len(flat), "values", 1)
    return flat


def _bad_number(text: str) -> InputError:
    for word in text.split():
        try:
            float(word)
        except ValueError:
            return InputError(f"one value is {word[:40]!r}; a number expected")
    return InputError("values have unusual separators; numbers and spaces expected")


def _require_finite(table: Float[np.ndarray, "row column channel"]) -> None:
    # A finite sum shows that all values are finite, without an array of flags
    with np.errstate(all="ignore"):
        if np.isfinite(np.sum(table, dtype=float)):
            return
    bad = np.argwhere(~np.isfinite(table))
    if len(bad):
        row, column, channel = bad[0]
        raise InputError(
            f"the value in row {row + 1}, column {column + 1} is"
            f" {table[row, column, channel]} ({len(bad)} such values); finite numbers"
            " expected"
        )
