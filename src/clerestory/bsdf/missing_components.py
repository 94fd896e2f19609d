"""Checks for missing, zero and duplicated scattering functions of a BSDF."""

from collections.abc import Iterator, Mapping

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_symmetry import mismatch
from clerestory.bsdf.quality_finding import Finding, Severity
from clerestory.bsdf.reciprocity import Tables
from clerestory.bsdf.scattering_function import OF_SIDE, OTHER_SIDE, Function

# Mismatch [fraction of the flux] above which two sides of a layer count as different.
_ASYMMETRIC = 0.05


# Effect of each missing function on a simulation
_EFFECTS: dict[Function, str] = {
    "transmission_front": "the layer transmits no daylight; matrix products reject it",
    "reflection_front": "light reflected to the outside is lost",
    "reflection_back": "the window absorbs all light from the room",
}


def check_components(bsdf: Bsdf, tables: Mapping[str, Tables]) -> Iterator[Finding]:
    """Yield findings about missing, zero and duplicated scattering functions."""
    if "visible" not in bsdf.channels:
        what = f"no visible channel, only {', '.join(bsdf.channels)}"
        effect = "daylight cannot be computed from this file"
        yield Finding("missing", "warning", 0.0, what, "file", effect)
    for channel, known in tables.items():
        for name, effect in _EFFECTS.items():
            if not bsdf.has(name, channel=channel):
                passes = name in OTHER_SIDE
                severity: Severity = "warning" if passes else "info"
                what = "no transmission" if passes else f"no {name.replace('_', ' ')}"
                yield Finding("missing", severity, 0.0, what, channel, effect)
        yield from _empty(channel, known)
        yield from _copied_sides(channel, known)
    yield from _copied_channels(tables)


def _empty(channel: str, tables: Tables) -> Iterator[Finding]:
    full = {name for name, part in tables.items() if np.any(part.values)}
    for name in tables:
        if name in full:
            continue
        # If only one of front and back transmission is zero, reciprocity is violated
        matters = OTHER_SIDE.get(name) in full
        severity: Severity = "error" if matters else "info"
        what = f"all values are zero{', those of the other side are not' * matters}"
        effect = "the layer reflects nothing on this side"
        if name in OTHER_SIDE:
            effect = "programs that use this side treat the layer as opaque"
        where = f"{channel} {name.replace('_', ' ')}"
        yield Finding("empty", severity, 0.0, what, where, effect)


def _copied_sides(channel: str, tables: Tables) -> Iterator[Finding]:
    # Equal transmissions of both sides are plausible if the transmission is its own
    # reciprocal, equal reflections if the transmittances of both sides are equal
    pairs = zip(*OF_SIDE.values(), strict=True)
    for pair, doubt in zip(pairs, mismatch_of_sides(tables), strict=True):
        one, other = (tables.get(name) for name in pair)
        if one is None or other is None or not np.any(one.values):
            continue
        if not np.array_equal(one.values, other.values):
            continue
        severity: Severity = "info"
        what = "the values of back and front are identical"
        effect = "none if both sides of the layer are equal"
        if doubt > _ASYMMETRIC:
            severity, effect = "warning", "the values of one side are wrong"
            what += f", but the sides of the layer differ by {doubt:.1%}"
        where = f"{channel} {pair[0].removesuffix('_front')}"
        yield Finding("copy", severity, doubt, what, where, effect)


def mismatch_of_sides(tables: Tables) -> tuple[float, float]:
    """Differences between the two sides of a layer, estimated from the transmission.

    Return the mismatch of the front transmission and its reciprocal, and the mismatch
    of front and back transmittances; 0 without transmission data.
    """
    front = tables.get("transmission_front")
    back = tables.get("transmission_back")
    reverse = passing = 0.0
    if front is not None and front.exits.matches(front.incidents):
        weight = front.exits.projected_solid_angles()
        even = weight[:, None] * weight
        reverse = mismatch(front.values * even, front.reciprocal().values * even)
    if front is not None and back is not None:
        shares = [part.direct_hemispherical() for part in (front, back)]
        if len(shares[0]) == len(shares[1]):
            passing = mismatch(shares[0][None], shares[1][None])
    return reverse, passing


def _copied_channels(tables: Mapping[str, Tables]) -> Iterator[Finding]:
    first, *others = tables
    for channel in others:
        pairs = [
            (tables[first][name].values, part.values)
            for name, part in tables[channel].items()
            if name in tables[first]
        ]
        filled = any(np.any(a) for a, _ in pairs)
        if filled and all(np.array_equal(a, b) for a, b in pairs):
            what = f"the values of {channel} and {first} are identical"
            effect = "solar heat gains are computed as for a spectrally neutral layer"
            yield Finding("copy", "info", 0.0, what, "all functions", effect)
