"""Illuminated scenes: a scene with its sky, suns and emitters, and its path tracer."""

from dataclasses import dataclass
from typing import ClassVar

import mitsuba as mi

from clerestory.engine.caustic_lobes import Caustics
from clerestory.engine.conditional_evaluation import where_needed
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.emitter_sampling import SurfaceEmitters
from clerestory.engine.light_behind_layers import expect_ratios
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.next_event_estimation import Emission, Path, Source
from clerestory.engine.origin import Origin
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.portals import Portals
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.sun_sampling import Suns
from clerestory.scene.model import Scene

# Russian roulette applies to paths below this fraction of their initial throughput.
# Dim paths reach bright windows: with 0.2, a picture of a room behind a BSDF took 1.2
# times the work (time × variance), with 1.0 three times.
_ROULETTE = 0.08


@dataclass
class Environment(Source):
    """Sky and ground at infinity."""

    name: ClassVar[str] = "environment"
    distant: DistantEmitters

    def escaped(self, path: Path, active) -> Emission:
        """Return the radiance of sky and ground in the direction of an escaped path."""
        radiance = where_needed(
            active,
            lambda _: self.distant.environment_radiance(path.ray.d),
            lambda: mi.Color3f(0),
        )
        return Emission(radiance, active)


@dataclass
class Illumination:
    """A scene on the compute device, with all its light sources."""

    model: LoweredScene
    distant: DistantEmitters
    images_of_suns: MirrorImages
    images_of_emitters: MirrorImages
    lobes: SunLobes

    @classmethod
    def of(cls, scene: Scene, origin: Origin) -> "Illumination":
        """Return the illuminated scene, with translated coordinates around `origin`."""
        model = lower(scene, origin=origin, illuminated=True)
        expect_ratios(model, {})
        return cls(
            model,
            DistantEmitters.of(scene),
            MirrorImages.of(model.smooth, distant=True),
            MirrorImages.of(model.smooth, distant=False),
            SunLobes.of(scene),
        )

    def suns(self, portals: Portals | None) -> Suns:
        """Return the source that samples the suns."""
        return Suns(self.model, self.distant, self.images_of_suns, self.lobes, portals)

    def tracer(
        self,
        portals: Portals | None = None,
        caustics: Caustics | None = None,
        *,
        split_lobes: bool = False,
    ) -> PathTracer:
        """Return the path tracer of radiance; see `PathTracer`."""
        suns = (self.suns(portals),) if self.distant.suns else ()
        emitters = SurfaceEmitters(self.model, self.images_of_emitters)
        sources = (Environment(self.distant), *suns, emitters)
        return PathTracer(
            self.model, sources, _ROULETTE, portals, caustics, split_lobes=split_lobes
        )
