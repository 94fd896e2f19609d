"""Sets of pictures as matrices, with one row per pixel and one column per picture.

Examples are view matrices of images, V_%03d.hdr, with one picture per window patch, and
their products with sky matrices, with one picture per time step.
"""

import re
from itertools import count, takewhile
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.image.picture import Picture, same_size
from clerestory.image.picture_files import SUFFIXES, read_picture, write_picture
from clerestory.matrix.axis import pixel_axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

_NO_NUMBER = "the name has no number; one number such as in V_%03d.hdr expected"

# A number of three digits of a width or precision makes names that are too long
_WIDE = re.compile(r"%[^%a-zA-Z]*\d{3}")


def is_picture_set(path: Path) -> bool:
    """Whether a file name has a number format such as %03d and a picture extension.

    >>> is_picture_set(Path("V_%03d.hdr")), is_picture_set(Path("V.mtx"))
    (True, False)
    """
    return "%" in path.name and path.suffix.lower() in SUFFIXES


def numbered(path: Path, number: int) -> Path:
    """Return the file name of picture `number` in a set of pictures.

    >>> str(numbered(Path("V_%03d.hdr"), 7))
    'V_007.hdr'
    """
    require(not _WIDE.search(path.name), _NO_NUMBER, file=path)
    try:
        return path.with_name(path.name % number)
    except (TypeError, ValueError):
        raise InputError(_NO_NUMBER, file=path) from None


def read_picture_set(
    path: Path, *, most: int | None = None
) -> tuple[TransferMatrix, Picture]:
    """Return pictures numbered from 0 as a matrix, and the first picture.

    `most` is the largest number of pictures to read; None reads all.
    """
    require(numbered(path, 0) != numbered(path, 1), _NO_NUMBER, file=path)
    first = read_picture(numbered(path, 0))
    columns = [first.radiance]
    numbers = count(1) if most is None else range(1, most)
    files = (numbered(path, number) for number in numbers)
    for file in takewhile(Path.is_file, files):
        columns.append(read_picture(file).radiance)
        with located(file=file):
            same_size(columns[-1], first.radiance, "the picture")
    pixels = first.rows * first.columns
    values = np.stack(columns, axis=-1).reshape(pixels, 3, len(columns))
    matrix = TransferMatrix(
        np.ascontiguousarray(values.transpose(1, 0, 2)),
        pixel_axis(pixels),
        unknown_axis(len(columns)),
    )
    return matrix, first


def write_picture_set(
    path: Path, matrix: TransferMatrix, like: Picture, *, command: str
) -> list[Path]:
    """Write a picture per matrix column, of size and view of `like`; return the paths.

    For a matrix of one column, the file name needs no number format.
    """
    columns, many = matrix.columns.size, "%" in path.name
    require(many or columns == 1, _NO_NUMBER, file=path)
    names = [numbered(path, k) if many else path for k in range(columns)]
    shape = len(matrix.bands), like.rows, like.columns
    for k, name in enumerate(names):
        values = np.broadcast_to(matrix.values[:, :, k].reshape(-1, *shape[1:]), shape)
        radiance = np.moveaxis(values, 0, -1).astype(np.float32)
        shown = Picture(radiance, view=like.view, header=(command,), bands=matrix.bands)
        write_picture(shown, name)
    return names
