"""Measured values as a function of unknown quantities, for calibration.

The terms of the expansion of hourly illuminance are aligned with the measurements as
simulated series are. Clock offsets interpolate between alignments at several shifts,
gains multiply the series of a grid.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.comparison.series import Series, group_of
from clerestory.comparison.series_comparison import (
    Rules,
    counted,
    matched_series,
    value_pairs,
)
from clerestory.comparison.time_alignment import Pairs
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.uncertainty.draws import Unknown
from clerestory.uncertainty.expansion import Expansion, Part
from clerestory.uncertainty.residual_covariance import SensorErrors

# Largest shift of the measured times and distance of shifts [min]
_REACH, _STEP = 60.0, 10.0


@dataclass(frozen=True, eq=False)
class CalibrationModel:
    """Prediction of measured values from unknown quantities.

    Attributes
    ----------
    unknowns : unknown quantities, in the order of the predictions' argument
    pairs : measured values, and simulated values at the reference
    shifts : shifts of the measured times [min]
    expansions : simulated values for each shift, over (pair, 1)
    clock : number of the quantity that shifts the measured times, or None
    gains : factor of the pairs by number of the quantity
    common : error components of the simulated values
    """

    unknowns: tuple[Unknown, ...]
    pairs: Pairs
    shifts: tuple[float, ...]
    expansions: tuple[Expansion, ...]
    clock: int | None
    gains: dict[int, np.ndarray]
    common: SensorErrors

    __repr__ = brief

    @property
    def measured(self) -> Float[np.ndarray, " pair"]:
        """Measured values."""
        return self.pairs.measured

    @property
    def days(self) -> Int[np.ndarray, " pair"]:
        """Number of the day of each pair."""
        days = self.pairs.times.astype("datetime64[D]").astype(int)
        return np.asarray(np.unique(days, return_inverse=True)[1])

    def clusters(self) -> list[np.ndarray]:
        """Return the number of the time of each pair."""
        return [np.unique(self.pairs.times, return_inverse=True)[1]]

    def predict(
        self, theta: Float[np.ndarray, " unknown"]
    ) -> Float[np.ndarray, " pair"]:
        """Return the measured values to expect with values of the quantities."""
        named = {
            unknown.name: theta[k : k + 1] for k, unknown in enumerate(self.unknowns)
        }
        minutes = 0.0 if self.clock is None else float(theta[self.clock])
        found = self._at(minutes, named)
        for number, members in self.gains.items():
            found = np.where(members, found * theta[number], found)
        return found

    def _at(self, minutes: float, named: dict[str, np.ndarray]) -> np.ndarray:
        if len(self.shifts) == 1:
            return _values(self.expansions[0], named)
        place = np.clip((minutes - self.shifts[0]) / _STEP, 0, len(self.shifts) - 1)
        low = min(int(place), len(self.shifts) - 2)
        ends = [_values(self.expansions[low + k], named) for k in (0, 1)]
        return np.asarray(ends[0] + (place - low) * (ends[1] - ends[0]))

    def of(self, chosen: np.ndarray) -> "CalibrationModel":
        """Return the model of some pairs, by mask."""
        rows = np.flatnonzero(chosen)
        parts = tuple(_chosen(one, rows) for one in self.expansions)
        gains = {number: members[rows] for number, members in self.gains.items()}
        return replace(
            self,
            pairs=self.pairs.where(rows),
            expansions=parts,
            gains=gains,
            common=self.common.where(rows),
        )


def calibration_model(
    measured: Sequence[Series],
    simulated: Series,
    expansion: Expansion,
    quantities: UnknownQuantities,
    *,
    rules: Rules,
    components: Float[np.ndarray, "component sensor time"] | None = None,
) -> CalibrationModel:
    """Return the model of measurements from the expansion of the illuminance.

    Parameters
    ----------
    measured : series from `read_measured_series`
    simulated : series of the sensors at the time steps of the expansion
    expansion : illuminance over (sensor, time)
    quantities : unknown quantities, also of the measurements
    rules : selection of values, as in a comparison
    components : error components of the illuminance [lux]
    """
    moved, _ = matched_series(measured, simulated)
    names = [own.name for own in quantities.unknowns]
    clock = names.index(quantities.clock) if quantities.clock else None
    steps = int(_REACH / _STEP)
    shifts = (
        [_STEP * k for k in range(-steps, steps + 1)] if quantities.clock else [0.0]
    )
    found = {}
    for minutes in shifts:
        pairs = value_pairs(moved, simulated, rules, rules.shift_minutes + minutes)
        kept = np.flatnonzero(counted(pairs, rules))
        found[minutes] = pairs, kept, _keys(pairs, minutes)[kept]
    common = found[0.0][2]
    for _, _, keys in found.values():
        common = np.intersect1d(common, keys)
    require(common.size, "no measured value at the simulated times; some expected")
    models = []
    for minutes, (_, kept, keys) in found.items():
        rows = kept[np.flatnonzero(np.isin(keys, common))]
        rows = rows[np.argsort(keys[np.isin(keys, common)], kind="stable")]
        shift = rules.shift_minutes + minutes
        models.append(_expanded(expansion, moved, simulated, rules, shift, rows))
    pairs, kept, keys = found[0.0]
    inside = np.isin(keys, common)
    rows = kept[inside][np.argsort(keys[inside], kind="stable")]
    chosen = pairs.where(rows)
    if components is None:
        components = np.zeros((1, *simulated.values.shape))
    error = _sensor_errors(components, chosen, moved, simulated, rules, rows)
    groups = np.array([group_of(name) for name in pairs.names])[chosen.series]
    gains = {
        names.index(name): (groups == grid) | (not grid)
        for name, grid in quantities.gains.items()
    }
    for name, grid in quantities.gains.items():
        known = ", ".join(sorted(set(groups.tolist())))
        require(
            not grid or (groups == grid).any(),
            f'quantity "{name}" acts on grid "{grid}"; one of {known} expected',
        )
    return CalibrationModel(
        quantities.unknowns, chosen, tuple(shifts), tuple(models), clock, gains, error
    )


def _keys(pairs: Pairs, minutes: float) -> np.ndarray:
    # Number of each pair by series and unshifted time
    seconds = pairs.times.astype("datetime64[s]").astype(np.int64) - round(60 * minutes)
    return np.asarray(seconds * len(pairs.names) + pairs.series)


def _expanded(
    expansion: Expansion,
    measured: Sequence[Series],
    simulated: Series,
    rules: Rules,
    minutes: float,
    rows: np.ndarray,
) -> Expansion:
    # The expansion at the times and sensors of the pairs
    def aligned(values: np.ndarray) -> np.ndarray:
        return _aligned(values, measured, simulated, rules, minutes, rows)[:, None]

    parts = tuple(
        Part(
            aligned(part.value),
            part.factors,
            {n: aligned(v) for n, v in (part.first or {}).items()},
            {n: aligned(v) for n, v in (part.second or {}).items()},
        )
        for part in expansion.scenarios[0]
    )
    return Expansion(expansion.reference, (parts,))


def _aligned(
    values: np.ndarray,
    measured: Sequence[Series],
    simulated: Series,
    rules: Rules,
    minutes: float,
    rows: np.ndarray,
) -> np.ndarray:
    # Values over (sensor, time) at the times and sensors of the pairs
    own = Series(
        simulated.names,
        simulated.times,
        values.astype(float),
        simulated.step_minutes,
        simulated.utc_offset_hours,
    )
    return np.asarray(value_pairs(measured, own, rules, minutes).simulated[rows])


def _sensor_errors(
    components: np.ndarray,
    pairs: Pairs,
    measured: Sequence[Series],
    simulated: Series,
    rules: Rules,
    rows: np.ndarray,
) -> SensorErrors:
    # Components are averaged over time steps as the values are
    minutes = rules.shift_minutes
    parts = [
        _aligned(own, measured, simulated, rules, minutes, rows) for own in components
    ]
    lux = np.where(pairs.simulated > 0, pairs.simulated, np.inf)
    return SensorErrors(pairs.series, np.stack(parts, axis=1) / lux[:, None])


def _values(expansion: Expansion, named: dict[str, np.ndarray]) -> np.ndarray:
    # In double precision, as derivatives are differences
    total: np.ndarray | float = 0.0
    for part in expansion.scenarios[0]:
        weights = part.weights(named, expansion.reference)[0]
        terms = np.stack([term[:, 0] for term in part.terms()])
        total = total + weights @ terms
    return np.asarray(total)


def _chosen(expansion: Expansion, rows: np.ndarray) -> Expansion:
    parts = tuple(
        Part(
            part.value[rows],
            part.factors,
            {n: v[rows] for n, v in (part.first or {}).items()},
            {n: v[rows] for n, v in (part.second or {}).items()},
        )
        for part in expansion.scenarios[0]
    )
    return Expansion(expansion.reference, (parts,))
