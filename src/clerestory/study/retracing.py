"""Hourly illuminance of a study with other values of unknown quantities, traced again.

The seeds are those of the study, so that the results have most of their statistical
error in common with those of the study.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from clerestory.matrix.error_components import UNIT
from clerestory.phases.illuminance import PARTS
from clerestory.phases.matrix_equation import Skies, States
from clerestory.scene.material_parameters import with_parameters
from clerestory.sky.weather import Weather
from clerestory.study.job import Job
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study
from clerestory.study.unknown_quantities import UnknownQuantities

# Light of the sky, of the sun, or of both
Source = str


@dataclass(frozen=True, eq=False)
class Situation:
    """Matrices, skies and shade states of a study, for some time steps."""

    matrices: StudyMatrices
    skies: Skies
    states: States

    def at(self, steps: np.ndarray) -> "Situation":
        """Return the situation at some time steps."""
        states = [own[steps] for own in self.states]
        return Situation(self.matrices, self.skies.select(steps), states)

    def groups(self) -> int:
        """Return the number of window groups, or of scenes with glazing."""
        return len(self.matrices.windows)

    def error_components(self) -> Float[np.ndarray, "component sensor time"]:
        """Return the error components of the illuminance [lux]."""
        found = self.matrices.illuminance(self.skies, self.states)
        sizes = found["standard_error"].values / np.float32(UNIT)
        parts = found[PARTS].values * sizes[:, None]
        return np.asarray(parts.transpose(1, 0, 2))

    def lux(
        self, group: int | None = None, source: Source = "both"
    ) -> Float[np.ndarray, "sensor time"]:
        """Return the illuminance through one window group, or all [lux]."""
        if source == "sky":
            return np.asarray(self.lux(group) - self.lux(group, "sun"))
        matrices, states = self.matrices, self.states
        if group is not None:
            matrices = replace(matrices, windows=(matrices.windows[group],))
            states = states[group : group + 1]
        skies = self.skies
        if source == "sun":
            sun = skies.sun
            assert sun is not None
            skies = Skies(sun, sun, skies.suns)
        found = matrices.illuminance(skies, states)
        return np.asarray(found["illuminance"].values, dtype=np.float32)


def retraced(job: Job, values: Mapping[str, float], situation: Situation) -> Situation:
    """Return the situation with other values of materials, traced again.

    `values` are by name of the material; skies and shade states stay.
    """
    if not values:
        return situation
    scene = with_parameters(job.scene, values)
    changed = replace(job, inputs=replace(job.inputs, scene=scene))
    return replace(situation, matrices=trace_study(changed))


def with_weather(job: Job, weather: Weather, situation: Situation) -> Situation:
    """Return the situation in another year, with the same shade states."""
    changed = replace(job, inputs=replace(job.inputs, weather=weather))
    matrices = trace_study(changed)
    skies = study_skies(changed.study, changed.inputs, matrices.suns)
    return Situation(matrices, skies, situation.states)


def part_values(
    situation: Situation, kinds: Sequence[tuple[tuple[str, ...], int | None, Source]]
) -> list[Float[np.ndarray, "sensor time"]]:
    """Return the illuminance of each part [lux]; see `linear_parts`."""
    return [situation.lux(group, source) for _, group, source in kinds]


def whole_illuminance(
    situation: Situation, unknowns: UnknownQuantities, values: Mapping[str, float]
) -> Float[np.ndarray, "sensor time"]:
    """Return the illuminance with factors of windows, sky and sun [lux]."""
    total: np.ndarray | float = 0.0
    for factors, group, source in linear_parts(situation, unknowns):
        scale = np.prod([values[name] for name in factors])
        total = total + scale * situation.lux(group, source)
    return np.asarray(total, dtype=np.float32)


def linear_parts(
    situation: Situation, unknowns: UnknownQuantities
) -> list[tuple[tuple[str, ...], int | None, Source]]:
    """Return the parts of the illuminance: factors, window group, source.

    The parts are as few as the factors allow.
    """
    count = situation.groups()
    every = tuple(range(count))
    common = [n for n, own in unknowns.windows.items() if own == every]
    separate = any(own != every for own in unknowns.windows.values())
    chosen: list[int | None] = list(range(count)) if separate else [None]
    both = not (unknowns.sky or unknowns.sun)
    sources = {"both": ()} if both else {"sky": unknowns.sky, "sun": unknowns.sun}
    parts = []
    for group in chosen:
        own = [
            name
            for name, groups in unknowns.windows.items()
            if name not in common and group in groups
        ]
        for source, factors in sources.items():
            parts.append(((*common, *own, *factors), group, source))
    return parts
