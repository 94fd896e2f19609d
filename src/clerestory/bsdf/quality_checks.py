"""Quality checks of BSDFs: energy, reciprocity, order, labels, copies and missing data.

Helmholtz reciprocity and energy conservation hold for every layer. If a file violates
one of these laws, corrections of typical errors (such as swapped sides) are tried; a
correction that removes the violation identifies the error. Every finding states the
size of the deviation.
"""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from clerestory.array_types import Values
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.direction_checks import (
    check_coverage,
    check_peaks,
    check_repeated_rings,
)
from clerestory.bsdf.missing_components import check_components
from clerestory.bsdf.other_readers import check_readers
from clerestory.bsdf.patch_symmetry import turned_mismatch
from clerestory.bsdf.quality_finding import Finding, patch_label, severity_of
from clerestory.bsdf.reciprocity import (
    Tables,
    check_reciprocity,
    check_scaling,
    check_sides,
)
from clerestory.bsdf.scattering_function import (
    FUNCTIONS,
    OF_SIDE,
    OTHER_SIDE,
    SIDES,
    Side,
)
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

_NAMES = ("full", "half", "quarter")


def check_angle_bases(bsdf: Bsdf) -> Iterator[Finding]:
    """Yield findings on angle bases that differ from WINDOW's, and on reader notes."""
    partitions: dict[str, RingPartition] = {}
    for part in bsdf.functions.values():
        for partition in part.own_partitions() or ():
            partitions.setdefault(partition.name, partition)
    for partition in partitions.values():
        words = partition.name.lower()
        basis = next((name for name in _NAMES if f"klems {name}" in words), None)
        usual = partition if basis is None else klems(basis)
        if usual.matches(partition):
            continue
        what = f"{partition.name!r} with ring limits that differ from WINDOW's"
        if len(usual) != len(partition):
            counts = f"{len(partition)} patches; WINDOW has {len(usual)} patches"
            what = f"{partition.name!r} with {counts} under that name"
        excess = float(len(partition) - len(usual))
        effect = "programs that rely on the name reject the file or assign wrong angles"
        yield Finding("label", "warning", excess, what, "angle basis", effect)
    for note in bsdf.notes:
        effect = "other programs may read the file differently"
        yield Finding("reading", "info", 0.0, note, "file", effect)


# Smallest excess of transmittance plus reflectance over 1, for the severities info,
# warning and error.
_ENERGY = (0.001, 0.01, 0.05)

# Values whose sum over the exit patches is in this range are probably flux fractions
# instead of BSDF values.
_LIKE_SHARES = (0.3, 1.01)

# Smallest ratio of values to flux fractions; coarser partitions are not checked.
_DARK = 4.0

# A larger ratio of the transmittances of light from above and from below suggests that
# the layer is upside down.
_FROM_ABOVE = 1.5

# Largest directional-hemispherical transmittance of an opaque layer, as in Radiance.
_OPAQUE = 1e-3

# Layers with smaller mismatch (fraction of flux) count as symmetric or isotropic.
_ALIKE = 0.025


def check(bsdf: Bsdf) -> tuple[Finding, ...]:
    """Return the findings about a BSDF, errors first.

    Tensor trees are first averaged over Klems full patches.

    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.hemisphere.klems import klems
    >>> [f.severity for f in check(lambertian(0.5, klems("full"))) if f.matters]
    []
    """
    findings = [*check_angle_bases(bsdf)]
    tables: dict[str, Tables] = {}
    for channel in bsdf.channels:
        tables[channel] = {
            name: bsdf.function(name, channel=channel)
            for name in FUNCTIONS
            if (channel, name) in bsdf.functions
        }
        findings += _drop_noise(channel, tables[channel])
    findings += check_components(bsdf, tables)
    for channel, known in tables.items():
        filled = {name: part for name, part in known.items() if np.any(part.values)}
        for one in _CHECKS:
            findings += one(channel, filled)
        # Coarse cells of trees repeat values
        own = {n: p for n, p in filled.items() if p is bsdf.functions[channel, n]}
        findings += check_repeated_rings(channel, own)
    return _errors_first(findings)


def check_file(path: str | Path) -> tuple[Finding, ...]:
    """Return the findings about a BSDF file, errors first.

    The file is also checked for texts that Radiance or pyWinCalc does not accept.

    Raises
    ------
    InputError : the file is not a BSDF file, is damaged or has no data
    """
    return _errors_first([*check(read_bsdf(path)), *check_readers(path)])


def _errors_first(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    rank = {"error": 0, "warning": 1, "info": 2}
    return tuple(sorted(findings, key=lambda finding: rank[finding.severity]))


def _drop_noise(channel: str, tables: Tables) -> Iterator[Finding]:
    # Remove negligible transmissions: the noise of an opaque layer is not reciprocal
    names = [name for name in OTHER_SIDE if name in tables]
    most = max((tables[n].direct_hemispherical().max() for n in names), default=0.0)
    if not 0 < most <= _OPAQUE:
        return
    for name in names:
        del tables[name]
    what = f"the transmittance is {most:.1e} at most"
    effect = f"Radiance treats layers below {_OPAQUE:g} as opaque"
    yield Finding("opaque", "info", most, what, f"{channel} transmission", effect)


def _energy(channel: str, tables: Tables) -> Iterator[Finding]:
    # A transmission that is not in the file follows from that of the other side
    derived: Tables = {
        name: tables[other_side].reciprocal()
        for name, other_side in OTHER_SIDE.items()
        if name not in tables and other_side in tables
    }
    tables = {**tables, **derived}
    for side in SIDES:
        share, part = _scattered(tables, side, reflection_of=side)
        worst = int(np.argmax(share))
        excess = float(share[worst]) - 1
        severity = severity_of(excess, _ENERGY)
        if severity is None or part is None:
            continue
        # Test whether exchanging front and back reflection would conserve energy
        other: Side = "back" if side == "front" else "front"
        swapped, _ = _scattered(tables, side, reflection_of=other)
        fits = f"reflection_{other}" in tables and swapped.max() < 1 + _ENERGY[0]
        fits = bool(fits and excess > _ENERGY[1])
        advice = (
            f"; with the reflection of the {other} it would be {swapped.max():.3f}:"
            " front and back are swapped in the transmission or the reflection"
        ) * fits
        name = "order" if fits else "energy"
        what = f"transmittance and reflectance sum to {share[worst]:.4f}{advice}"
        if OF_SIDE[side][0] in derived:
            what += "; the transmission follows from that of the other side by"
            what += " reciprocity"
        where = f"{channel} {side}, {patch_label(part.incidents, worst)}"
        effect = f"results are up to {excess:.1%} too high"
        effect += "; interreflections may diverge"
        yield Finding(name, severity, excess, what, where, effect)


def _scattered(
    tables: Tables, side: Side, *, reflection_of: Side
) -> tuple[Values, ScatteringMatrix | None]:
    # Transmittance plus reflectance per incident patch; 0 if the two partitions differ
    names = OF_SIDE[side][0], OF_SIDE[reflection_of][1]
    parts = [tables[name] for name in names if name in tables]
    alike = parts and all(p.incidents.matches(parts[0].incidents) for p in parts)
    if not alike:
        return np.zeros(1), None
    return np.sum([part.direct_hemispherical() for part in parts], axis=0), parts[0]


def _darkness(channel: str, tables: Tables) -> Iterator[Finding]:
    # Very low values are probably flux fractions instead of BSDF values [1/sr]
    for side in SIDES:
        share, dark = _scattered(tables, side, reflection_of=side)
        if dark is None:
            continue
        sums = sum(
            part.values.sum(axis=0)
            for name, part in tables.items()
            if name.endswith(side) and part.values.shape == dark.values.shape
        )
        most, factor = share.max(), 1 / dark.exits.projected_solid_angles().mean()
        if _LIKE_SHARES[0] < np.max(sums) < _LIKE_SHARES[1] and factor > _DARK:
            what = f"transmittance and reflectance sum to {most:.2%} at most, but the"
            what += f" values for one incident direction sum to {np.max(sums):.3f}"
            effect = "if the values are flux fractions instead of 1/sr, results are"
            effect += f" about {factor:.0f} times too low"
            where = f"{channel} {side}"
            yield Finding("scaling", "warning", float(most), what, where, effect)


def _up_and_down(channel: str, tables: Tables) -> Iterator[Finding]:
    front = tables.get("transmission_front")
    if front is None and "transmission_back" in tables:
        front = tables["transmission_back"].reciprocal()
    if front is None:
        return
    _, y, z = front.incidents.centres().T
    slant = (z < np.cos(np.radians(30))) & (z > np.cos(np.radians(70)))
    share = front.direct_hemispherical()
    # Incident patches are indexed by direction of propagation: light from above has y <
    # 0
    groups = (slant & (y < -0.35), slant & (y > 0.35))
    above, below = (float(share[g].mean()) if np.any(g) else 0.0 for g in groups)
    if above > _FROM_ABOVE * below:
        what = f"the transmittance is {above:.3f} for light from above, {below:.3f} for"
        what += " light from below"
        where = f"{channel} transmission front, 30° to 70° off the normal"
        effect = "plausible for light-redirecting louvres; a shading blind with these"
        effect += (
            " values transmits the sun and has its sides swapped or is upside down"
        )
        yield Finding("order", "warning", above / max(below, 1e-9), what, where, effect)


def _shape(channel: str, tables: Tables) -> Iterator[Finding]:
    for name, part in tables.items():
        sides = turned_mismatch(part, "left and right")
        quarter = turned_mismatch(part, "a quarter turn")
        kind, size = "symmetry", sides
        effect = "results depend on the up vector of the window"
        if max(sides, quarter) < _ALIKE:
            kind, size, effect = "isotropy", quarter, "none"
            what = "the layer is isotropic"
        elif sides < _ALIKE:
            what = "the layer is symmetric left to right"
        else:
            what = f"left and right differ by {sides:.0%}"
            what += f", directions a quarter turn apart by {quarter:.0%}"
            effect += " and on left and right"
        where = f"{channel} {name.replace('_', ' ')}"
        yield Finding(kind, "info", size, what, where, effect)


_CHECKS: tuple[Callable[[str, Tables], Iterator[Finding]], ...] = (
    _energy,
    check_reciprocity,
    check_sides,
    check_scaling,
    check_coverage,
    check_peaks,
    _darkness,
    _up_and_down,
    _shape,
)
