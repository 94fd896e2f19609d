"""Products with sets of pictures, for dctimestep.

Most calls of dctimestep and rmtxop have no pictures; they do not import this module.
"""

from pathlib import Path

from clerestory.compat.streams import Streams
from clerestory.errors import InputError
from clerestory.image.picture import Picture
from clerestory.image.picture_sets import read_picture_set, write_picture_set
from clerestory.matrix.transfer_matrix import TransferMatrix

__all__ = ["read_picture_set", "write_pictures"]


def write_pictures(
    product: TransferMatrix, like: Picture, output: str | None, streams: Streams
) -> None:
    """Write a picture for each column: a numbered set, or one to standard output."""
    if output is not None:
        write_picture_set(Path(output), product, like, command=streams.command)
        return
    columns = product.columns.size
    if columns != 1:
        raise InputError(
            f"dctimestep: pictures of {columns} time steps without -o; -o with a number"
            " such as %04d expected"
        )
    with streams.output("out.hdr") as path:
        write_picture_set(path, product, like, command=streams.command)
