"""Check of Helmholtz reciprocity.

If renumbering of the incident patches removes a violation, the file has a different
azimuth convention. If division of the values by a weight, such as a solid angle,
removes a violation, the values are not BSDF values. All other violations result from
noise, interpolation or an invalid model.
"""

from collections.abc import Iterator
from dataclasses import replace

from clerestory.array_types import Values
from clerestory.bsdf.patch_symmetry import (
    TURNS,
    reciprocity_mismatch,
    reverse_ratios,
    turn_incident,
)
from clerestory.bsdf.quality_finding import Finding, Severity, severity_of
from clerestory.bsdf.scattering_function import FUNCTIONS, OTHER_SIDE, Function
from clerestory.bsdf.scattering_matrix import ScatteringMatrix

# Smallest mismatch between a function and its reciprocal (fraction of the flux), and
# smallest relative difference of the diffuse transmittances, for severities info,
# warning and error.
_RECIPROCITY = (0.015, 0.05, 0.25)
_SIDES = (0.02, 0.10, 0.50)

# Largest fraction of the mismatch that may remain after a plausible correction, and
# after a proven correction; smallest mismatch for which division by weights is tested.
_REPAIRED = 0.4
_PROVEN = 0.1
_WEIGHTED = 0.005

Tables = dict[Function, ScatteringMatrix]


def check_reciprocity(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about violated reciprocity, with a correction if one is found."""
    for title, part, partner in _reverses(tables):
        size = reciprocity_mismatch(part, partner)
        severity = severity_of(size, _RECIPROCITY)
        if severity is None:
            continue
        # Find the renumbering of incident patches with the smallest mismatch
        turned = (
            (
                reciprocity_mismatch(
                    *(turn_incident(p, turn) for p in (part, partner))
                ),
                turn,
            )
            for turn in TURNS[:3]
        )
        least, turn = min(turned)
        if size > _RECIPROCITY[1] and least < _REPAIRED * size:
            name, severity = "azimuth", "error"
            what = f"the reciprocity mismatch is {size:.0%}; it is {least:.0%} if"
            what += f" incident directions are transformed by: {turn}"
            effect = "light is scattered to the wrong side; the azimuth convention of"
            effect += " incident directions differs from WINDOW's"
        else:
            least, most = reverse_ratios(part, partner)
            name, what = "reciprocity", f"{size:.1%} of the flux violates reciprocity:"
            what += f" values looked up in reverse are {least:.2f} to {most:.2f} times"
            what += " those looked up forwards, for 90% of the flux"
            effect = (
                "pictures of Radiance's renderer, which looks values up in reverse,"
            )
            effect += " differ by these factors from ours and from dctimestep"
        yield Finding(name, severity, size, what, f"{channel} {title}", effect)


def _reverses(
    tables: Tables,
) -> Iterator[tuple[str, ScatteringMatrix, ScatteringMatrix]]:
    # Pairs of reciprocal functions, with a name; a reflection is its own reciprocal
    for name in FUNCTIONS:
        one, other = tables.get(name), tables.get(OTHER_SIDE.get(name, name))
        if one is None or other is None or name == "transmission_back":
            continue
        ends = (one.exits, other.incidents), (one.incidents, other.exits)
        if all(own.matches(reverse) for own, reverse in ends):
            title = "transmission" if name in OTHER_SIDE else name.replace("_", " ")
            yield title, one, other


def check_sides(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about unequal diffuse transmittances of the two sides.

    By reciprocity, front and back diffuse transmittances are equal.
    """
    if not {"transmission_front", "transmission_back"} <= set(tables):
        return
    front = tables["transmission_front"].diffuse()
    back = tables["transmission_back"].diffuse()
    size = abs(front - back) / max(front, back)
    severity = severity_of(size, _SIDES)
    if severity is not None:
        what = f"the diffuse transmittance is {front:.4f} from the front and {back:.4f}"
        what += " from the back; equal values expected"
        effect = f"daylight depends on the side that a program reads, by {size:.0%}"
        yield Finding("sides", severity, size, what, f"{channel} transmission", effect)


def check_scaling(channel: str, tables: Tables) -> Iterator[Finding]:
    """Yield findings about values that are reciprocal only when divided by a weight."""
    for title, part, partner in _reverses(tables):
        size = reciprocity_mismatch(part, partner)
        if size < _WEIGHTED:
            continue
        exits, incidents = part.exits, part.incidents
        weights: dict[str, Values] = {
            "the solid angle of exit patches": exits.projected_solid_angles()[:, None],
            "the solid angle of incident patches": incidents.projected_solid_angles(),
            "the cosine of exit directions": exits.centres()[:, 2:],
        }
        least, name = min(
            (reciprocity_mismatch(_divided(part, by), _divided(partner, by)), name)
            for name, by in weights.items()
        )
        if least < _REPAIRED * size:
            severity: Severity = "error" if least < _PROVEN * size else "info"
            what = f"the reciprocity mismatch is {size:.1%}; it is {least:.1%} if"
            what += f" values are divided by {name}"
            effect = "values may include this weight already; results are then too low"
            effect += " or wrong per patch"
            yield Finding("scaling", severity, size, what, f"{channel} {title}", effect)


def _divided(part: ScatteringMatrix, by: Values) -> ScatteringMatrix:
    return replace(part, values=part.values / by)
