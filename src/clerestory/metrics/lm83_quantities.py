"""Quantities of LM-83 and LEED of a space: sDA, ASE, hours of sun and open blinds."""

from collections.abc import Iterator, Sequence

import numpy as np

from clerestory.metrics.compliance import Quantity, Requirement, share
from clerestory.metrics.leed import MOST_EXPOSURE, Version
from clerestory.metrics.procedure import requirement
from clerestory.metrics.space import Space, spaces_of
from clerestory.metrics.spatial_metrics import (
    hours_above,
    spatial_autonomy,
    sunlight_exposure,
)


def autonomy(space: Space, limits: str) -> Sequence[Quantity]:
    """Return sDA300/50%, and the share of the hours in which the blinds are open."""
    found = None
    if space.hours.any():
        found = space.shares(spatial_autonomy, space.data, space.hours)
    opened = open_share(space)
    sda = share("sDA300/50%", found, limits)
    if opened is None:
        return (sda,)
    return (sda, Quantity("hours with all blinds open", 100 * opened, "%", ""))


def lowest_autonomy(space: Space) -> Quantity:
    """Return the lowest sDA300/50% of the spaces in a space."""
    each = [autonomy(one, "")[0] for one in spaces_of(space.data)]
    varied = zip(*(one.replicates for one in each), strict=True)
    return Quantity(
        "lowest sDA300/50% of a space",
        float(np.min([one.value for one in each])),
        "%",
        "55 % for one more point",
        tuple(map(min, varied)),
    )


def exposure(space: Space, limits: str) -> Sequence[Quantity]:
    """Return ASE1000,250h, and the hours of sun of the sensor that has most."""
    if space.sun is None or not space.hours.any():
        return (share("ASE1000,250h", None, limits),)
    step = space.step_hours
    found = space.shares(sunlight_exposure, space.sun, space.hours, step_hours=step)
    most = hours_above(space.sun["illuminance"], space.hours, step_hours=step).max()
    return (
        share("ASE1000,250h", found, limits),
        Quantity("most hours of sun", float(most), "h", "counted above 250 h"),
    )


def open_share(space: Space) -> float | None:
    """Share of the evaluated hours in which all windows of a space are in state 0.

    None without blinds.
    """
    if "state" not in space.data or not space.data.sizes["window"]:
        return None
    states = space.data["state"].transpose("window", "time").values[:, space.hours]
    return float((states == 0).all(axis=0).mean())


def glare_statement(space: Space, *, version: Version) -> Iterator[Requirement]:
    """Check whether a space needs a statement on glare, or gives no points."""
    if space.sun is None or not space.hours.any():
        return
    metric, step = sunlight_exposure, space.step_hours
    found = metric(
        space.sun["illuminance"], space.hours, area=space.area, step_hours=step
    )
    change = "state how the design addresses glare in this space"
    if version == "v4":
        change = "reduce the direct sunlight: LEED v4 gives no points above 10 %"
    yield requirement(
        "Sunlight exposure",
        bool(found.value <= MOST_EXPOSURE + 1e-12),
        f"ASE {np.round(100 * found.value, 1):g} %",
        expected="10 % or less",
        change=change,
    )
