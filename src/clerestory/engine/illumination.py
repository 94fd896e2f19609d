"""Illuminated scenes: a scene with all its light sources, and its path tracer."""

from dataclasses import dataclass

from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.emitter_sampling import Environment, SurfaceEmitters
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.mirrors import Mirrors
from clerestory.engine.origin import Origin
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.portals import Portals
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.sun_sampling import Suns
from clerestory.scene.model import Scene

# Russian roulette applies to paths below this fraction of their initial throughput.
_ROULETTE = 0.2


@dataclass
class Illumination:
    """A scene on the device, with all its light sources."""

    model: LoweredScene
    distant: DistantEmitters
    mirrors: Mirrors
    lobes: SunLobes

    @classmethod
    def of(cls, scene: Scene, origin: Origin) -> "Illumination":
        """Return the illuminated scene, with device coordinates around `origin`."""
        return cls(
            lower(scene, origin=origin),
            DistantEmitters.of(scene),
            Mirrors.of(scene),
            SunLobes.of(scene),
        )

    def suns(self, portals: Portals | None) -> Suns:
        """Return the source that samples the suns."""
        return Suns(self.model, self.distant, self.mirrors, self.lobes, portals)

    def tracer(
        self, portals: Portals | None = None, *, split_lobes: bool = False
    ) -> PathTracer:
        """Return the path tracer of radiance; see `PathTracer`."""
        suns = (self.suns(portals),) if self.distant.suns else ()
        sources = (Environment(self.distant), *suns, SurfaceEmitters(self.model))
        return PathTracer(
            self.model, sources, _ROULETTE, portals, split_lobes=split_lobes
        )
