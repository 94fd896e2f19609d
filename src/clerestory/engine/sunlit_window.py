"""Sunlit windows as sources: what a window's BSDF scatters of one sun.

The window is sampled by solid angle, and by the lobes into which its BSDF scatters this
very sun, so a smooth blind and a film with lobes of a degree cost the same. What the
BSDF passes straight, if asked for, is a term of its own, sharp as the sun.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.materials.bsdf_file import Table, forward_table
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Source,
    Vertex,
)
from clerestory.engine.peak_extraction import PeakTable
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
)
from clerestory.engine.visibility import first_opaque, towards, transmittance
from clerestory.engine.windows import WindowTable, window_shapes
from clerestory.scene.model import Scene
from clerestory.scene.window import Window

# Depth of the cap of the sun's disc, 1 − cos of its radius, and its solid angle [sr]
_DEPTH = 2 * float(np.sin(np.radians(0.533) / 4)) ** 2
_SOLID_ANGLE = 2 * np.pi * _DEPTH


@dataclass
class SunWindow:
    """One window with its BSDF, and what stands on either side.

    Attributes
    ----------
    inside : the scene with all windows, which end the light of the room side
    outside : the scene without windows
    own : table of this window
    role : its number among the windows, plus one
    table : its BSDF, sampled for light that comes from the sun
    peak : what passes straight, kept apart; None: part of the table
    """

    inside: LoweredScene
    outside: LoweredScene
    own: WindowTable
    role: int
    table: Table
    peak: PeakTable | None

    @classmethod
    def of(
        cls,
        scene: Scene,
        windows: tuple[Window, ...],
        number: int,
        bsdf: Bsdf,
        *,
        peak: bool,
        origin: Float[np.ndarray, "3"],
    ) -> "SunWindow":
        """Return the window with the given number among all windows of a scene."""
        own, _ = window_shapes((windows[number],), origin)
        return cls(
            inside=lower(scene, origin=origin, receivers=windows),
            outside=lower(scene, origin=origin),
            own=own,
            role=number + 1,
            table=forward_table(bsdf),
            peak=PeakTable(bsdf) if peak else None,
        )

    def normal(self):
        """Return the window's normal, towards the room."""
        return self.own.to_scene(mi.UInt32(0), mi.Vector3f(0, 0, 1))

    def sunlight(self, point, sun, active):
        """Return the share of the sun's light that reaches a point from outside."""
        normal = self.normal()
        reach = dr.max(dr.abs(point))
        start = point - normal * (4e-6 * dr.maximum(reach, 0.05))
        lit = active & (dr.dot(normal, sun) < 0)
        seen = transmittance(
            self.outside, start, lambda origin: mi.Ray3f(origin, sun), lit
        )
        return dr.select(lit, seen, 0)

    def transmitted(self, direction, sun):
        """Return the BTDF for light from the sun along a direction, and its density.

        The density is that of drawing the direction from the sun's lobes [1/sr].
        """
        leaving = self.own.to_local(mi.UInt32(0), direction)
        incident = self.own.to_local(mi.UInt32(0), sun)
        value, density = self.table.evaluate(mi.UInt32(0), leaving, incident)
        value = self.table.colour(value)
        if self.peak is not None:
            value = self.peak.without(value, leaving, incident)
        return value, density * dr.maximum(leaving.z, 0)

    def lobe(self, sun, u, v):
        """Return a direction drawn from the lobes of the sun's light."""
        incident = self.own.to_local(mi.UInt32(0), sun)
        disc, _, _ = self.table.sample(mi.UInt32(0), incident, u, v)
        height = dr.safe_sqrt(1 - dr.squared_norm(disc))
        return self.own.to_scene(mi.UInt32(0), mi.Vector3f(disc.x, disc.y, height))

    def straight(self, sun):
        """Return the share of the sun's light that passes straight."""
        if self.peak is None:
            return mi.Color3f(0)
        leaving = self.own.to_local(mi.UInt32(0), -sun)
        return dr.select(leaving.z > 0, self.peak.transmittance(leaving), 0)


@dataclass
class SunlitWindow(Source):
    """A window lit by a sun of unit direct normal irradiance, for each path.

    Attributes
    ----------
    middle, sun : unit vectors to the middle and to a point of the sun's disc
    """

    name: ClassVar[str] = "sunlit window"
    window: SunWindow
    middle: mi.Vector3f
    sun: mi.Vector3f

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return what the window scatters of the sun, and the sun seen through it."""
        window, towards_eye = self.window, -path.ray.d
        role = dr.gather(mi.UInt32, window.inside.window_of_shape, shape, active)
        front = active & (role == window.role)
        front &= dr.dot(towards_eye, window.normal()) > 1e-6
        value, _ = self._scattered(towards_eye)
        on_sun = 0.5 * dr.squared_norm(path.ray.d - self.middle) <= _DEPTH
        through = dr.select(on_sun, window.straight(self.middle) / _SOLID_ANGLE, 0)
        front &= dr.max(value + through) > 0
        seen = window.sunlight(si.p, self.sun, front)
        return Emission((value + through) * seen, front), active & (role > 0)

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield directions to a point of the window, along a lobe, and to the sun."""
        u, v = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
        yield self._to_window(vertex, u, v)
        u, v = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        yield self._along_lobe(vertex, u, v)
        if self.window.peak is not None:
            yield self._to_sun()

    def _scattered(self, direction):
        # Radiance that the window sends in a direction, and the density of its lobes
        value, density = self.window.transmitted(direction, self.sun)
        slant = dr.maximum(-dr.dot(self.sun, self.window.normal()), 0)
        return value * slant, density

    def _to_window(self, vertex: Vertex, u, v) -> LightSample:
        own = self.window.own
        point, direction, _, cosine, pdf = own.sample_direction(vertex.point, u, v)
        value, density = self._scattered(-direction)

        def arriving(vertex: Vertex, active):
            start = vertex.leave(direction, active)
            seen = transmittance(
                self.window.inside, start, lambda o: towards(o, point), active
            )
            active = active & (dr.max(seen) > 0)
            return value * seen * self.window.sunlight(point, self.sun, active)

        active = (cosine > 1e-6) & (dr.max(value) > 0)
        return LightSample(direction, pdf + density, active, arriving, heuristic=None)

    def _along_lobe(self, vertex: Vertex, u, v) -> LightSample:
        leaving = self.window.lobe(self.sun, u, v)
        value, density = self._scattered(leaving)
        point, element = mi.Point3f(0), mi.UInt32(0)

        def arriving(vertex: Vertex, active):
            nonlocal point, element
            seen, si = self._from_window(vertex, -leaving, active)
            point, element = si.p, si.prim_index >> 1
            return value * seen

        def pdf(_densities):
            cosine = dr.dot(leaving, self.window.normal())
            return density + self.window.own.pdf(vertex.point, element, point, cosine)

        active = dr.max(value) > 0
        return LightSample(-leaving, pdf, active, arriving, heuristic=None)

    def _to_sun(self) -> LightSample:
        value = self.window.straight(self.sun)

        def arriving(vertex: Vertex, active):
            return value * self._from_window(vertex, self.sun, active)[0]

        active = dr.max(value) > 0
        return LightSample(self.sun, mi.Float(1), active, arriving, heuristic=None)

    def _from_window(self, vertex: Vertex, direction, active):
        # Share of the sun's light that comes through the window from a direction
        inside = self.window.inside
        start = vertex.leave(direction, active)
        share, ray, hit = first_opaque(
            inside, start, lambda origin: mi.Ray3f(origin, direction), active
        )
        active = active & hit.is_valid()
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        role = dr.gather(mi.UInt32, inside.window_of_shape, shape, active)
        active &= role == self.window.role
        return share * self.window.sunlight(si.p, self.sun, active), si


def on_disc(middle, a, b):
    """Return a direction to the disc of a sun; a, b lie in the unit square."""
    height = a * _DEPTH
    flat = dr.sqrt(height * (2 - height))
    sine, cosine = dr.sincos(2 * dr.pi * b)
    local = mi.Vector3f(flat * cosine, flat * sine, 1 - height)
    return mi.Frame3f(middle).to_world(local)
