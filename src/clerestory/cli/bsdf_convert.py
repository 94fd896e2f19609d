"""`clerestory bsdf convert` and `reduce`: other patches, tensor trees, fewer cells."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import typer

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import reciprocal_mean, to_matrices, to_trees
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_reduction import reduce_tree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems

_DIGITS = 7

Target = Literal["full", "half", "quarter", "tree", "same"]
BsdfFile = Annotated[Path, typer.Argument(metavar="FILE", help="BSDF file to read.")]
Output = Annotated[Path, typer.Option("--output", "-o", help="BSDF file to write.")]


def convert(
    file: BsdfFile,
    output: Output,
    to: Annotated[
        Target, typer.Option("--to", help="Klems basis, or a tensor tree of rank 4.")
    ] = "full",
    halvings: Annotated[
        int, typer.Option("--halvings", help="2^N cells along each axis of a tree.")
    ] = 5,
    reciprocal: Annotated[
        bool, typer.Option("--reciprocal", help="Average with the reverse first.")
    ] = False,
) -> None:
    """Convert a BSDF to other patches or to a tensor tree; flux is conserved."""
    before = read_bsdf(file)
    mended = reciprocal_mean(before) if reciprocal else before
    if to == "tree":
        after = to_trees(mended, halvings=halvings)
    elif to == "same":
        after = mended
    else:
        after = to_matrices(mended, klems(to))
    command = f"clerestory bsdf convert {file.name} to {to}"
    write_bsdf(output, after, digits=_DIGITS, comment=command.replace("--", "-"))
    for channel, name in after.functions:
        if (channel, name) in before.functions:
            typer.echo(_change(before, after, channel, name))


def reduce(
    file: BsdfFile,
    output: Output,
    percent: Annotated[
        float,
        typer.Option("--percent", "-t", help="Share of the smallest cells to give up."),
    ] = 95.0,
) -> None:
    """Make a tensor tree smaller, and say what that costs; flux is conserved."""
    bsdf = read_bsdf(file)
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for (channel, name), part in bsdf.functions.items():
        if not isinstance(part, ScatteringTree):
            raise InputError(
                "a matrix; a tensor tree expected: convert it with --to tree first",
                file=file,
            )
        result = reduce_tree(part, percent)
        functions[channel, name] = result.tree
        title = f"{channel} {name.replace('_', ' ')}"
        typer.echo(
            f"{title:34}{result.cells_before} cells to {result.cells_after};"
            f" {result.moved:.2%} of diffuse light moves,"
            f" shares change by up to {result.hemispherical_error:.1e}"
        )
    write_bsdf(
        output,
        replace(bsdf, functions=functions),
        digits=_DIGITS,
        comment=f"clerestory bsdf reduce by {percent:g} %",
    )


def _change(before: Bsdf, after: Bsdf, channel: str, name: Function) -> str:
    # Share of diffuse light, which a conversion must keep
    one, other = (bsdf.diffuse(name, channel=channel) for bsdf in (before, after))
    title = f"{channel} {name.replace('_', ' ')}"
    return f"{title:34}{one:.5f} of diffuse light before, {other:.5f} after"
