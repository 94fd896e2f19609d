"""Next-event estimation of sunlight transmitted by a window's BSDF.

Directions to the window are sampled by solid angle and by the BSDF lobes for the
incident direction of the sun, so wide and narrow lobes converge alike. Direct
transmission (the peak of the BSDF), if separated, is an additional term with the
angular width of the solar disc.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.materials.bsdf_file import forward_table
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Source,
    Vertex,
)
from clerestory.engine.origin import Origin
from clerestory.engine.peak_extraction import PeakTable
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
)
from clerestory.engine.sun_lobes import Lobes
from clerestory.engine.visibility import (
    ROUNDING,
    along,
    first_opaque,
    towards,
    transmittance,
)
from clerestory.engine.windows import WindowTable, window_shapes

# Solar disc: 1 − cosine of its angular radius, and its solid angle [sr]
_DEPTH = 2 * float(np.sin(np.radians(0.533) / 4)) ** 2
_SOLID_ANGLE = 2 * np.pi * _DEPTH


@dataclass
class SunlitWindow(Source):
    """A window lit by a sun of unit direct normal irradiance, with its surroundings.

    Attributes
    ----------
    inside : scene with all windows as receivers, at which paths in the room end
    outside : scene without windows
    own, role : `WindowTable` of this window, and 1 + index of the window in `inside`
    lobes : BSDF of the window, sampled for the incident direction of the sun
    peak : direct transmission as a separate term; None: part of the lobes
    middle, sun : unit vectors to the centre and to a point of the solar disc, by path
    """

    name: ClassVar[str] = "sunlit window"
    inside: LoweredScene
    outside: LoweredScene
    own: WindowTable
    role: int
    lobes: Lobes
    peak: PeakTable | None
    middle: mi.Vector3f | None = None
    sun: mi.Vector3f | None = None

    @classmethod
    def of(cls, job, origin: Origin) -> "SunlitWindow":
        """Return the window of a job, not yet lit by a sun (see `lit_by`)."""
        own, _ = window_shapes((job.windows[job.number],), origin)
        frame = mi.Frame3f(own.right, own.up, own.normal)
        return cls(
            inside=lower(job.scene, origin=origin, receivers=job.windows),
            outside=lower(job.scene, origin=origin),
            own=own,
            role=job.number + 1,
            lobes=Lobes(forward_table(job.bsdf), frame, 1, 1.0),
            peak=PeakTable(job.bsdf) if job.peak else None,
        )

    def lit_by(self, middle: mi.Vector3f, a: mi.Float, b: mi.Float) -> "SunlitWindow":
        """Return the window lit by suns around the unit vectors `middle`.

        The random numbers a and b choose a point of the solar disc.
        """
        height = a * _DEPTH
        flat = dr.sqrt(height * (2 - height))
        sine, cosine = dr.sincos(2 * dr.pi * b)
        local = mi.Vector3f(flat * cosine, flat * sine, 1 - height)
        return replace(self, middle=middle, sun=mi.Frame3f(middle).to_world(local))

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return the radiance of the window: scattered and direct sunlight."""
        towards_eye = -path.ray.d
        role = dr.gather(mi.UInt32, self.inside.window_of_shape, shape, active)
        front = active & (role == self.role)
        front &= dr.dot(towards_eye, self.lobes.frame.n) > 1e-6
        value, _ = self._scattered(towards_eye)
        on_sun = 0.5 * dr.squared_norm(path.ray.d - self.middle) <= _DEPTH
        value += dr.select(on_sun, self._straight(self.middle) / _SOLID_ANGLE, 0)
        front &= dr.max(value) > 0
        return Emission(value * self._outside(si.p, front), front), active & (role > 0)

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield directions to a window point, along a BSDF lobe, and to the sun."""
        u, v = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
        yield self._to_window(vertex, u, v)
        u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        yield self._along_lobe(vertex, u, v)
        if self.peak is not None:
            yield self._to_sun()

    def _scattered(self, direction):
        # Radiance scattered by the window into a direction, and pdf of its lobes [1/sr]
        frame = self.lobes.frame
        leaving, incident = frame.to_local(direction), frame.to_local(self.sun)
        value, density = self.lobes.table.evaluate(mi.UInt32(0), leaving, incident)
        value = self.lobes.table.colour(value)
        if self.peak is not None:
            value = self.peak.without(value, leaving, incident)
        slant = dr.maximum(-incident.z, 0)
        return value * slant, density * dr.maximum(leaving.z, 0)

    def _straight(self, sun):
        # Direct transmittance of the window
        if self.peak is None:
            return mi.Color3f(0)
        leaving = self.lobes.frame.to_local(-sun)
        return dr.select(leaving.z > 0, self.peak.transmittance(leaving), 0)

    def _outside(self, point, active):
        # Transmittance from the sun through the outside scene to a point of the window
        normal = self.lobes.frame.n
        reach = dr.maximum(dr.max(dr.abs(point)), 0.05)
        lit = active & (dr.dot(normal, self.sun) < 0)
        start = point - normal * (ROUNDING * reach)
        seen = transmittance(self.outside, start, along(self.sun), lit)
        return dr.select(lit, seen, 0)

    def _to_window(self, vertex: Vertex, u, v) -> LightSample:
        point, direction, _, cosine, pdf = self.own.sample_direction(vertex.point, u, v)
        value, density = self._scattered(-direction)

        def arriving(vertex: Vertex, active):
            start = vertex.leave(direction, active)
            seen = transmittance(self.inside, start, towards(point), active)
            active = active & (dr.max(seen) > 0)
            return value * seen * self._outside(point, active)

        active = (cosine > 1e-6) & (dr.max(value) > 0)
        return LightSample(direction, pdf + density, active, arriving, heuristic=None)

    def _along_lobe(self, vertex: Vertex, u, v) -> LightSample:
        leaving = -self.lobes.sample(self.sun, u, v)
        value, density = self._scattered(leaving)
        point, element = mi.Point3f(0), mi.UInt32(0)

        def arriving(vertex: Vertex, active):
            nonlocal point, element
            seen, si = self._from_window(vertex, -leaving, active)
            point, element = si.p, si.prim_index >> 1
            return value * seen

        def pdf(_densities):
            cosine = dr.dot(leaving, self.lobes.frame.n)
            return density + self.own.pdf(vertex.point, element, point, cosine)

        active = dr.max(value) > 0
        return LightSample(-leaving, pdf, active, arriving, heuristic=None)

    def _to_sun(self) -> LightSample:
        value = self._straight(self.sun)

        def arriving(vertex: Vertex, active):
            return value * self._from_window(vertex, self.sun, active)[0]

        active = dr.max(value) > 0
        return LightSample(self.sun, mi.Float(1), active, arriving, heuristic=None)

    def _from_window(self, vertex: Vertex, direction, active):
        # Transmittance from the vertex through the window to the sun, and the hit
        inside, start = self.inside, vertex.leave(direction, active)
        share, ray, hit = first_opaque(inside, start, along(direction), active)
        active = active & hit.is_valid()
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        role = dr.gather(mi.UInt32, inside.window_of_shape, shape, active)
        active &= role == self.role
        return share * self._outside(si.p, active), si
