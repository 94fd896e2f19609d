"""Writers of matrices in NetCDF (.nc) or Radiance format, by file extension."""

import importlib
from pathlib import Path

import numpy as np

from clerestory.matrix.radiance_format import Encoding, write_matrix, write_rows
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.sky.patch_radiance import SkyMatrix


def write_any_matrix(
    path: Path, matrix: TransferMatrix, *, encoding: Encoding, command: str
) -> None:
    """Write a matrix; only `.nc` files contain labels and standard errors.

    Radiance programs expect three components, so a single channel is repeated.
    """
    if path.suffix.lower() == ".nc":
        # Imported on demand, because the NetCDF library loads slowly
        importlib.import_module("clerestory.matrix.netcdf").write_netcdf(path, matrix)
        return
    shape = len(matrix.bands), *matrix.values.shape[1:]
    values = np.broadcast_to(matrix.values, shape)
    whole = TransferMatrix(values, matrix.rows, matrix.columns, bands=matrix.bands)
    write_matrix(path, whole, encoding=encoding, command=command)


def write_sky(path: Path, sky: SkyMatrix, *, encoding: Encoding, command: str) -> None:
    """Write a sky matrix; Radiance format is written row by row to limit memory."""
    if path.suffix.lower() == ".nc":
        dense = sky.to_transfer_matrix()
        write_any_matrix(path, dense, encoding=encoding, command=command)
        return
    shape = (len(sky.partition), len(sky.times), len(sky.bands))
    write_rows(path, sky.row_blocks(), shape=shape, encoding=encoding, command=command)
