"""Transforms that map a light source to its images by several plane reflections."""

from dataclasses import dataclass, field
from heapq import heappop, heappush

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.smooth_faces import Planes

# Number of planes or orientations, the most reflecting ones, that form images by
# several reflections; largest number of images.
FEW, _IMAGES = 8, 320

# Least reflectance of the images by three and more reflections: the product of the
# surfaces' reflectances near normal incidence. Three panes of glass reflect 0.0006.
_LEAST = 5e-4

# Factor on the sampling weight of a surface for each further reflection that leads to
# the image; smallest weight.
_LATER, _LAST = 0.1, 1e-12

# Tolerances of equal transforms: rotation, and shift [m].
_SAME, _SAME_SHIFT = 3e-4, 2e-3


@dataclass
class Compositions:
    """Compositions of reflections, which are the states of a path.

    Attributes
    ----------
    reflect, move : reflections in the planes: linear part, and shift [m]
    linear, shift : transforms of the states; state 0 is a path without reflections
    weight : sampling weights of the states
    reflectance : products of the reflectances near normal incidence
    last : plane of the last reflection
    missing : largest reflectance of the compositions that are omitted
    """

    reflect: Float[np.ndarray, "plane 3 3"]
    move: Float[np.ndarray, "plane 3"]
    linear: list[np.ndarray]
    shift: list[np.ndarray]
    weight: list[float]
    reflectance: list[float]
    last: list[int]
    missing: float = 0.0
    _waiting: list[tuple[float, int, int, float]] = field(default_factory=list)

    @classmethod
    def of(cls, planes: Planes) -> "Compositions":
        """Return the most probable compositions of reflections in planes."""
        normal, offset = planes.normal, planes.offset
        reflect = np.eye(3) - 2 * normal[:, :, None] * normal[:, None, :]
        move = 2 * offset[:, None] * normal
        made = cls(
            reflect, move, [np.eye(3), *reflect], [np.zeros(3), *move],
            [0.0, *planes.weight], [1.0, *planes.reflectance],
            [-1, *range(len(normal))],
        )  # fmt: skip
        for plane in range(min(len(normal), FEW)):
            made._continue(plane + 1, planes)
        while made._waiting and len(made.linear) <= _IMAGES:
            weight, state, plane, reflectance = heappop(made._waiting)
            if made._add(state, plane, -weight, reflectance):
                made._continue(len(made.linear) - 1, planes)
        for _, state, plane, reflectance in made._waiting:
            if reflectance > made.missing and made._known(state, plane) is None:
                made.missing = reflectance
        if len(normal) > FEW:
            pair = planes.reflectance[FEW:].max() * planes.reflectance.max()
            made.missing = max(made.missing, float(pair))
        return made

    def steps(self) -> Int[np.ndarray, "state_and_other plane_and_none"]:
        """Return the next state, by state and 1 + index of the plane.

        Repeated reflections in planes beyond the first `FEW` lead to the state `other`.
        """
        count, planes = len(self.linear), len(self.reflect)
        step = np.full((count + 1, planes + 1), count)
        step[0, 1:] = np.arange(1, planes + 1)
        for state in range(1, count):
            for plane in range(min(planes, FEW)):
                if self.last[state] < FEW:
                    same = self._known(state, plane)
                    step[state, plane + 1] = count if same is None else same
        return step

    def beginnings(
        self, guide: Float[np.ndarray, "state_and_other state"], planes: Planes
    ) -> tuple[
        Int[np.ndarray, " pair"], Int[np.ndarray, " pair"], Float[np.ndarray, " pair"]
    ]:
        """Return pairs of a state and a plane that reflects first.

        Also return the largest reflectance of the paths of each pair, estimated from
        the number of further reflections after the first one.
        """
        after = guide[1 : len(self.reflect) + 1]
        plane, state = np.nonzero(after)
        missing = np.log(after[plane, state]) / np.log(_LATER)
        share = planes.reflectance.max(initial=0) ** missing
        share *= planes.reflectance[plane]
        return state, plane, np.minimum(share, np.array(self.reflectance)[state])

    def _continue(self, state: int, planes: Planes) -> None:
        # Put further reflections after a state in the queue, the most probable first
        for plane in range(min(len(self.reflect), FEW)):
            reflectance = self.reflectance[state] * float(planes.reflectance[plane])
            if plane == self.last[state] and not planes.apart[plane]:
                continue
            if state <= len(self.reflect) or reflectance >= _LEAST:
                weight = -self.weight[state] * float(planes.weight[plane])
                heappush(self._waiting, (weight, state, plane, reflectance))

    def _add(self, state: int, plane: int, weight: float, reflectance: float) -> bool:
        # Return whether the composition is a new state
        same = self._known(state, plane)
        if same is not None:
            self.weight[same] += weight
            return False
        linear, shift = self._after(state, plane)
        self.linear.append(linear)
        self.shift.append(shift)
        self.weight.append(weight)
        self.reflectance.append(reflectance)
        self.last.append(plane)
        return True

    def _after(self, state: int, plane: int) -> tuple[np.ndarray, np.ndarray]:
        return (
            self.linear[state] @ self.reflect[plane],
            self.linear[state] @ self.move[plane] + self.shift[state],
        )

    def _known(self, state: int, plane: int) -> int | None:
        linear, shift = self._after(state, plane)
        turn = np.abs(np.array(self.linear[1:]) - linear).max(axis=(1, 2))
        away = np.abs(np.array(self.shift[1:]) - shift).max(axis=1)
        same = np.flatnonzero((turn < _SAME) & (away < _SAME_SHIFT))
        return int(same[0]) + 1 if len(same) else None


def guidance(
    step: Int[np.ndarray, "state_and_other plane_and_none"],
) -> Float[np.ndarray, "state_and_other state"]:
    """Return sampling weights of surfaces, by state after reflection and image.

    The weight decreases with the number of further reflections that lead to the image,
    and is 0 if none do.
    """
    count = len(step) - 1
    guide = np.eye(count + 1)
    reached = guide > 0
    for distance in range(1, count):
        # States from which one reflection leads to a state that was reached before
        further = reached[step[:, 1:]].any(axis=1) & ~reached
        further[count] = False
        if not further.any():
            break
        guide[further] = max(_LATER**distance, _LAST)
        reached |= further
    guide[count] = 0
    return np.asarray(guide[:, :count])
