"""Matrices read by the suffix of their file, and written as sets of pictures."""

from pathlib import Path

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import InputError
from clerestory.image.picture_files import write_picture
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.radiance_format import read_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.picture_matrices import Camera


def read_any_matrix(path: Path) -> TransferMatrix:
    """Return a matrix; of a BSDF file its visible transmission from outside."""
    match path.suffix.lower():
        case ".nc":
            return read_netcdf(path)
        case ".xml":
            return read_bsdf(path).transmission_matrix()
        case _:
            return read_matrix(path)


def write_pictures(path: Path, matrix: TransferMatrix, camera: Camera) -> None:
    """Write one picture a column, numbered from 0 as the %03d of the name says."""
    try:
        names = [path.name % number for number in range(matrix.columns.size)]
    except (TypeError, ValueError):
        raise InputError(
            "a name with one number such as V_%03d.hdr expected", file=path
        ) from None
    for number, name in enumerate(names):
        picture = camera.picture(matrix.values[:, :, number])
        write_picture(picture, path.with_name(name))
