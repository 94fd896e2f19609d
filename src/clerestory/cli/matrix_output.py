"""Writers of matrices in NetCDF (.nc) or Radiance format, by file extension."""

import importlib
from collections.abc import Mapping

import numpy as np

from clerestory.cli.command import COMMAND_LINE
from clerestory.cli.requests.common import MatrixFile
from clerestory.matrix.radiance_format import write_matrix, write_rows
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.sky.patch_radiance import SkyMatrix


def write_any_matrix(
    file: MatrixFile, matrix: TransferMatrix, *, header: Mapping[str, str] | None = None
) -> None:
    """Write a matrix; only `.nc` files contain labels and standard errors.

    Radiance programs expect three channels, so a single channel is repeated. The header
    of Radiance's format has the command line and the variables of `header`.
    """
    if file.output.suffix.lower() == ".nc":
        # Imported on demand, because the NetCDF library loads slowly
        netcdf = importlib.import_module("clerestory.matrix.netcdf")
        netcdf.write_netcdf(file.output, matrix)
        return
    shape = len(matrix.bands), *matrix.values.shape[1:]
    values = np.broadcast_to(matrix.values, shape)
    write_matrix(
        file.output,
        TransferMatrix(values, matrix.rows, matrix.columns, bands=matrix.bands),
        encoding=file.encoding,
        command=COMMAND_LINE.get(),
        header=header,
    )


def write_sky(file: MatrixFile, sky: SkyMatrix, *, luminance: bool = False) -> None:
    """Write the radiance or the luminance of a sky matrix.

    Radiance in Radiance's format is written row by row to limit memory.
    """
    if luminance or file.output.suffix.lower() == ".nc":
        matrix = sky.luminance() if luminance else sky.to_transfer_matrix()
        write_any_matrix(file, matrix, header=_provenance(sky))
        return
    write_rows(
        file.output,
        sky.row_blocks(),
        shape=(len(sky.partition), len(sky.times), len(sky.bands)),
        encoding=file.encoding,
        command=COMMAND_LINE.get(),
        header=_provenance(sky),
    )


def _provenance(sky: SkyMatrix) -> dict[str, str]:
    # Header variables of a sky: LATLONG as gendaymtx, and all other attributes
    given = {name.upper(): str(value) for name, value in sky.attributes.items()}
    latitude, longitude = given.pop("LATITUDE_DEG", ""), given.pop("LONGITUDE_DEG", "")
    if latitude:
        given["LATLONG"] = f"{latitude} {longitude}"
    return given
