"""`clerestory multiply`: products of matrix files."""

from dataclasses import replace
from functools import reduce
from itertools import pairwise
from operator import matmul
from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.matrix_files import read_any_matrix
from clerestory.cli.matrix_output import write_any_matrix
from clerestory.cli.options import Format, Output, Quiet
from clerestory.cli.picture_sets import (
    is_picture_set,
    read_picture_set,
    write_picture_set,
)
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError, MatrixError
from clerestory.matrix.transfer_matrix import TransferMatrix

Factors = Annotated[
    list[Path],
    typer.Argument(
        metavar="A B [C D]",
        help="Matrix files (.mtx .smx .nc), a BSDF (.xml) for its transmission, or"
        " first a set of pictures (V_%03d.hdr).",
    ),
]


def multiply(
    factors: Factors, output: Output, encoding: Format = "float", quiet: Quiet = False
) -> None:
    """Multiply two to four matrices, from left to right.

    V.mtx T.xml D.mtx S.smx gives the irradiance [W/m²] of every sensor at every
    time step, as dctimestep does; times 47.4, 119.9 and 11.6 it is illuminance. With
    a set of pictures V_%03d.hdr first, OUT is a set too, one picture a time step.
    """
    if not 2 <= len(factors) <= 4:
        raise InputError(f"{len(factors)} matrices; two to four expected")
    with progress_display(quiet=quiet) as display:
        progress = display("multiply")
        like = None
        first, *others = factors
        if is_picture_set(first):
            view, like = read_picture_set(first)
        else:
            view = read_any_matrix(first)
        matrices = [view, *(read_any_matrix(path) for path in others)]
        progress(0.3, "multiplying")
        product = _product(matrices, factors)
        progress(0.8, "writing")
        command = "clerestory multiply"
        if like is None:
            write_any_matrix(output, product, encoding=encoding, command=command)
        else:
            write_picture_set(output, product, like, command=command)
        progress(1.0, "done")
    if not quiet:
        size = f"{product.rows.describe()} by {product.columns.describe()}"
        typer.echo(f"{output}: {size}")


def _product(matrices: list[TransferMatrix], files: list[Path]) -> TransferMatrix:
    # A sky of a year is as large as all other factors: keep its precision
    *first, last = matrices
    for (one, left), (other, right) in pairwise(zip(files, matrices, strict=True)):
        if not left.columns.fits(right.rows):
            raise MatrixError(
                f"{one} has {left.columns.describe()} as columns, {other} has"
                f" {right.rows.describe()} as rows; the same expected on both sides"
            )
    product = reduce(matmul, first)
    if last.values.dtype != product.values.dtype:
        product = replace(product, values=product.values.astype(last.values.dtype))
    return product @ last
