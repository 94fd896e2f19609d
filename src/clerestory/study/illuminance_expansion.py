"""Expansion of the hourly illuminance of a study in its unknown quantities.

Light is proportional to the transmittance of windows and to the radiance of sky and
sun. In reflectances and in the transmittance of panes of the scene, the illuminance is
expanded to second order.
"""

from collections.abc import Mapping

import numpy as np

from clerestory.errors import InputError
from clerestory.phases.matrix_equation import Skies
from clerestory.study.inputs import study_weather
from clerestory.study.job import Job
from clerestory.study.retracing import (
    Situation,
    linear_parts,
    retraced,
    with_weather,
)
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.uncertainty.expansion import Expansion, Part, by_differences

# Largest step of a difference, as a share of the value
_LARGEST_STEP = 0.5


def situations(
    job: Job, unknowns: UnknownQuantities, situation: Situation
) -> list[Situation]:
    """Return the situation of a study, and those with its other weather files."""
    found = [situation]
    if not unknowns.weather:
        return found
    count = len(situation.skies.times)
    for file in unknowns.tables[unknowns.weather].files:
        table = job.study.weather.model_copy(update={"file": file})
        weather = study_weather(job.study.model_copy(update={"weather": table}))
        if len(weather.times) != count:
            steps = f"has {len(weather.times):,} time steps"
            raise InputError(f"{steps}; {count:,} as in [weather] expected", file=file)
        found.append(with_weather(job, weather, situation))
    return found


def illuminance_expansion(
    job: Job,
    unknowns: UnknownQuantities,
    every: list[Situation],
    steps: np.ndarray,
) -> Expansion:
    """Return the illuminance at some time steps as a function of the quantities."""
    scenarios = tuple(_parts(job, unknowns, one, steps) for one in every)
    return Expansion(unknowns.reference, scenarios, unknowns.weather)


def direct_expansion(
    unknowns: UnknownQuantities, every: list[Situation], steps: np.ndarray
) -> Expansion:
    """Return the direct sun with open shades as a function of the quantities."""
    scenarios = []
    for one in every:
        opened = [np.zeros(len(one.skies.times), int)] * len(one.states)
        parts = []
        for factors, group, source in linear_parts(one, unknowns):
            if source == "sky":
                continue
            matrices, states = one.matrices, opened
            if group is not None:
                windows = (matrices.windows[group],)
                matrices = type(matrices)(matrices.terms, windows, matrices.suns)
                states = opened[group : group + 1]
            found = matrices.direct_illuminance(
                _at(one.skies, steps), _all(states, steps)
            )
            lux = found["illuminance"].values.astype(np.float32)
            parts.append(Part(lux, factors))
        scenarios.append(tuple(parts))
    return Expansion(unknowns.reference, tuple(scenarios), unknowns.weather)


def _at(skies: Skies, steps: np.ndarray) -> Skies:
    return skies.select(steps)


def _all(states: list[np.ndarray], steps: np.ndarray) -> list[np.ndarray]:
    return [own[steps] for own in states]


def _parts(
    job: Job, unknowns: UnknownQuantities, situation: Situation, steps: np.ndarray
) -> tuple[Part, ...]:
    chosen = situation.at(steps)
    kinds = linear_parts(situation, unknowns)

    def values(one: Situation) -> np.ndarray:
        return np.stack([one.lux(group, source) for _, group, source in kinds])

    names = {name: own for name, own in unknowns.materials.items()}
    if not names:
        return tuple(
            Part(lux, factors)
            for (factors, _, _), lux in zip(kinds, values(chosen), strict=True)
        )

    def evaluate(at: Mapping[str, float]) -> np.ndarray:
        changed = {names[n]: v for n, v in at.items() if v != unknowns.reference[n]}
        return values(retraced(job, changed, chosen)).astype(float)

    of = {own.name: own for own in unknowns.unknowns}
    reference = {name: of[name].reference for name in names}
    sizes = {}
    for name in names:
        value, own = reference[name], of[name].distribution
        room = min(_LARGEST_STEP * value, max(own.high - value, 0.02 * value))
        sizes[name] = min(own.standard_deviation, room)
    values_there, first, second = by_differences(evaluate, reference, sizes)
    return tuple(
        Part(
            values_there[k].astype(np.float32),
            factors,
            {n: own[k].astype(np.float32) for n, own in first.items()},
            {n: own[k].astype(np.float32) for n, own in second.items()},
        )
        for k, (factors, _, _) in enumerate(kinds)
    )
