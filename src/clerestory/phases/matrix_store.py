"""Traced matrices kept on disk, found again by all that they depend on.

A matrix lies in `NAME-FINGERPRINT.nc`. It appears there whole or not at all, so a
run that is killed and started again traces only what it had not finished. A
matrix just traced is read back before it is used: the first run and the next one
go on with the same bits.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import make_folder
from clerestory.matrix.netcdf import read_netcdf, write_netcdf
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint

__all__ = ["MatrixStore", "Store", "fingerprint"]

# Hexadecimal digits of the fingerprint in a file name: 128 bits
_DIGITS = 32


def block_names(name: str, count: int) -> list[str]:
    """Return names of the blocks of a matrix, numbered from 1.

    >>> block_names("views", 2)
    ['views-0001', 'views-0002']
    """
    return [f"{name}-{number:04d}" for number in range(1, count + 1)]


class BlockStore(Protocol):
    """Where matrices larger than memory are found again."""

    def blocks(
        self,
        name: str,
        fingerprint: str,
        rows: Sequence[slice],
        make: Callable[[slice], TransferMatrix],
        /,
    ) -> tuple[Path, ...]:
        """Keep a matrix, a file for each block of rows; return the files."""


class Store(BlockStore, Protocol):
    """Where matrices are found again; a folder, or a plan that only takes note."""

    def path(self, name: str, fingerprint: str) -> Path:
        """File of a matrix."""

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether a matrix was kept."""

    def matrices(
        self,
        names: Sequence[str],
        fingerprint: str,
        make: Callable[[], Mapping[str, TransferMatrix]],
    ) -> dict[str, TransferMatrix]:
        """Return matrices that are traced together, or make and keep all of them."""


@dataclass(frozen=True)
class MatrixStore:
    """A folder of traced matrices.

    Attributes
    ----------
    folder : made when the first matrix is kept
    """

    folder: Path

    def path(self, name: str, fingerprint: str) -> Path:
        """File of a matrix; characters that trouble file systems become "_"."""
        safe = "".join(c if c.isalnum() or c in "-_." else "_" for c in name)
        return self.folder / f"{safe}-{fingerprint[:_DIGITS]}.nc"

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether a matrix was kept; it may still turn out to be damaged."""
        return self.path(name, fingerprint).is_file()

    def matrix(
        self, name: str, fingerprint: str, make: Callable[[], TransferMatrix]
    ) -> TransferMatrix:
        """Return the matrix kept under this name and fingerprint, or make and keep it.

        Parameters
        ----------
        name : for people, such as "view-south"
        fingerprint : of all that the matrix depends on
        make : traces the matrix; called when it is not there or is damaged

        Raises
        ------
        OutputError : the folder cannot be written

        Examples
        --------
        >>> import numpy as np, tempfile
        >>> from clerestory.matrix.axis import unknown_axis
        >>> store = MatrixStore(Path(tempfile.mkdtemp()))
        >>> axis = unknown_axis(1)
        >>> make = lambda: TransferMatrix(np.ones((1, 1, 1)), axis, axis)
        >>> store.matrix("one", "00ff", make).values.item()
        1.0
        >>> store.holds("one", "00ff")
        True
        """
        return self.matrices([name], fingerprint, lambda: {name: make()})[name]

    def matrices(
        self,
        names: Sequence[str],
        fingerprint: str,
        make: Callable[[], Mapping[str, TransferMatrix]],
    ) -> dict[str, TransferMatrix]:
        """Return matrices that are traced together, or make and keep all of them."""
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
        self,
        name: str,
        fingerprint: str,
        rows: Sequence[slice],
        make: Callable[[slice], TransferMatrix],
    ) -> tuple[Path, ...]:
        """Keep a matrix larger than memory; return the file of each block of rows.

        Parameters
        ----------
        rows : of the blocks, in order
        make : traces one of them; called when it is not there or is damaged
        """
        names = block_names(name, len(rows))
        for block, part in zip(names, rows, strict=True):
            self.matrix(block, fingerprint, partial(make, part))
        return tuple(self.path(block, fingerprint) for block in names)

    def _read(self, path: Path) -> TransferMatrix | None:
        # None when the matrix is not there, or is there and not to be trusted
        if not path.is_file():
            return None
        try:
            return read_netcdf(path)
        except InputError as error:
            warnings.warn(
                f"{path} is damaged ({error.message}); it is traced again",
                ClerestoryWarning,
                stacklevel=4,
            )
            return None
