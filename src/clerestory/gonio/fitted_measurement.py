"""From a measurement to its interpolant: fit every scan, mesh, plan transport."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.errors import InputError
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import DEFAULT, FitOptions, fit_scans
from clerestory.gonio.network_assembly import connect
from clerestory.gonio.parallel import Report, silent
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.gonio.symmetry import Symmetry


@dataclass(frozen=True, eq=False)
class Fitted:
    """One function of a layer, fitted to its measurement.

    Attributes
    ----------
    interpolant : the function
    function, channel : which it is
    name : of the sample
    options : how scans became lobes
    """

    interpolant: Interpolant
    function: Function
    channel: str = "visible"
    name: str = ""
    options: FitOptions = DEFAULT


def fit_measurement(
    measurement: Measurement,
    *,
    symmetry: Symmetry | None = None,
    options: FitOptions = DEFAULT,
    processes: int = 1,
    progress: Callable[[str], Report] = lambda _name: silent,
) -> Fitted:
    """Return the function that interpolates a measurement.

    Parameters
    ----------
    symmetry : of the layer; None for what the file claims or else what the incident
        directions imply
    processes : that share the work
    progress : called with the name of each phase; what it returns is told the share
        done

    Raises
    ------
    InputError : too few directions, or a scan that scatters no light
    """
    if symmetry is None:
        symmetry = measurement.symmetry
    fits = fit_scans(
        measurement.scans,
        options=options,
        processes=processes,
        report=progress("fit lobes"),
    )
    network = connect(
        measurement.incidents,
        fits,
        symmetry,
        processes=processes,
        report=progress("plan transport"),
    )
    return Fitted(
        Interpolant(network, symmetry),
        measurement.function,
        measurement.channel,
        measurement.name,
        options,
    )


def measured_bsdf(fits: Sequence[Fitted], *, source: str | None = None) -> Bsdf:
    """Return the layer of several fitted functions, to be evaluated and sampled.

    Parameters
    ----------
    source : file they came from, for messages

    Raises
    ------
    InputError : none, or two of the same function and channel
    """
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    for fit in fits:
        key = fit.channel, fit.function
        if key in functions:
            raise InputError(
                f"{fit.channel} {fit.function.replace('_', ' ')} is given twice; one"
                " measurement of each function expected"
            )
        functions[key] = fit.interpolant
    if not functions:
        raise InputError("no fitted measurement; one or more expected")
    name = next((fit.name for fit in fits if fit.name), "measured layer")
    return Bsdf(functions, Product(name=name), source=source)
