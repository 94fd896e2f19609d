"""Text of `clerestory gonio`: coverage, fits and errors."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from clerestory.gonio.coverage import Coverage
from clerestory.gonio.cross_validation import CrossValidation
from clerestory.gonio.fitted_measurement import Fitted
from clerestory.gonio.scattering_measurement import Measurement

_TABLE = "{:>7}{:>7}{:>8}{:>7}{:>8}{:>9}{:>7}{:>8}"
_ERRORS = "{:>7}{:>7}{:>9}{:>9}{:>10}{:>8}{:>8}{:>11}{:>9}"


def measurement_lines(measurement: Measurement, coverage: Coverage) -> Iterator[str]:
    """Yield a description of a measurement and its coverage."""
    title = measurement.function.replace("_", " ")
    yield f"{measurement.name or 'sample'}: {measurement.channel} {title}"
    yield f"  {len(coverage.scans)} incident directions, symmetry " + (
        coverage.claimed or coverage.implied or "not clear"
    )
    for symmetry, share in coverage.asymmetry.items():
        yield f"  {share:.1%} of the light differs between images if {symmetry}"
    for note in measurement.notes:
        yield f"  note: {note}"
    yield _TABLE.format(
        "θ [°]", "φ [°]", "points", "to θ", "gaps", "negative", "noise", "flux"
    )
    for report in coverage.scans:
        yield _TABLE.format(
            f"{report.scan.theta_deg:.1f}",
            f"{report.scan.phi_deg:.1f}",
            len(report.scan.values),
            f"{report.reach_deg:.0f}",
            f"{report.gap:.1%}",
            f"{report.negative:.1%}",
            f"{report.noise:.0%}",
            f"{report.flux:.4f}",
        )
    for finding in coverage.doubts():
        yield f"  finding: {finding}"


def fit_lines(fits: Sequence[Fitted]) -> Iterator[str]:
    """Yield a description of fits."""
    for fit in fits:
        network = fit.interpolant.network
        count = [len(lobes) for lobes in network.lobes]
        title = f"{fit.channel} {fit.function.replace('_', ' ')}"
        yield (
            f"{fit.name or 'sample'}: {title}, {fit.interpolant.symmetry},"
            f" {len(count)} directions of {min(count)} to {max(count)} lobes,"
            f" {len(network.plans)} transport plans,"
            f" smoothing {fit.options.smoothing:g}"
        )


def validation_lines(validation: CrossValidation) -> Iterator[str]:
    """Yield the errors of every scan, and their medians."""
    yield f"smoothing {validation.smoothing:g}: each scan as the others predict it"
    yield _ERRORS.format(
        "θ [°]",
        "φ [°]",
        "flux",
        "error",
        "peak [°]",
        "EMD [°]",
        "place",
        "elsewhere",
        "own fit",
    )
    for scan in validation.scans:
        yield _ERRORS.format(
            f"{scan.theta_deg:.1f}",
            f"{scan.phi_deg:.1f}",
            f"{scan.measured:.4f}",
            f"{scan.flux_error:+.4f}",
            f"{scan.peak_deg:.1f}",
            f"{scan.earth_mover_deg:.2f}",
            "inside" if scan.inside else "beyond",
            f"{scan.misplaced:.1%}",
            f"{scan.fitted:.1%}",
        )
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
    yield _TABLE.format("θ [°]", "φ [°]", *[""] * 6).rstrip()
    for x, y, z in directions:
        theta, phi = np.degrees([np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])
        yield _TABLE.format(f"{theta:.1f}", f"{phi % 360:.1f}", *[""] * 6).rstrip()
