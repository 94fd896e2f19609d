"""Scattering functions fitted to goniophotometer measurements, and their export."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import to_matrices
from clerestory.bsdf.scattering_function import OF_SIDE, Function, ScatteringFunction
from clerestory.checks import one_of, require
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import DEFAULT, FitOptions, fit_scans
from clerestory.gonio.network_assembly import connect
from clerestory.gonio.optimal_transport import Network
from clerestory.gonio.parallel import IN_SERIES, Workers
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.gonio.symmetry import SYMMETRIES, Symmetry
from clerestory.gonio.tree_export import to_tree
from clerestory.hemisphere.klems import klems
from clerestory.progress import Progress


@dataclass(frozen=True, eq=False)
class Fitted:
    """Scattering function of a layer, fitted to a measurement."""

    interpolant: Interpolant  # interpolated scattering function
    function: Function  # name of the function, such as "transmission_front"
    channel: str = "visible"  # spectral channel, such as "visible" or "cie-x"
    name: str = ""  # name of the sample
    options: FitOptions = DEFAULT  # options of the lobe fits

    __repr__ = brief


def fit_measurement(
    measurement: Measurement,
    *,
    symmetry: Symmetry | None = None,
    options: FitOptions = DEFAULT,
    processes: int = 1,
    progress: Callable[[str], Progress] = IN_SERIES.progress,
) -> Fitted:
    """Fit the scattering function that interpolates a measurement.

    Parameters
    ----------
    symmetry : symmetry of the layer; default: the symmetry stated in the file, or else
        implied by the incident directions
    processes : number of parallel processes
    progress : function called with the name of each phase; it returns a function that
        is called with the fraction done

    Raises
    ------
    InputError : there are too few incident directions, or a scan has no flux
    """
    symmetry = symmetry or measurement.symmetry
    one_of(symmetry, "symmetry", choices=SYMMETRIES)
    workers = Workers(processes, progress)
    fits = fit_scans(measurement.scans, options=options, workers=workers)
    network = connect(measurement.incidents, fits, symmetry, workers=workers)
    return Fitted(
        Interpolant(network, symmetry),
        measurement.function,
        measurement.channel,
        measurement.name,
        options,
    )


def measured_bsdf(fits: Sequence[Fitted], *, source: str | None = None) -> Bsdf:
    """Combine fitted scattering functions into a BSDF.

    Parameters
    ----------
    source : file name, for error messages

    Raises
    ------
    InputError : there is no fit, or two fits have the same function and channel
    """
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for fit in fits:
        key = fit.channel, fit.function
        title = " ".join(key).replace("_", " ")
        message = f"{title} is given twice; one measurement per function expected"
        require(key not in functions, message)
        functions[key] = fit.interpolant
    require(functions, "no fitted measurement; one or more expected")
    name = next((fit.name for fit in fits if fit.name), "measured layer")
    return Bsdf(functions, Product(name=name), source=source)


def export_bsdf(
    fits: Sequence[Fitted],
    target: Literal["full", "half", "quarter", "tree"] = "full",
    *,
    halvings: int = 5,
    tolerance: float = 0.05,
    processes: int = 1,
    progress: Callable[[str], Progress] = IN_SERIES.progress,
) -> Bsdf:
    """Resample fitted scattering functions to Klems matrices or tensor trees.

    Parameters
    ----------
    target : Klems basis, or "tree" for a tensor tree (rank 3 if isotropic, else 4)
    halvings, tolerance : parameters of `to_tree`; ignored for matrices
    processes, progress : as in `fit_measurement`
    """
    bsdf = measured_bsdf(fits)
    if target != "tree":
        report = progress(f"Klems {target}")
        report(0.01, "averaging patches")
        matrices = to_matrices(bsdf, klems(target))
        report(1.0, "done")
        return matrices
    require(
        len({fit.interpolant.symmetry == "isotropic" for fit in fits}) == 1,
        "some functions are isotropic, some anisotropic; one kind expected for tensor"
        " trees; export matrices, or fit all functions with the same symmetry",
    )
    trees = {
        (fit.channel, fit.function): to_tree(
            fit.interpolant,
            halvings=halvings,
            tolerance=tolerance,
            workers=Workers(processes, progress),
            phase=fit.function.replace("_", " "),
        )
        for fit in fits
    }
    return replace(bsdf, functions=trees)


@dataclass(frozen=True, eq=False)
class Conserved:
    """Fitted functions, scaled so that transmittance plus reflectance is at most 1."""

    fits: tuple[Fitted, ...]  # scaled functions, in input order
    largest: float  # largest transmittance plus reflectance before the correction
    changed: int  # number of incident directions at which fluxes were scaled


def conserve_energy(fits: Sequence[Fitted]) -> Conserved:
    """Scale lobe fluxes where transmittance plus reflectance exceeds 1.

    The scale factors of the visible channel are used for all channels.
    """
    visible = {
        fit.function: fit.interpolant for fit in fits if fit.channel == "visible"
    }
    largest, changed = 0.0, 0
    result = []
    for fit in fits:
        # Sum transmittance and reflectance at each incident direction of the mesh
        vertices = fit.interpolant.network.mesh.vertices
        side = next(pair for pair in OF_SIDE.values() if fit.function in pair)
        known = [visible[name] for name in side if name in visible]
        shares = [interpolant.hemispherical(vertices) for interpolant in known]
        sums = np.sum([np.zeros(len(vertices)), *shares], axis=0)
        largest = max(largest, float(sums.max()))
        factors = 1 / np.maximum(sums, 1)
        if fit.channel == "visible":
            changed += int(np.sum(factors < 1))
        network = _scaled(fit.interpolant.network, factors)
        interpolant = replace(fit.interpolant, network=network)
        result.append(replace(fit, interpolant=interpolant))
    return Conserved(tuple(result), largest, changed)


def _scaled(network: Network, factors: Values) -> Network:
    lobes = tuple(
        replace(part, flux=part.flux * factor)
        for part, factor in zip(network.lobes, factors, strict=True)
    )
    plans = tuple(
        replace(
            plan,
            sent=plan.sent * factors[a],
            received=plan.received * factors[b],
            fading=plan.fading * factors[a],
            rising=plan.rising * factors[b],
        )
        for plan, (a, b) in zip(network.plans, network.mesh.edges, strict=True)
    )
    return replace(network, lobes=lobes, plans=plans)
