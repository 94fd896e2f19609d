"""Angular coverage, gaps, noise, symmetry and flux of a measurement."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from clerestory.array_types import Vector
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between
from clerestory.gonio.lobe_fitting import condensed_points
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.raster import Raster
from clerestory.gonio.scattering_measurement import SAME_DIRECTION, Measurement, Scan
from clerestory.gonio.symmetry import SYMMETRIES, Symmetry, deduce_symmetry, images

# A direction is in a gap if its angle to the nearest measured direction exceeds both
# _GAP_DEG [°] and _GAP_PER_SPACING times the median spacing of measured directions.
_GAP_DEG = 6.0
_GAP_PER_SPACING = 3.0

# Largest angle between in-plane directions and the plane of incidence [°].
_IN_PLANE_DEG = 2.0

# Noise estimate: number of BSDF values in each local quadratic fit, and approximate
# largest number of fits per scan.
_NEIGHBOURS, _MOST_FITS = 16, 300

# The grid for gaps and asymmetry has 2^5 × 2^5 cells of equal projected solid angle.
_HALVINGS = 5

# Asymmetry above which a warning is given, as a fraction of the scattered flux.
_ALIKE = 0.1

_Grid = Float[np.ndarray, "row column"]


@dataclass(frozen=True)
class ScanReport:
    """Angular coverage and quality of one scan."""

    scan: Scan
    reach_deg: float  # largest polar angle of the measured directions [°]
    # Fraction of the hemisphere, by projected solid angle, that lies in gaps
    gap: float
    # Largest angle from any direction to the nearest measured direction [°]
    gap_deg: float
    negative: float  # fraction of the BSDF values that are negative
    noise: float  # median relative deviation of BSDF values from a local quadratic fit
    in_plane: bool  # whether only the plane of incidence was measured
    flux: float  # directional-hemispherical transmittance or reflectance


@dataclass(frozen=True)
class Coverage:
    """Angular coverage, symmetry and quality of a measurement."""

    scans: tuple[ScanReport, ...]
    # Symmetry implied by the incident directions; None if ambiguous
    implied: Symmetry | None
    claimed: Symmetry | None  # symmetry stated in the file; None if not stated
    # Fraction of the scattered flux that differs between scans and their mirror images,
    # for each symmetry with scans at mirrored incident directions
    asymmetry: dict[Symmetry, float]

    def doubts(self) -> tuple[str, ...]:
        """Return warnings about the measurement, one line each."""
        lines: list[str] = []
        for report in self.scans:
            place = report.scan.words
            if report.in_plane:
                lines.append(f"{place}: only the plane of incidence was measured")
            elif report.gap > 0.02:
                lines.append(
                    f"{place}: {report.gap:.0%} of the hemisphere has no data,"
                    f" up to {report.gap_deg:.0f}° from the nearest point"
                )
            if report.negative > 0.01:
                lines.append(f"{place}: {report.negative:.0%} of values are negative")
            if report.flux > 1:
                flux = f"total flux is {report.flux:.3f}"
                lines.append(f"{place}: {flux}; at most 1 expected")
        symmetry = self.claimed or self.implied
        found = self.asymmetry.get(symmetry, 0.0) if symmetry else 0.0
        if symmetry == "isotropic":
            found = max(self.asymmetry.values(), default=0.0)
        if found > _ALIKE:
            lines.append(
                f"{symmetry} according to the file or the incident directions, but"
                f" {found:.0%} of the flux differs between mirror images"
            )
        if len(self.scans) < 2:
            lines.append("one incident direction; two or more are needed for a fit")
        return tuple(lines)


def measure_coverage(measurement: Measurement) -> Coverage:
    """Return the angular coverage, symmetry and quality of a measurement."""
    implied: Symmetry | None = None
    with suppress(InputError):
        implied = deduce_symmetry(measurement.incidents)
    reports = tuple(_report(scan) for scan in measurement.scans)
    return Coverage(reports, implied, measurement.claimed, _asymmetry(measurement))


def _report(scan: Scan) -> ScanReport:
    tree = cKDTree(scan.leaving)
    # Median spacing: half the chord length to the fourth-nearest measured direction
    spacing = float(np.median(tree.query(scan.leaving, k=[5])[0])) / 2
    limit = max(np.radians(_GAP_DEG), _GAP_PER_SPACING * spacing)
    grid = Raster.of(_HALVINGS).directions[-1]
    distance = 2 * np.arcsin(np.minimum(tree.query(grid)[0] / 2, 1))
    weight = grid[:, 2] / grid[:, 2].sum()
    theta = np.degrees(np.arccos(np.clip(scan.leaving[:, 2], 0, 1)))
    return ScanReport(
        scan,
        float(theta.max()),
        float(weight[distance > limit].sum()),
        float(np.degrees(distance.max())),
        float(np.mean(scan.values < 0)),
        _noise(tree, scan),
        _in_plane(scan),
        scan.flux,
    )


def _noise(tree: cKDTree, scan: Scan) -> float:
    # Median relative residual of local quadratic fits where the BSDF exceeds the mean
    bright = np.flatnonzero(scan.values >= np.abs(scan.values).mean())
    if len(scan.values) < _NEIGHBOURS or not len(bright):
        return 0.0
    bright = bright[:: max(1, len(bright) // _MOST_FITS)]
    _, near = tree.query(scan.leaving[bright], k=_NEIGHBOURS)
    x, y = np.moveaxis(
        (scan.leaving[near] - scan.leaving[bright, None])[..., :2], -1, 0
    )
    size = np.maximum(np.hypot(x, y).max(axis=1, keepdims=True), 1e-9)
    x, y = x / size, y / size
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    values = scan.values[near]
    factors = np.linalg.pinv(terms) @ values[..., None]
    rest = values - (terms @ factors)[..., 0]
    spread = np.sqrt(np.sum(rest**2, axis=1) / (_NEIGHBOURS - 6))
    return float(np.median(spread / np.maximum(np.abs(values.mean(axis=1)), 1e-12)))


def _in_plane(scan: Scan) -> bool:
    flat = scan.incident[:2]
    if np.hypot(*flat) < np.sin(np.radians(_IN_PLANE_DEG)):
        flat = scan.leaving[np.argmin(scan.leaving[:, 2]), :2]
    across = np.array([-flat[1], flat[0]]) / np.hypot(*flat)
    away = np.abs(scan.leaving[:, :2] @ across)
    return bool(away.max() < np.sin(np.radians(_IN_PLANE_DEG)))


def _asymmetry(measurement: Measurement) -> dict[Symmetry, float]:
    # Compare each scan with the mirror image of the scan at mirrored incidence
    found: dict[Symmetry, float] = {}
    incidents = measurement.incidents
    lights = [_light(scan) for scan in measurement.scans]
    for symmetry in SYMMETRIES:
        differences = []
        for factor in images(symmetry)[1:]:
            for scan, light in zip(measurement.scans, lights, strict=True):
                image = angle_between(incidents, scan.incident * factor)
                if image.min() <= SAME_DIRECTION:
                    partner = lights[int(image.argmin())]
                    differences.append(_difference(light, partner, factor))
        if differences:
            found[symmetry] = float(np.mean(differences))
    return found


def _light(scan: Scan) -> _Grid:
    # BSDF on a coarse grid of the unit square, where mirror images are array flips
    points = condensed_points(scan)
    flux = np.maximum(points.value * points.weight, 0)
    spread = np.full(len(flux), np.sqrt(2 * np.pi) / (1 << _HALVINGS))
    cells = Raster.of(_HALVINGS).cells(Lobes(points.direction, spread, flux))
    return cells.reshape(1 << _HALVINGS, -1)


def _difference(one: _Grid, other: _Grid, factor: Vector) -> float:
    axes = [axis for axis in (0, 1) if factor[axis] < 0]
    change = np.abs(one - np.flip(other, tuple(axes))).sum() / 2
    return float(change / max(float((one + other).sum()) / 2, 1e-300))
