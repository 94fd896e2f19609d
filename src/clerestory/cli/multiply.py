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
from clerestory.phases.facade_matrices import joint_sum

Factors = Annotated[
    list[Path],
    typer.Argument(
        metavar="A B [C D E] [+ A B …]",
        help="Matrix files (.mtx .smx .nc), a BSDF (.xml) for its transmission, or"
        " first a set of pictures (V_%03d.hdr). A + adds products.",
    ),
]


def multiply(
    factors: Factors, output: Output, encoding: Format = "float", quiet: Quiet = False
) -> None:
    """Multiply two to five matrices, from left to right, and add such products.

    V.mtx T.xml D.mtx S.smx gives the irradiance [W/m²] of every sensor at every
    time step, as dctimestep does; times 47.4, 119.9 and 11.6 it is illuminance. With
    a set of pictures V_%03d.hdr first, OUT is a set too, one picture a time step.
    Behind a shade with several ports, F-a.nc D-a.nc + F-b.nc D-b.nc is the D of the
    window.
    """
    terms = _terms(factors)
    with progress_display(quiet=quiet) as display:
        progress = display("multiply")
        like = None
        if is_picture_set(factors[0]):
            view, like = read_picture_set(factors[0])
            matrices = [view, *(read_any_matrix(path) for path in factors[1:])]
            progress(0.3, "multiplying")
            product = _product(matrices, factors)
        else:
            progress(0.1, "multiplying")
            product = _sum(terms)
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


def _terms(factors: list[Path]) -> list[list[Path]]:
    # The files of each product
    terms: list[list[Path]] = [[]]
    for factor in factors:
        if str(factor) == "+":
            terms.append([])
        else:
            terms[-1].append(factor)
    for term in terms:
        if not 2 <= len(term) <= 5:
            raise InputError(f"{len(term)} matrices; two to five expected")
    if len(terms) > 1 and any(is_picture_set(factor) for factor in factors):
        raise InputError("a set of pictures in a sum; one product of it expected")
    return terms


def _sum(terms: list[list[Path]]) -> TransferMatrix:
    products = [_product([read_any_matrix(f) for f in term], term) for term in terms]
    first, *others = products
    for term, other in zip(terms[1:], others, strict=True):
        if not (first.rows.fits(other.rows) and first.columns.fits(other.columns)):
            raise MatrixError(
                f"the product from {term[0]} has {other.rows.describe()} by"
                f" {other.columns.describe()}; {first.rows.describe()} by"
                f" {first.columns.describe()} expected, as the first one"
            )
    return joint_sum(products)


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
