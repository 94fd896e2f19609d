"""Writers of matrices in NetCDF (.nc) or Radiance format, by file extension."""

import importlib

import numpy as np

from clerestory.cli.requests.common import MatrixFile
from clerestory.matrix.radiance_format import write_matrix, write_rows
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.sky.patch_radiance import SkyMatrix


def write_any_matrix(file: MatrixFile, matrix: TransferMatrix, *, command: str) -> None:
    """Write a matrix; only `.nc` files contain labels and standard errors.

    Radiance programs expect three channels, so a single channel is repeated.
    """
    if file.output.suffix.lower() == ".nc":
        # Imported on demand, because the NetCDF library loads slowly
        netcdf = importlib.import_module("clerestory.matrix.netcdf")
        netcdf.write_netcdf(file.output, matrix)
        return
    shape = len(matrix.bands), *matrix.values.shape[1:]
    values = np.broadcast_to(matrix.values, shape)
    whole = TransferMatrix(values, matrix.rows, matrix.columns, bands=matrix.bands)
    write_matrix(file.output, whole, encoding=file.encoding, command=command)


def write_sky(file: MatrixFile, sky: SkyMatrix, *, command: str) -> None:
    """Write a sky matrix; Radiance format is written row by row to limit memory."""
    if file.output.suffix.lower() == ".nc":
        write_any_matrix(file, sky.to_transfer_matrix(), command=command)
        return
    shape, encoding = (
        (len(sky.partition), len(sky.times), len(sky.bands)),
        file.encoding,
    )
    rows = sky.row_blocks()
    write_rows(file.output, rows, shape=shape, encoding=encoding, command=command)
