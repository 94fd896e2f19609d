"""Export of fitted layers as Klems matrices or tensor trees."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.errors import InputError
from clerestory.gonio.fitted_measurement import Fitted, measured_bsdf
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.parallel import silent
from clerestory.gonio.tree_export import to_tree
from clerestory.hemisphere.klems import klems
from clerestory.progress import Progress

Target = Literal["full", "half", "quarter", "tree"]


def export_bsdf(
    fits: Sequence[Fitted],
    target: Target = "full",
    *,
    halvings: int = 5,
    tolerance: float = 0.05,
    processes: int = 1,
    progress: Callable[[str], Progress] = lambda _name: silent,
) -> Bsdf:
    """Resample fitted scattering functions to Klems matrices or tensor trees.

    Parameters
    ----------
    target : Klems basis, or "tree" for a tensor tree (rank 3 if isotropic, else 4)
    halvings, tolerance, processes : parameters of `to_tree`; ignored for matrices
    progress : function called with the name of each phase; it returns a function that
        is called with the fraction done
    """
    bsdf = measured_bsdf(fits)
    if target != "tree":
        report = progress(f"Klems {target}")
        report(0.01, "averaging patches")
        matrices = to_matrices(bsdf, klems(target))
        report(1.0, "done")
        return matrices
    ranks = {fit.interpolant.symmetry == "isotropic" for fit in fits}
    if len(ranks) > 1:
        raise InputError(
            "isotropic and anisotropic functions in one layer; trees of one rank"
            " expected; export matrices, or fit all functions with the same symmetry"
        )
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for (channel, name), part in bsdf.functions.items():
        if isinstance(part, Interpolant):
            functions[channel, name] = to_tree(
                part,
                halvings=halvings,
                tolerance=tolerance,
                processes=processes,
                report=progress(name.replace("_", " ")),
            )
    return replace(bsdf, functions=functions)
