"""Checks for missing, zero and duplicated scattering functions of a BSDF."""

from collections.abc import Iterator, Mapping

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.patch_symmetry import mismatch
from clerestory.bsdf.quality_finding import Finding
from clerestory.bsdf.reciprocity import Tables
from clerestory.bsdf.scattering_function import Function

# The two sides of a layer count as different above this mismatch (fraction of flux).
_ASYMMETRIC = 0.05


def check_components(bsdf: Bsdf, tables: Mapping[str, Tables]) -> Iterator[Finding]:
    """Yield findings of missing, zero and duplicated scattering functions."""
    if "visible" not in bsdf.channels:
        yield Finding(
            "missing",
            "warning",
            0.0,
            f"no visible channel, only {', '.join(bsdf.channels)}",
            "file",
            "daylight cannot be computed from this file",
        )
    for channel, known in tables.items():
        yield from _missing(bsdf, channel)
        yield from _empty(channel, known)
        yield from _copied_sides(channel, known)
    yield from _copied_channels(tables)


def _missing(bsdf: Bsdf, channel: str) -> Iterator[Finding]:
    if not bsdf.has("transmission_front", channel=channel):
        yield Finding(
            "missing",
            "warning",
            0.0,
            "no transmission",
            channel,
            "the layer transmits no daylight, and matrix products reject it",
        )
    effects: dict[Function, str] = {
        "reflection_front": "light reflected to the outside is lost",
        "reflection_back": "the window absorbs all light from the room",
    }
    for name, effect in effects.items():
        if not bsdf.has(name, channel=channel):
            yield Finding(
                "missing", "info", 0.0, f"no {name.replace('_', ' ')}", channel, effect
            )


def _empty(channel: str, tables: Tables) -> Iterator[Finding]:
    full = {name for name, part in tables.items() if np.any(part.values)}
    for name in tables.keys() - full:
        other = name.replace("front", "back") if "front" in name else ""
        other = other or name.replace("back", "front")
        transmits = name.startswith("transmission")
        # If only one of front and back transmission is zero, reciprocity is violated
        matters = transmits and other in full
        yield Finding(
            "empty",
            "error" if matters else "info",
            0.0,
            f"all values are zero{', those of the other side are not' * matters}",
            f"{channel} {name.replace('_', ' ')}",
            "programs that use this side treat the layer as opaque"
            if transmits
            else "the layer reflects nothing on this side",
        )


def _copied_sides(channel: str, tables: Tables) -> Iterator[Finding]:
    sides = mismatch_of_sides(tables)
    pairs: tuple[tuple[Function, Function], ...] = (
        ("transmission_front", "transmission_back"),
        ("reflection_front", "reflection_back"),
    )
    for front, back in pairs:
        one, other = tables.get(front), tables.get(back)
        if one is None or other is None or not np.any(one.values):
            continue
        if not np.array_equal(one.values, other.values):
            continue
        kind = front.removesuffix("_front")
        # Equal transmissions are plausible if the transmission is its own reciprocal,
        # equal reflections if the transmittances of both sides are equal
        doubt = sides["reverse" if kind == "transmission" else "passing"]
        asymmetric = doubt > _ASYMMETRIC
        yield Finding(
            "copy",
            "warning" if asymmetric else "info",
            doubt,
            "the values of back and front are identical"
            + f", but the sides of the layer differ by {doubt:.1%}" * asymmetric,
            f"{channel} {kind}",
            "the values of one side are wrong"
            if asymmetric
            else "none if both sides of the layer are equal",
        )


def mismatch_of_sides(tables: Tables) -> dict[str, float]:
    """Differences between the two sides of a layer, from its transmission.

    "reverse": mismatch between the front transmission and its reciprocal; "passing":
    mismatch between front and back transmittances. Without transmission both are 0.
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
    return {"reverse": reverse, "passing": passing}


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
            yield Finding(
                "copy",
                "info",
                0.0,
                f"the values of {channel} and {first} are identical",
                "all functions",
                "solar heat gains are computed as for a spectrally neutral layer",
            )
