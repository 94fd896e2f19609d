"""Illuminated scenes: a scene with its sky, suns and emitters, and its path tracer."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Source,
    Vertex,
)
from clerestory.engine.origin import Origin
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.sun_sampling import Suns
from clerestory.engine.visibility import towards, transmittance
from clerestory.scene.model import Scene

# Russian roulette applies to paths below this fraction of their initial throughput.
_ROULETTE = 0.2


@dataclass
class Environment(Source):
    """Sky and ground at infinity."""

    name: ClassVar[str] = "environment"
    distant: DistantEmitters

    def escaped(self, path: Path, active) -> Emission:
        """Return the radiance of sky and ground in the direction of an escaped path."""
        return Emission(self.distant.environment_radiance(path.ray.d), active)


@dataclass
class SurfaceEmitters(Source):
    """Surfaces that emit light, sampled by area and power."""

    name: ClassVar[str] = "emitters"
    model: LoweredScene

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return the radiance of the front of an emitter; camera rays pass illums."""
        emitters = self.model.emitters
        role = dr.gather(mi.UInt32, self.model.emitter_of_shape, shape, active)
        ended = active & (role > 0)
        number, cosine = role - 1, -dr.dot(path.ray.d, si.n)
        illum = dr.gather(mi.Bool, emitters.illum, number, ended)
        view_only = dr.gather(mi.Bool, emitters.view_only, number, ended)
        ended &= ~(illum & (path.camera | (cosine <= 0)))
        shining = ended & (cosine > 0) & (path.camera | ~view_only)
        radiance = emitters.emitted(number, -path.ray.d, shining)
        distance2 = dr.squared_norm(si.p - path.point)
        pdf = emitters.pdf(number, distance2, cosine, shining)
        return Emission(radiance, shining, pdf), ended

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield one sampled direction to a point of an emitter."""
        emitters = self.model.emitters
        if emitters.count == 0:
            return
        u, v, pick = (numbers.extra(purpose) for purpose in (2, 3, 1))
        point, direction, cosine, pdf, number = emitters.sample_direction(
            vertex.point, pick, u, v
        )

        def arriving(vertex: Vertex, active):
            radiance = emitters.emitted(number, -direction, active)
            lit = active & (dr.max(radiance) > 0)
            start = vertex.leave(direction, lit)
            return radiance * transmittance(self.model, start, towards(point), lit)

        yield LightSample(direction, pdf, cosine > 1e-6, arriving, luminaire=True)


@dataclass
class Illumination:
    """A scene on the compute device, with all its light sources."""

    model: LoweredScene
    distant: DistantEmitters
    images: MirrorImages
    lobes: SunLobes

    @classmethod
    def of(cls, scene: Scene, origin: Origin) -> "Illumination":
        """Return the illuminated scene, with translated coordinates around `origin`."""
        model = lower(scene, origin=origin)
        return cls(
            model,
            DistantEmitters.of(scene),
            MirrorImages.of(model.smooth, distant=True),
            SunLobes.of(scene),
        )

    def suns(self, portals: Portals | None) -> Suns:
        """Return the source that samples the suns."""
        return Suns(self.model, self.distant, self.images, self.lobes, portals)

    def tracer(
        self, portals: Portals | None = None, *, split_lobes: bool = False
    ) -> PathTracer:
        """Return the path tracer of radiance; see `PathTracer`."""
        suns = (self.suns(portals),) if self.distant.suns else ()
        sources = (Environment(self.distant), *suns, SurfaceEmitters(self.model))
        return PathTracer(
            self.model, sources, _ROULETTE, portals, split_lobes=split_lobes
        )
