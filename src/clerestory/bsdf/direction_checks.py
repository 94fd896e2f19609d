"""Checks of the directions of a BSDF: empty, beyond the measured range, exchanged.

Unscattered light keeps its patch number in the Klems numbering, in transmission and in
specular reflection. A peak in the patch of another direction shows an exchange of
azimuths that energy and reciprocity do not reveal.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool

from clerestory.bsdf.patch_symmetry import TURNS, Turn, flux_table, turned_patches
from clerestory.bsdf.quality_finding import Finding, Severity
from clerestory.bsdf.reciprocity import Tables
from clerestory.bsdf.scattering_function import OF_SIDE, OTHER_SIDE, SIDES, Side
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.partition import RingPartition

# Largest fraction of the directions without values that is usual if a file has only
# transmission: louvres are opaque for many directions.
_OPAQUE = 0.75

# Smallest polar angle [°] that can be the end of a measured range.
_INNER_DEG = 30

# Relative difference of transmittance or reflectance below which rings are equal, and
# above which the other rings differ.
_EQUAL, _DIFFERENT = 1e-5, 0.01

# Smallest fraction of the flux in misplaced peaks, and its smallest ratio to the
# fraction in the patches of unscattered light.
_PEAKED, _MISPLACED = 0.1, 5.0


def check_coverage(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about directions without values."""
    incident = [
        finding
        for side in SIDES
        for finding in _empty("incident", side, tables, f"{channel} {side}")
    ]
    yield from incident
    # By reciprocity, exit directions are empty where incident directions are
    for side in SIDES if not incident else ():
        yield from _empty("exit", side, tables, f"{channel} {side}")


def _empty(kind: str, side: Side, tables: Tables, where: str) -> Iterator[Finding]:
    # Light that is incident on a side, or light that leaves to this side
    passes = OF_SIDE[side][0]
    names = passes if kind == "incident" else OTHER_SIDE[passes], OF_SIDE[side][1]
    parts = [tables[name] for name in names if name in tables]
    partitions = [p.incidents if kind == "incident" else p.exits for p in parts]
    if not parts or not all(p.matches(partitions[0]) for p in partitions):
        return
    axis = 0 if kind == "incident" else 1
    empty = np.sum([part.values.sum(axis=axis) for part in parts], axis=0) == 0
    weight = partitions[0].projected_solid_angles()
    fraction = float(weight[empty].sum() / weight.sum())
    # Reflection alone or transmission alone may be zero
    if not empty.any() or (len(parts) < 2 and fraction < _OPAQUE):
        return
    effect = "light in these directions is lost"
    limit = _first_ring(partitions[0], empty)
    if limit > _INNER_DEG:
        what = f"no values for {kind} directions beyond {limit:.0f}° off the normal;"
        what += " probably the end of the measured range"
        yield Finding("range", "warning", limit, what, where, effect)
        return
    severity: Severity = "error" if fraction > _OPAQUE else "warning"
    count = np.count_nonzero(empty)
    what = f"{count} of {len(empty)} {kind} directions have no values"
    yield Finding("empty", severity, count / len(empty), what, where, effect)


def _first_ring(partition: RingPartition, empty: Bool[np.ndarray, " patch"]) -> float:
    # Polar angle [°] from which on all patches are empty, if no other patch is; else 0
    rings = np.split(empty, np.cumsum(partition.count)[:-1])
    first = len(rings) - int(np.argmin([ring.all() for ring in reversed(rings)]))
    alone = not any(ring.any() for ring in rings[:first])
    return float(np.degrees(partition.theta[first])) if alone else 0.0


def check_repeated_rings(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about outer rings that repeat the values of an inner ring."""
    for name, part in tables.items():
        share, partition = part.direct_hemispherical(), part.incidents
        rings = np.split(share, np.cumsum(partition.count)[:-1])
        mean = np.array([ring.mean() for ring in rings])
        last = np.array([np.abs(ring - mean[-1]).max() for ring in rings])
        same = last <= _EQUAL * mean[-1]
        first = len(rings) - int(np.argmin(same[::-1])) if not same.all() else 0
        varies = first and np.ptp(mean[:first]) > _DIFFERENT * mean.max()
        if mean[-1] == 0 or not varies or first >= len(rings) - 1:
            continue
        limit = float(np.degrees(partition.theta[first + 1]))
        what = f"the values beyond {limit:.0f}° off the normal repeat those before;"
        what += " probably the end of the measured range"
        effect = "light at grazing incidence is not that of the layer"
        where = f"{channel} {name.replace('_', ' ')}"
        yield Finding("range", "warning", limit, what, where, effect)


def check_peaks(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about unscattered light that leaves in a wrong direction."""
    for name, part in tables.items():
        if not part.exits.matches(part.incidents):
            continue
        straight = _peak_fraction(part, None)
        most, turn = max((_peak_fraction(part, turn), turn) for turn in TURNS[:3])
        if most < _PEAKED or most < _MISPLACED * straight:
            continue
        passes = name.startswith("transmission")
        # A film or a grid of mirrors can mirror the transmitted light
        wrong = passes and turn == "half a turn"
        kind = "transmitted" if passes else "specularly reflected"
        what = (
            f"{most:.0%} of the flux leaves in the patches of unscattered light after"
        )
        what += f" transforming incident directions by: {turn}; {straight:.0%} before"
        effect = f"{kind} light leaves in the wrong direction, if the layer has no"
        effect += " mirrors or lenses; the azimuths of incident directions differ from"
        effect += " WINDOW's"
        where = f"{channel} {name.replace('_', ' ')}"
        severity: Severity = "error" if wrong else "warning"
        yield Finding("azimuth", severity, most, what, where, effect)


def _peak_fraction(part: ScatteringMatrix, turn: Turn | None) -> float:
    # Fraction of the flux in the patches of unscattered light, without the pole
    flux = flux_table(part)
    order = np.arange(len(part.incidents))
    if turn is not None:
        order = turned_patches(part.incidents, turn)
    moved = turned_patches(part.incidents, "half a turn") != np.arange(len(order))
    total = flux[:, moved].sum()
    peak = flux[order, np.arange(len(order))][moved].sum()
    return float(peak / total) if total > 0 else 0.0
