"""`clerestory bsdf convert` and `reduce`: conversion and reduction of BSDFs."""

from dataclasses import replace

import typer

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import reciprocal_mean, to_matrices, to_trees
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_arithmetic import reduce_tree
from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.cli.bsdf_report import function_title
from clerestory.cli.requests.bsdf import ConvertBsdf, ReduceBsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.library.bsdf_source import read_bsdf


def convert(request: ConvertBsdf) -> None:
    """Convert a BSDF; print diffuse transmittance and reflectance before and after."""
    before = read_bsdf(request.file)
    source = reciprocal_mean(before) if request.reciprocal else before
    if request.to == "tree":
        after = to_trees(source, halvings=request.halvings, reduction=request.reduction)
    elif request.to == "same":
        after = source
    else:
        after = to_matrices(source, klems(request.to))
    command = f"clerestory bsdf convert {request.file.name} to {request.to}"
    comment = command.replace("--", "-")
    # Values that are not converted keep all digits
    digits = None if request.to == "same" else usual_digits(after)
    write_bsdf(request.output, after, digits=digits, comment=comment)
    for channel, name in after.functions:
        if (channel, name) in before.functions:
            typer.echo(_change(before, after, channel, name))


def reduce(request: ReduceBsdf) -> None:
    """Merge cells of the tensor trees of a BSDF, and print the changes."""
    bsdf = read_bsdf(request.file)
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for (channel, name), part in bsdf.functions.items():
        if not isinstance(part, ScatteringTree):
            raise InputError(
                "contains a BSDF matrix; a tensor tree, as written by bsdf convert --to"
                " tree, expected",
                file=request.file,
            )
        result = reduce_tree(part, request.percent)
        functions[channel, name] = result.tree
        typer.echo(
            f"{function_title(channel, name):34}{result.cells_before} cells to"
            f" {result.cells_after}; {result.moved:.2%} of diffuse light redistributed,"
            f" direct-hemispherical values change by up to"
            f" {result.hemispherical_error:.1e}"
        )
    reduced = replace(bsdf, functions=functions)
    write_bsdf(
        request.output,
        reduced,
        digits=usual_digits(reduced),
        comment=f"clerestory bsdf reduce by {request.percent:g} %",
    )


def _change(before: Bsdf, after: Bsdf, channel: str, name: Function) -> str:
    # Text line: diffuse transmittance or reflectance before and after conversion
    one, other = (bsdf.diffuse(name, channel=channel) for bsdf in (before, after))
    title = function_title(channel, name)
    return f"{title:34}diffuse {one:.5f} before, {other:.5f} after"
