"""Text output of `clerestory gonio`: coverage, fits and prediction errors."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from clerestory.cli.bsdf_report import function_title
from clerestory.gonio.coverage import Coverage
from clerestory.gonio.cross_validation import CrossValidation
from clerestory.gonio.fitted_measurement import Fitted
from clerestory.gonio.scattering_measurement import Measurement

# Headings and row formats of two tables with one row per scan
_TABLE = "  θ [°]  φ [°]  points   to θ    gaps negative  noise    flux"
_SCAN = (
    "{0.scan.theta_deg:7.1f}{0.scan.phi_deg:7.1f}{0.scan.values.size:8}"
    "{0.reach_deg:7.0f}{0.gap:8.1%}{0.negative:9.1%}{0.noise:7.0%}{0.flux:8.4f}"
)
_ERRORS = (
    "  θ [°]  φ [°]     flux    error  peak [°] EMD [°]   place  elsewhere  own fit"
)
_PREDICTION = (
    "{0.theta_deg:7.1f}{0.phi_deg:7.1f}{0.measured:9.4f}{0.flux_error:+9.4f}"
    "{0.peak_deg:10.1f}{0.earth_mover_deg:8.2f}{1:>8}{0.misplaced:11.1%}"
    "{0.fitted:9.1%}"
)


def measurement_lines(measurement: Measurement, coverage: Coverage) -> Iterator[str]:
    """Yield a description of a measurement and its coverage."""
    title = function_title(measurement.channel, measurement.function)
    yield f"{measurement.name or 'sample'}: {title}"
    yield f"  {len(coverage.scans)} incident directions, symmetry " + (
        coverage.claimed or coverage.implied or "not clear"
    )
    for symmetry, share in coverage.asymmetry.items():
        yield f"  {share:.1%} of the light differs between images if {symmetry}"
    for note in measurement.notes:
        yield f"  note: {note}"
    yield _TABLE
    yield from (_SCAN.format(scan) for scan in coverage.scans)
    yield from (f"  finding: {finding}" for finding in coverage.doubts())


def fit_lines(fits: Sequence[Fitted]) -> Iterator[str]:
    """Yield a line per fit: symmetry, number of lobes, transport plans, smoothing."""
    for fit in fits:
        network = fit.interpolant.network
        count = [len(lobes) for lobes in network.lobes]
        title = function_title(fit.channel, fit.function)
        yield (
            f"{fit.name or 'sample'}: {title}, {fit.interpolant.symmetry},"
            f" {len(count)} directions of {min(count)} to {max(count)} lobes,"
            f" {len(network.plans)} transport plans,"
            f" smoothing {fit.options.smoothing:g}"
        )


def validation_lines(validation: CrossValidation) -> Iterator[str]:
    """Yield the prediction errors of every scan, and their medians."""
    yield f"smoothing {validation.smoothing:g}: each scan predicted from the others"
    yield _ERRORS
    for scan in validation.scans:
        yield _PREDICTION.format(scan, "inside" if scan.inside else "beyond")
    for inside, words in ((True, "among the others"), (False, "beyond the others")):
        count = sum(scan.inside == inside for scan in validation.scans)
        if count:
            flux, peak, mover, place = (
                validation.median(name, inside=inside)
                for name in ("flux_error", "peak_deg", "earth_mover_deg", "misplaced")
            )
            yield (
                f"median of {count} {words}: flux {flux:.4f}, peak {peak:.1f}°,"
                f" earth mover's distance {mover:.2f}°, elsewhere {place:.1%}"
            )


def direction_lines(directions: Float[np.ndarray, "directions 3"]) -> Iterator[str]:
    """Yield incident directions recommended for further scans."""
    yield "directions recommended for scans, the most useful first:"
    yield _TABLE[:14]
    for x, y, z in directions:
        theta, phi = np.degrees([np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])
        yield f"{theta:7.1f}{phi % 360:7.1f}"
