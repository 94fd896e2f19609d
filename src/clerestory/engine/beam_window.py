"""A window as the source of narrow beams of sunlight, for next-event estimation."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
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
)
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.sun_beams import Beams
from clerestory.engine.upload import vectors
from clerestory.engine.visibility import ROUNDING, along, first_opaque, transmittance


@dataclass
class BeamWindow(Source):
    """A window and, for each vertex, the direction in which it transmits a narrow beam.

    Attributes
    ----------
    inside, outside : scene with all windows as receivers, and without windows
    role : 1 + index of the window in `inside`
    normal : unit normal of the window, into the room
    direction, sun, value : by path, unit vectors against the beam and to the sun, and
        the irradiance perpendicular to the beam
    """

    name: ClassVar[str] = "beams"
    inside: LoweredScene
    outside: LoweredScene
    role: int
    normal: mi.Vector3f
    direction: mi.Vector3f | None = None
    sun: mi.Vector3f | None = None
    value: mi.Color3f | None = None

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return no radiance: windows that are seen directly are not lit by beams."""
        role = dr.gather(mi.UInt32, self.inside.window_of_shape, shape, active)
        return Emission(mi.Color3f(0), mi.Bool(False)), active & (role > 0)

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield the direction against the beam."""

        def arriving(vertex: Vertex, active):
            start = vertex.leave(self.direction, active)
            return self.value * self.seen(start, active)

        active = dr.max(self.value) > 0
        yield LightSample(self.direction, mi.Float(1), active, arriving, heuristic=None)

    def seen(self, start: mi.Point3f, active) -> mi.Color3f:
        """Return the transmittance from the sun, by way of the window, to points."""
        inside = self.inside
        share, ray, hit = first_opaque(inside, start, along(self.direction), active)
        met = active & hit.is_valid()
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        met &= dr.gather(mi.UInt32, inside.window_of_shape, shape, met) == self.role
        met &= dr.dot(self.normal, self.sun) < 0
        reach = dr.maximum(dr.max(dr.abs(si.p)), 0.05)
        start = si.p - self.normal * (ROUNDING * reach)
        passed = transmittance(self.outside, start, along(self.sun), met)
        return dr.select(met, share * passed, 0)

    def open_to(self, sun: mi.Vector3f, start: mi.Point3f, active) -> mi.Color3f:
        """Return whether nothing but the window is between points and the sun."""
        blocked = self.outside.scene.ray_test(mi.Ray3f(start, sun), active)
        return dr.select(active & ~blocked, mi.Color3f(1), 0)

    def along(self, direction: mi.Vector3f, sun: mi.Vector3f) -> "BeamWindow":
        """Return the window with beams of given directions."""
        return replace(self, direction=direction, sun=sun)

    def lit(self, beams: Beams, beam) -> "BeamWindow":
        """Return the window with the beams of given indices, one for each path."""
        direction, sun, value = (
            dr.gather(mi.Vector3f, vectors(mi.Vector3f, part.reshape(-1, 3)), beam)
            for part in (beams.direction, beams.sun, beams.value)
        )
        return replace(self, direction=direction, sun=sun, value=mi.Color3f(value))
