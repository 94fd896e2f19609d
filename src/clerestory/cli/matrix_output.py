"""Matrices written by the suffix of the file: .nc, else Radiance's format."""

from pathlib import Path

import numpy as np

from clerestory.matrix.netcdf import write_netcdf
from clerestory.matrix.radiance_format import Encoding, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix


def write_any_matrix(
    path: Path, matrix: TransferMatrix, *, encoding: Encoding, command: str
) -> None:
    """Write a matrix; `.nc` keeps labels and errors, Radiance's format does not.

    Radiance's programs expect three channels, so a grey matrix is written three times.
    """
    if path.suffix.lower() == ".nc":
        write_netcdf(path, matrix)
        return
    values = np.broadcast_to(matrix.values, (3, *matrix.values.shape[1:]))
    colour = TransferMatrix(values, matrix.rows, matrix.columns)
    write_matrix(path, colour, encoding=encoding, command=command)
