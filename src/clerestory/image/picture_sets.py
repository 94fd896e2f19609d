"""Sets of pictures as matrices, with one row per pixel and one column per picture.

Examples are view matrices of images, V_%03d.hdr, with one picture per window patch, and
their products with sky matrices, with one picture per time step.
"""

from itertools import count
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.matrix.axis import pixel_axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

_ENDINGS = (".hdr", ".pic", ".exr")


def is_picture_set(path: Path) -> bool:
    """Whether a file name has a number format such as %03d and a picture extension.

    >>> is_picture_set(Path("V_%03d.hdr")), is_picture_set(Path("V.mtx"))
    (True, False)
    """
    return "%" in path.name and path.suffix.lower() in _ENDINGS


def numbered(path: Path, number: int) -> Path:
    """Return the file name of one picture of a set.

    >>> str(numbered(Path("V_%03d.hdr"), 7))
    'V_007.hdr'
    """
    try:
        return path.with_name(path.name % number)
    except (TypeError, ValueError):
        raise InputError(
            "a name with one number such as V_%03d.hdr expected", file=path
        ) from None


def read_picture_set(path: Path) -> tuple[TransferMatrix, Picture]:
    """Return pictures numbered from 0 as a matrix, and the first picture."""
    if numbered(path, 0) == numbered(path, 1):
        raise InputError(
            "a name with one number such as V_%03d.hdr expected", file=path
        )
    first = read_picture(numbered(path, 0))
    columns = [first.radiance]
    for file in (numbered(path, number) for number in count(1)):
        if not file.is_file():
            break
        picture = read_picture(file)
        if picture.radiance.shape != first.radiance.shape:
            raise InputError(
                f"{picture.columns} × {picture.rows} pixels;"
                f" {first.columns} × {first.rows} as the first picture expected",
                file=file,
            )
        columns.append(picture.radiance)
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
    """Write one picture per column, with the size and view of `like`; return the paths.

    For a single column the file name needs no number format.
    """
    columns = matrix.columns.size
    if "%" not in path.name and columns > 1:
        raise InputError(
            f"{columns} pictures; a name with one number such as I_%04d.hdr expected",
            file=path,
        )
    names = [numbered(path, k) if "%" in path.name else path for k in range(columns)]
    for k, name in enumerate(names):
        shape = len(matrix.bands), like.rows, like.columns
        values = np.broadcast_to(matrix.values[:, :, k].reshape(-1, *shape[1:]), shape)
        radiance = np.moveaxis(values, 0, -1).astype(np.float32)
        shown = Picture(radiance, view=like.view, header=(command,), bands=matrix.bands)
        write_picture(shown, name)
    return names
