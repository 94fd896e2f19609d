"""Windows and sky patches as columns of a matrix, and windows as recorded columns."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Scattering,
    Source,
    Vertex,
    balance_heuristic,
)
from clerestory.engine.origin import Origin
from clerestory.engine.patches import SkyTable
from clerestory.engine.sampler import CONNECT_U, CONNECT_V, PathNumbers
from clerestory.engine.square import cell_of_disc
from clerestory.engine.upload import on_device, vectors
from clerestory.engine.visibility import towards, transmittance
from clerestory.scene.window_zones import DIRECTION_BITS, STRAIGHT, WindowZones

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
class SeparatedSkyPatches(Source):
    """Patches of the sky, in separate columns for direct and other light.

    A path counts the surfaces that scattered it; a mirrored path counts as scattered
    twice, since next-event estimation does not find suns in mirrors.

    Attributes
    ----------
    patches : number of patches: columns of direct light, before those of other light
    scattered : largest number of surfaces that scatter direct light
    window_of_shape : if given, whether a shape is a window: windows are not counted,
        but clear glass, which is not counted otherwise
    """

    name: ClassVar[str] = "sky patches"
    table: SkyTable
    patches: int
    scattered: int
    window_of_shape: mi.Bool | None = None

    def begin(self, pdf, sunlit, point):
        """Return the number of surfaces that scattered a path at its start."""
        return (dr.zeros(mi.UInt32, dr.width(point)),)

    def remember(self, si, vertex: Vertex, after: Scattering, memory):
        """Return the number of surfaces that scattered the path so far."""
        times = dr.select(after.delta, mi.UInt32(2), mi.UInt32(1))
        free = after.null
        if self.window_of_shape is not None:
            free = dr.gather(mi.Bool, self.window_of_shape, vertex.shape, vertex.active)
        return (memory[0] + dr.select(free, mi.UInt32(0), times),)

    def escaped(self, path: Path, active) -> Emission:
        """Return the sky patch that an escaped path reaches."""
        (times,) = path.memory[self.name]
        other = times > self.scattered
        first = dr.select(other, mi.UInt32(self.patches), mi.UInt32(0))
        column = first + self.table.find(path.ray.d)
        return Emission(mi.Color3f(1), active, column=column)


@dataclass
class WindowPatches(Source):
    """Patches of the windows of a scene, sampled by solid angle or area.

    If `direct`, light from the windows counts as direct and passes proxies.
    """

    name: ClassVar[str] = "windows"
    model: LoweredScene
    direct: bool

    def column(self, window, direction, point):
        """Return the column of light that leaves a point of a window in a direction."""
        return self.model.windows.find(window, direction)

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return the window patch of a path that hits the front of a window."""
        windows = self.model.windows
        role = dr.gather(mi.UInt32, self.model.window_of_shape, shape, active)
        at_window = active & (role > 0)
        window = role - 1
        first = dr.gather(mi.UInt32, windows.first_element, window, at_window)
        element = first + (si.prim_index >> 1)
        normal = dr.gather(mi.Vector3f, windows.facing, element, at_window)
        cosine = -dr.dot(path.ray.d, normal)
        pdf = windows.pdf(path.point, element, si.p, cosine)
        column = self.column(window, -path.ray.d, si.p)
        front = at_window & (cosine > 1e-6) & windows.shines(window, -path.ray.d)
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

        shadow_ray = towards(point)

        def arriving(vertex: Vertex, active):
            start, ray = vertex.leave(direction, active), shadow_ray
            return transmittance(
                model, start, ray, active, direct=self.direct, through_illums=True
            )

        return LightSample(
            direction,
            SAMPLES * pdf,
            (cosine > 1e-6) & vertex.continues & windows.shines(window, -direction),
            arriving,
            self.column(window, -direction, point),
            heuristic=None if self.direct else balance_heuristic,
            shadow_ray=shadow_ray,
        )


@dataclass
class ZoneTable:
    """Dr.Jit arrays of the zones of windows: rectangles of a grid on each window.

    By window: corner and inverse edges of the grid, numbers of zones along the edges,
    and index of the first zone.
    """

    corner: mi.Point3f
    across: mi.Vector3f
    upwards: mi.Vector3f
    columns: mi.UInt32
    rows: mi.UInt32
    first: mi.UInt32

    @classmethod
    def of(cls, zones: WindowZones, origin: Origin) -> "ZoneTable":
        """Return the table of the zones of a job."""
        edges = zones.across, zones.upwards
        across, upwards = (e / np.square(e).sum(axis=1)[:, None] for e in edges)
        return cls(
            vectors(mi.Point3f, zones.corner - origin),
            vectors(mi.Vector3f, across),
            vectors(mi.Vector3f, upwards),
            *(on_device(mi.UInt32, each) for each in (*zones.counts.T, zones.first)),
        )

    def find(self, window, point):
        """Return the zone of a point of a window."""
        place = point - dr.gather(mi.Point3f, self.corner, window)
        found = []
        for edge, count in ((self.across, self.columns), (self.upwards, self.rows)):
            share = dr.dot(dr.gather(mi.Vector3f, edge, window), place)
            most = mi.Int32(dr.gather(mi.UInt32, count, window))
            step = mi.Int32(dr.floor(share * mi.Float(most)))
            found.append(mi.UInt32(dr.clip(step, 0, most - 1)))
        column, row = found
        start = dr.gather(mi.UInt32, self.first, window)
        return start + row * dr.gather(mi.UInt32, self.columns, window) + column


@dataclass
class WindowCells(WindowPatches):
    """Directions and zones of the windows of a scene; see `scene.window_zones`."""

    zones: ZoneTable

    def column(self, window, direction, point):
        """Return exit direction and zone; see `scene.window_zones`."""
        local = self.model.windows.to_local(window, direction)
        return mi.Vector2u(
            cell_of_disc(local, 1 << DIRECTION_BITS), self.zones.find(window, point)
        )

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return exit direction and zone of a path that hits the front of a window."""
        found, ends = super().met(path, si, shape, active)
        return replace(found, column=found.column | mi.Vector2u(0, STRAIGHT)), ends
