"""The smoothing factor, and figures of the data sets."""

import numpy as np
from data_sets import data_sets
from page import head, save

from clerestory.gonio.angles import angle_between
from clerestory.gonio.cross_validation import cross_validate
from clerestory.gonio.fitted_measurement import fit_measurement
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.measurement_files import read_measurement
from clerestory.report.gonio_plots import between_figure, fit_figure


def lines(folder):
    """Yield the page of leave-one-out errors for several smoothing factors."""
    yield from head("Measurements to BSDFs: the smoothing factor")
    yield "Medians over the scans that are left out among the others."
    yield ""
    yield "| data | smoothing | flux | beam [°] | EMD [°] | elsewhere | own fit |"
    yield "|---|---|---|---|---|---|---|"
    for name, measurement in data_sets(folder):
        for factor in (0.6, 1.0, 1.6):
            yield row(name, measurement, factor, symmetry="isotropic")
    (lenslets,) = read_measurement(folder / "rt300s" / "IMX455.bsdf")
    yield row("IMX455", lenslets, 1.0)
    for name, measurement in [*data_sets(folder)][1:]:
        data_figures(name.split()[0].lower(), measurement, symmetry="isotropic")
    data_figures("imx455", lenslets)


def row(name, measurement, factor, symmetry=None):
    """Line of the table."""
    options = FitOptions(smoothing=factor)
    result = cross_validate(measurement, symmetry=symmetry, options=options)
    names = ("flux_error", "peak_deg", "earth_mover_deg", "misplaced", "fitted")
    digits = zip(names, (4, 2, 2, 3, 3), strict=True)
    values = [f"{result.median(n):.{d}f}" for n, d in digits]
    return f"| {name} | {factor:g} | {' | '.join(values)} |"


def data_figures(key, measurement, symmetry=None):
    """Write the fit of a scan, and what lies half-way to the nearest."""
    fitted = fit_measurement(measurement, symmetry=symmetry)
    theta = np.array([scan.theta_deg for scan in measurement.scans])
    order = np.lexsort((np.arange(len(theta)), theta))
    middle = len(order) // 2
    save(fit_figure(measurement, fitted.interpolant, order[middle]), f"gonio-{key}")
    incidents = measurement.incidents
    away = angle_between(incidents, incidents[order[middle]])
    ends = incidents[np.argsort(away)[1::-1]]
    save(between_figure(fitted.interpolant, *ends), f"gonio-{key}-between")
