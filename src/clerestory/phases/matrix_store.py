"""Disk cache of traced matrices, keyed by a fingerprint of their inputs.

A matrix is stored as `NAME-FINGERPRINT.nc`, written atomically: a restarted run traces
only the matrices that are not complete. A new matrix is read back from its file
before use, so that first and later runs compute with identical values.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.escaping import file_stem
from clerestory.files import make_folder
from clerestory.matrix.netcdf import read_netcdf, write_netcdf
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.recent_values import RecentValues

# Functions that trace named matrices, and a block of rows of one matrix
Maker = Callable[[], Mapping[str, TransferMatrix]]
BlockMaker = Callable[[slice], TransferMatrix]

# Number of hexadecimal digits of the fingerprint in a file name (128 bits)
_DIGITS = 32


def block_names(name: str, count: int) -> list[str]:
    """Return the names of the blocks of a matrix, such as "views-0001"."""
    return [f"{name}-{number:04d}" for number in range(1, count + 1)]


class Store(Protocol):
    """Cache of matrices: a folder, or a dry run that only records requests."""

    def path(self, name: str, fingerprint: str) -> Path:
        """Path of the file of a matrix."""

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether a matrix is in the cache."""

    def matrices(
        self, names: Sequence[str], fingerprint: str, make: Maker
    ) -> dict[str, TransferMatrix]:
        """Return cached matrices; if one is missing, trace and store all of them."""

    def blocks(
        self, name: str, fingerprint: str, rows: Sequence[slice], make: BlockMaker
    ) -> tuple[Path, ...]:
        """Store a matrix larger than memory; return the file of each block of rows."""


@dataclass(frozen=True)
class MatrixStore:
    """Folder of traced matrices, created with the first matrix."""

    folder: Path

    def path(self, name: str, fingerprint: str) -> Path:
        """Path of the file of a matrix."""
        return self.folder / f"{file_stem(name)}-{fingerprint[:_DIGITS]}.nc"

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether the file of a matrix exists; the file may be damaged."""
        return self.path(name, fingerprint).is_file()

    def matrix(
        self, name: str, fingerprint: str, make: Callable[[], TransferMatrix]
    ) -> TransferMatrix:
        """Return the cached matrix, or trace and store it."""
        return self.matrices([name], fingerprint, lambda: {name: make()})[name]

    def matrices(
        self, names: Sequence[str], fingerprint: str, make: Maker
    ) -> dict[str, TransferMatrix]:
        """Return cached matrices; if one is missing, trace and store all of them."""
        kept = {name: self._read(self.path(name, fingerprint)) for name in names}
        if None in kept.values():
            make_folder(self.folder)
            made = make()
            for name in names:
                path = self.path(name, fingerprint)
                write_netcdf(path, made[name])
                kept[name] = read_netcdf(path)
        return {name: matrix for name, matrix in kept.items() if matrix is not None}

    def blocks(
        self, name: str, fingerprint: str, rows: Sequence[slice], make: BlockMaker
    ) -> tuple[Path, ...]:
        """Store a matrix larger than memory; return the file of each block of rows."""
        names = block_names(name, len(rows))
        for block, part in zip(names, rows, strict=True):
            self.matrix(block, fingerprint, partial(make, part))
        return tuple(self.path(block, fingerprint) for block in names)

    def _read(self, path: Path) -> TransferMatrix | None:
        # Matrix in the file; None if the file is missing or damaged
        if not path.is_file():
            return None
        try:
            return read_netcdf(path)
        except InputError as error:
            message = f"{path} is damaged ({error.message}); it is traced again"
            warnings.warn(message, ClerestoryWarning, stacklevel=4)
            return None


@dataclass(frozen=True)
class SharedStore:
    """Folder of traced matrices, of which the most recently used stay in memory."""

    store: MatrixStore
    recent: RecentValues

    def path(self, name: str, fingerprint: str) -> Path:
        """Path of the file of a matrix."""
        return self.store.path(name, fingerprint)

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether the file of a matrix exists."""
        return self.store.holds(name, fingerprint)

    def matrices(
        self, names: Sequence[str], fingerprint: str, make: Maker
    ) -> dict[str, TransferMatrix]:
        """Return matrices from memory or files; trace and store missing matrices."""
        return self.recent.value(
            ("matrices", *names, fingerprint),
            lambda: self.store.matrices(names, fingerprint, make),
            size=lambda found: float(sum(map(_bytes, found.values()))),
        )

    def blocks(
        self, name: str, fingerprint: str, rows: Sequence[slice], make: BlockMaker
    ) -> tuple[Path, ...]:
        """Store a matrix larger than memory; return the file of each block of rows."""
        return self.store.blocks(name, fingerprint, rows, make)


def _bytes(matrix: TransferMatrix) -> int:
    parts = matrix.components
    return matrix.values.nbytes + (0 if parts is None else parts.nbytes)
