"""LEED v4 and v4.1 credit Daylight, options 1 and 2.

Option 1 is based on sDA300/50% (with blinds) and ASE1000,250; option 2 on the fraction
of the area between 300 and 3000 lux at 9 h and 15 h on a clear equinox day.

Reference: USGBC, LEED v4 and v4.1 BD+C, EQ credit Daylight (not healthcare).
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from clerestory.checks import one_of, require
from clerestory.metrics.replicates import metric_error
from clerestory.metrics.spatial_metrics import RoomShare, area_share

Version = Literal["v4", "v4.1"]

LOW_LUX, HIGH_LUX = 300.0, 3000.0
MOST_EXPOSURE = 0.10

# Minimum fractions of the area, with the LEED points for each
_Limits = dict[Version, tuple[tuple[float, int], ...]]
_OPTION_1: _Limits = {
    "v4": ((0.55, 2), (0.75, 3)),
    "v4.1": ((0.40, 1), (0.55, 2), (0.75, 3)),
}
_OPTION_2: _Limits = {
    "v4": ((0.75, 1), (0.90, 2)),
    "v4.1": ((0.55, 1), (0.75, 2), (0.90, 3)),
}

# Autonomy of every space for one more point in v4.1, or exemplary performance
EACH_SPACE = 0.55


class Credit(NamedTuple):
    """LEED points, fraction of the area that meets the criterion, and a remark."""

    points: int
    share: float
    note: str


def simulated_daylight(
    autonomy: float,
    exposure: float,
    *,
    version: Version = "v4.1",
    departures: Sequence[str] = (),
    lowest: float = 0.0,
) -> Credit:
    """Return the LEED points of option 1, by annual simulation.

    `autonomy` and `exposure` are sDA and ASE of the regularly occupied floor area,
    `lowest` is the lowest sDA of its spaces: v4.1 gives one more point if it is 55 % or
    more; a fourth point stands for exemplary performance. If ASE is above 10 %, v4
    gives no points and v4.1 requires a statement on glare. The remark names the
    departures of the simulation from LM-83, which the credit requires; see
    `lm83_conditions.departures`.

    >>> simulated_daylight(0.60, 0.05).points
    2
    >>> simulated_daylight(0.60, 0.15, version="v4").points
    0
    """
    points = _points(autonomy, _OPTION_1, version)
    if version == "v4.1" and lowest >= EACH_SPACE - 1e-12:
        points += 1
    notes = []
    if departures:
        notes.append(f"not by LM-83: {'; '.join(departures)}")
    if exposure > MOST_EXPOSURE + 1e-12:
        note = f"ASE is {exposure:.0%}, above 10 %"
        if version == "v4":
            points = 0
        else:
            note += ": state how the design addresses glare"
        notes.append(note)
    return Credit(points, autonomy, "; ".join(notes))


def points_error(
    autonomy: RoomShare, exposure: RoomShare, *, version: Version = "v4.1"
) -> float:
    """Return the standard error of the LEED points of option 1; 0 if unknown.

    >>> points_error(RoomShare(0.55, (0.56, 0.54)), RoomShare(0.0, (0.0, 0.0)))
    0.5
    """
    pairs = zip(autonomy.replicates, exposure.replicates, strict=False)
    points = [simulated_daylight(*pair, version=version).points for pair in pairs]
    return metric_error(points)


def clear_sky_illuminance(
    illuminance: Sequence[Float[np.ndarray, " sensor"]],
    *,
    version: Version = "v4.1",
    view_preserving_blinds: bool = False,
    area: Float[np.ndarray, " sensor"] | None = None,
) -> Credit:
    """Return the LEED points of option 2, by illuminance under clear skies.

    Illuminance is given at 9 h and at 15 h of a clear equinox day [lux]. With automatic
    blinds that preserve the view, only the lower limit applies. By default, all sensors
    represent equal areas.

    >>> lux = np.array([200.0, 400.0, 900.0, 2000.0])
    >>> clear_sky_illuminance([lux, lux]).points  # 75 % of the sensors
    2
    """
    require(illuminance, "no illuminance; values at 9 h and at 15 h expected")
    high = np.inf if view_preserving_blinds else HIGH_LUX
    good = np.all([(lux >= LOW_LUX) & (lux <= high) for lux in illuminance], axis=0)
    share = area_share(good, area)
    return Credit(_points(share, _OPTION_2, version), share, "")


def _points(share: float, table: _Limits, version: Version) -> int:
    one_of(version, "version of LEED", choices=table)
    reached = (points for limit, points in table[version] if share >= limit - 1e-12)
    return max(reached, default=0)
