"""Expansion of the hourly illuminance of a study in its unknown quantities.

Light is proportional to the transmittance of windows and to the radiance of sky and
sun. In reflectances and in the transmittance of panes of the scene, the illuminance is
expanded to second order.
"""

from collections.abc import Mapping

import numpy as np

from clerestory.errors import InputError
from clerestory.matrix.derivatives import pair_indices
from clerestory.phases.illuminance_derivatives import illuminance_derivatives
from clerestory.phases.matrix_equation import Skies, Term
from clerestory.study.inputs import study_weather
from clerestory.study.job import Job
from clerestory.study.retracing import (
    Situation,
    Source,
    linear_parts,
    part_values,
    retraced,
    with_weather,
)
from clerestory.study.study_tracing import differentiated_matrices
from clerestory.study.unknown_quantities import UnknownQuantities
from clerestory.uncertainty.expansion import Expansion, Pair, Part, by_differences

# First and second derivatives by name, over (part, sensor, time)
Derivatives = tuple[dict[str, np.ndarray], dict[Pair, np.ndarray]]

_WHOLE = Term("illuminance", "whole")

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

    names = unknowns.materials
    if not names:
        values = part_values(chosen, kinds)
        return tuple(
            Part(lux, factors)
            for (factors, _, _), lux in zip(kinds, values, strict=True)
        )
    if _by_differences(job, names):
        found = _differences(job, unknowns, chosen)
    else:
        found = _traced_derivatives(job, unknowns, chosen)
    first, second = found
    return tuple(
        Part(
            lux,
            factors,
            {name: own[k].astype(np.float32) for name, own in first.items()},
            {pair: own[k].astype(np.float32) for pair, own in second.items()},
        )
        for k, ((factors, _, _), lux) in enumerate(
            zip(kinds, part_values(chosen, kinds), strict=True)
        )
    )


def _by_differences(job: Job, names: Mapping[str, str]) -> bool:
    # Matrices of direct light have no derivatives, but depend on panes of the scene
    direct = any(term.part != "whole" for term in job.study.terms)
    panes = any(not job.scene.materials[own].opaque for own in names.values())
    return direct and panes


def _traced_derivatives(
    job: Job, unknowns: UnknownQuantities, situation: Situation
) -> Derivatives:
    # From the paths of the matrices, for each part
    names = {material: name for name, material in unknowns.materials.items()}
    windows = differentiated_matrices(job, list(names))
    firsts: list[np.ndarray] = []
    seconds: list[np.ndarray] = []
    for _, group, source in linear_parts(situation, unknowns):
        own = windows if group is None else windows[group : group + 1]
        states = situation.states
        if group is not None:
            states = states[group : group + 1]
        found = [
            illuminance_derivatives(own, (_WHOLE,), skies, states)
            for skies in _sources(situation.skies, source)
        ]
        for sums, name in (
            (firsts, "illuminance_derivative"),
            (seconds, "illuminance_second_derivative"),
        ):
            plus, *minus = (one[name].values for one in found)
            sums.append(plus - minus[0] if minus else plus)
    order = [names[own] for own in names]
    pairs = [(order[i], order[j]) for i, j in pair_indices(len(order))]
    first, second = np.stack(firsts, axis=1), np.stack(seconds, axis=1)
    return dict(zip(order, first, strict=True)), dict(zip(pairs, second, strict=True))


def _sources(skies: Skies, source: Source) -> list[Skies]:
    # Skies whose light is that of a source, or the difference of two
    if source == "both":
        return [skies]
    assert skies.sun is not None
    sun = Skies(skies.sun, skies.sun, skies.suns)
    return [sun] if source == "sun" else [skies, sun]


def _differences(
    job: Job, unknowns: UnknownQuantities, situation: Situation
) -> Derivatives:
    # Central differences of rooms that are traced again, for each part
    names, of = unknowns.materials, {own.name: own for own in unknowns.unknowns}
    kinds = linear_parts(situation, unknowns)

    def evaluate(at: Mapping[str, float]) -> np.ndarray:
        changed = {names[n]: v for n, v in at.items() if v != unknowns.reference[n]}
        again = retraced(job, changed, situation)
        return np.stack(part_values(again, kinds)).astype(float)

    reference, sizes = {name: of[name].reference for name in names}, {}
    for name, value in reference.items():
        own = of[name].distribution
        room = min(_LARGEST_STEP * value, max(own.high - value, 0.02 * value))
        sizes[name] = min(own.standard_deviation, room)
    _, first, second = by_differences(evaluate, reference, sizes)
    return first, second
