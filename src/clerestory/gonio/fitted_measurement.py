"""Fit of an interpolated scattering function to a goniophotometer measurement."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import Function, ScatteringFunction
from clerestory.errors import InputError
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import DEFAULT, FitOptions, fit_scans
from clerestory.gonio.network_assembly import connect
from clerestory.gonio.parallel import silent
from clerestory.gonio.scattering_measurement import Measurement
from clerestory.gonio.symmetry import Symmetry
from clerestory.progress import Progress


@dataclass(frozen=True, eq=False)
class Fitted:
    """One scattering function of a layer, fitted to its measurement.

    Attributes
    ----------
    interpolant : interpolated scattering function
    function, channel : such as "transmission_front" and "visible"
    name : name of the sample
    options : options of the lobe fits
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
    progress: Callable[[str], Progress] = lambda _name: silent,
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
        if key in functions:
            raise InputError(
                f"{fit.channel} {fit.function.replace('_', ' ')} is given twice; one"
                " measurement per function expected"
            )
        functions[key] = fit.interpolant
    if not functions:
        raise InputError("no fitted measurement; one or more expected")
    name = next((fit.name for fit in fits if fit.name), "measured layer")
    return Bsdf(functions, Product(name=name), source=source)
