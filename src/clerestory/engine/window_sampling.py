"""Windows and sky patches as columns of a matrix."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Source,
    Vertex,
    balance_heuristic,
)
from clerestory.engine.patches import SkyTable
from clerestory.engine.sampler import CONNECT_U, CONNECT_V, PathNumbers
from clerestory.engine.visibility import towards, transmittance

# Number of window points sampled per vertex, in a lattice. Compared with one point,
# three points divide the work (time × variance) for single coefficients by 1.7, with
# equal work for sums over many patches; more points increase the work for sums.
SAMPLES = 3


@dataclass
class SkyPatches(Source):
    """Patches of the sky, reached by paths that leave the scene."""

    name: ClassVar[str] = "sky patches"
    table: SkyTable

    def escaped(self, path: Path, active) -> Emission:
        """Return the sky patch that an escaped path reaches."""
        return Emission(mi.Color3f(1), active, column=self.table.find(path.ray.d))


@dataclass
class WindowPatches(Source):
    """Patches of the windows of a scene, sampled by solid angle or area.

    If `direct`, light from the windows counts as direct and passes proxies.
    """

    name: ClassVar[str] = "windows"
    model: LoweredScene
    direct: bool

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return the window patch of a path that hits the front of a window."""
        windows = self.model.windows
        role = dr.gather(mi.UInt32, self.model.window_of_shape, shape, active)
        at_window = active & (role > 0)
        window = role - 1
        normal = dr.gather(mi.Vector3f, windows.normal, window, at_window)
        cosine = -dr.dot(path.ray.d, normal)
        first = dr.gather(mi.UInt32, windows.first_element, window, at_window)
        element = first + (si.prim_index >> 1)
        pdf = windows.pdf(path.point, element, si.p, cosine)
        column = windows.find(window, -path.ray.d)
        front = at_window & (cosine > 1e-6)
        return Emission(mi.Color3f(1), front, SAMPLES * pdf, column), at_window

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield samples of directions to points of the windows."""
        a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
        for number in range(SAMPLES):
            u, v = a + number / SAMPLES, b + number * 0.618034
            yield self._sample(vertex, u - dr.floor(u), v - dr.floor(v))

    def _sample(self, vertex: Vertex, u, v) -> LightSample:
        model, windows = self.model, self.model.windows
        point, direction, window, cosine, pdf = windows.sample_direction(
            vertex.point, u, v
        )

        def arriving(vertex: Vertex, active):
            start, ray = vertex.leave(direction, active), towards(point)
            return transmittance(
                model, start, ray, active, direct=self.direct, through_illums=True
            )

        return LightSample(
            direction,
            SAMPLES * pdf,
            (cosine > 1e-6) & vertex.continues,
            arriving,
            windows.find(window, -direction),
            heuristic=None if self.direct else balance_heuristic,
        )
