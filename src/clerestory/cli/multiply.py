"""`clerestory multiply`: products of matrix files."""

from dataclasses import replace
from functools import reduce
from itertools import pairwise
from operator import matmul
from pathlib import Path

from clerestory.checks import require, within
from clerestory.cli.command import COMMAND_LINE
from clerestory.cli.matrix_output import write_any_matrix
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.render import Multiply
from clerestory.errors import MatrixError
from clerestory.image import picture_sets
from clerestory.library.bsdf_source import read_bsdf
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.radiance_format import read_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.facade_matrices import joint_sum


def multiply(request: Multiply) -> None:
    """Multiply matrices; write the product as a matrix file or as pictures."""
    terms, file = _terms(request.factors), request.file
    with progress_display(quiet=file.quiet) as display:
        progress = display("multiply")
        progress(0.1, "multiplying")
        if picture_sets.is_picture_set(request.factors[0]):
            view, like = picture_sets.read_picture_set(request.factors[0])
            others = [read_any_matrix(path) for path in request.factors[1:]]
            product = _product([view, *others], request.factors)
            progress(0.8, "writing")
            picture_sets.write_picture_set(
                file.output, product, like, command=COMMAND_LINE.get()
            )
        else:
            product = _sum(terms)
            progress(0.8, "writing")
            write_any_matrix(file, product)
        progress(1.0, "done")
    size = f"{product.rows.describe()} by {product.columns.describe()}"
    say(f"{file.output}: {size}", quiet=file.quiet)


def read_any_matrix(path: Path) -> TransferMatrix:
    """Return the matrix in a file; for BSDF files, the front transmission."""
    match path.suffix.lower():
        case ".nc":
            return read_netcdf(path)
        case ".xml":
            return read_bsdf(path).transmission_matrix()
        case _:
            return read_matrix(path)


def _terms(factors: list[Path]) -> list[list[Path]]:
    # Matrix files to multiply, for each product; a + separates products
    terms: list[list[Path]] = [[]]
    for factor in factors:
        if str(factor) == "+":
            terms.append([])
        else:
            terms[-1].append(factor)
    for term in terms:
        within(len(term), "number of matrices in a product", least=2, most=5)
    require(
        len(terms) == 1
        or not any(picture_sets.is_picture_set(factor) for factor in factors),
        "a set of pictures is a factor in a sum; a single product expected",
    )
    return terms


def _sum(terms: list[list[Path]]) -> TransferMatrix:
    products = [_product([read_any_matrix(f) for f in term], term) for term in terms]
    first, *others = products
    for term, other in zip(terms[1:], others, strict=True):
        require(
            first.rows.fits(other.rows) and first.columns.fits(other.columns),
            f"product {term[0]} … is {other.rows.describe()} by"
            f" {other.columns.describe()}; {first.rows.describe()} by"
            f" {first.columns.describe()} expected, the size of the first product",
            error=MatrixError,
        )
    return joint_sum(products)


def _product(matrices: list[TransferMatrix], files: list[Path]) -> TransferMatrix:
    # The product has the precision of the last factor, usually a large sky matrix
    *first, last = matrices
    for (one, left), (other, right) in pairwise(zip(files, matrices, strict=True)):
        require(
            left.columns.fits(right.rows),
            f"{one} has {left.columns.describe()} as columns, {other} has"
            f" {right.rows.describe()} as rows; equal axes expected",
            error=MatrixError,
        )
    product = reduce(matmul, first)
    if last.values.dtype != product.values.dtype:
        product = replace(product, values=product.values.astype(last.values.dtype))
    return product @ last
