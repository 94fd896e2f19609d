"""Next-event estimation of surfaces that emit light: direct and mirrored."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.lower import LoweredScene
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.mirrors import by_mirrors
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Scattering,
    Source,
    Vertex,
)
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.visibility import towards, transmittance


@dataclass
class SurfaceEmitters(Source):
    """Surfaces that emit light, sampled by area and power, and their mirror images.

    A path stores the state of reflections since the last vertex with next-event
    estimation, the density of the direction sampled there [1/sr], the length of the
    path since then [m], and the cell of that vertex.
    """

    name: ClassVar[str] = "emitters"
    model: LoweredScene
    images: MirrorImages

    @property
    def mirrored(self) -> bool:
        """Whether mirror images of emitters are sampled."""
        return self.model.emitters.count > 0 and self.images.count > 0

    def begin(self, pdf, sunlit, point):
        """Return state, density, length and cell at the start of a first segment."""
        if not self.mirrored:
            return None
        other = self.images.outside
        cell = self.images.cells.number(point)
        state = dr.select(pdf > 0, mi.UInt32(0), other)
        return state, mi.Float(pdf), mi.Float(0), cell

    def remember(self, si, vertex: Vertex, after: Scattering, memory):
        """Return state, density, length and cell for the next path segment."""
        state, pdf, length, cell = memory
        state = self.images.remember(self.model, state, vertex.shape, si, after)
        same = after.null | after.delta
        pdf = dr.select(same, pdf, after.densities.path)
        cell = dr.select(same, cell, self.images.cells.number(si.p))
        return state, pdf, dr.select(same, length + si.t, 0), cell

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool] | None:
        """Return the radiance of the front of an emitter; camera rays pass illums."""
        emitters = self.model.emitters
        if emitters.shapes == 0:
            return None
        role = dr.gather(mi.UInt32, self.model.emitter_of_shape, shape, active)
        ended = active & (role > 0)
        number, cosine = role - 1, -dr.dot(path.ray.d, si.n)
        illum = dr.gather(mi.Bool, emitters.illum, number, ended)
        view_only = dr.gather(mi.Bool, emitters.view_only, number, ended)
        ended &= ~(illum & (path.camera | (cosine <= 0)))
        shining = ended & (cosine > 0) & (path.camera | ~view_only)
        radiance = emitters.emitted(number, -path.ray.d, shining)
        distance2, own = dr.squared_norm(si.p - path.point), path.pdf
        chance = mi.Float(1)
        if self.mirrored:
            state, pdf, length, cell = path.memory[self.name]
            share = self.images.probability(state, cell)
            mirrored = share > 0
            distance2 = dr.select(mirrored, dr.square(length + si.t), distance2)
            own, chance = dr.select(mirrored, pdf, own), dr.select(mirrored, share, 1)
        pdf = chance * emitters.pdf(number, distance2, cosine, shining)
        return Emission(radiance, shining, pdf, path_pdf=own), ended

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield directions to a point of an emitter, and to the image of one."""
        if self.model.emitters.count == 0:
            return
        yield self.direct(vertex, numbers)
        if self.mirrored:
            yield self.by_image(vertex, numbers)

    def direct(self, vertex: Vertex, numbers: PathNumbers) -> LightSample:
        """Return a sampled direction to a point of an emitter."""
        emitters = self.model.emitters
        u, v, pick = (numbers.extra(purpose) for purpose in (2, 3, 1))
        point, normal, number = emitters.sample_point(pick, u, v)
        across = point - vertex.point
        distance2 = dr.squared_norm(across)
        direction = across * dr.rsqrt(distance2)
        cosine = -dr.dot(normal, direction)
        pdf = emitters.pdf(number, distance2, cosine, True)

        def arriving(vertex: Vertex, active):
            radiance = emitters.emitted(number, -direction, active)
            lit = active & (dr.max(radiance) > 0)
            start = vertex.leave(direction, lit)
            return radiance * transmittance(self.model, start, towards(point), lit)

        return LightSample(direction, pdf, cosine > 1e-6, arriving, luminaire=True)

    def by_image(
        self, vertex: Vertex, numbers: PathNumbers, image: mi.UInt32 | None = None
    ) -> LightSample:
        """Return a sampled direction to an image, or to the given image, of a point."""
        emitters = self.model.emitters
        u, v, pick, which = (numbers.extra(purpose) for purpose in (12, 13, 14, 15))
        point, normal, number = emitters.sample_point(pick, u, v)
        image, chance, rate = self.images.choose(which, numbers, vertex.point, image)
        aim = self.images.image(image, point)
        across = aim - vertex.point
        distance2 = dr.squared_norm(across)
        direction = across * dr.rsqrt(distance2)
        leaving = -self.images.source_direction(image, direction)
        cosine = dr.dot(normal, leaving)
        pdf = chance * emitters.pdf(number, distance2, cosine, True)

        def arriving(vertex: Vertex, active):
            radiance = emitters.emitted(number, leaving, active)
            lit = active & (dr.max(radiance) > 0)
            start = vertex.leave(direction, lit)
            share = by_mirrors(self.model, self.images, start, aim, image, numbers, lit)
            return radiance * share / rate

        active = (cosine > 1e-6) & (rate > 0)
        return LightSample(direction, pdf, active, arriving, luminaire=True)
