"""Next-event estimation of suns: direct, mirrored, and on sunlit surfaces.

BSDF-sampled paths hardly ever hit the sun's image in a pane or a mirror. Suns are
therefore also sampled by way of flat smooth surfaces (`mirror_images`). Sunlit
blinds and sunlit areas of the room are sampled by one ray along a lobe of transmitted
sunlight or towards a portal; a shadow ray to the sun starts where this ray hits.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.conditional_evaluation import where_needed
from clerestory.engine.distant_emitters import DistantEmitters, SunSample
from clerestory.engine.lower import LoweredScene
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.mirrors import by_mirrors
from clerestory.engine.next_event_estimation import (
    ConditionalSample,
    Densities,
    Emission,
    LightSample,
    Path,
    Scattering,
    Source,
    Vertex,
    balance_heuristic,
    power_heuristic,
)
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import CONNECT_U, CONNECT_V, VERTICES, PathNumbers
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.vertices import surface_vertex
from clerestory.engine.visibility import (
    along,
    interaction,
    only_reflects,
    transmittance,
)

# Probability that a ray to sunlit surfaces is sampled along a lobe, not to a portal.
_LOBES = 0.5

# Density stored for a path segment whose start samples no ray to sunlit surfaces.
NOT_SAMPLED = -1.0


@dataclass
class Suns(Source):
    """Suns of a scene, sampled in proportion to their power.

    A path stores two values: the state of reflections since the last vertex with
    next-event estimation (see `mirror_images`), and the density of sampling the path
    segment as a ray to sunlit surfaces [1/sr], negative if no such ray was sampled.
    """

    name: ClassVar[str] = "suns"
    model: LoweredScene
    distant: DistantEmitters
    images: MirrorImages
    lobes: SunLobes
    portals: Portals | None

    @property
    def seeks_sunlit(self) -> bool:
        """Whether the scene has window lobes or portals of sunlit surfaces."""
        return bool(self.lobes.groups or (self.portals and self.portals.sunny))

    def begin(self, pdf, sunlit, point):
        """Return the state and `sunlit` density of a first path segment."""
        other = self.images.outside
        return dr.select(pdf > 0, mi.UInt32(0), other), mi.Float(sunlit)

    def remember(self, si, vertex: Vertex, after: Scattering, memory):
        """Return the state and `sunlit` density of the next path segment."""
        state, _ = memory
        if self.images.count:
            state = self.images.remember(self.model, state, vertex.shape, si, after)
        looked = vertex.active & vertex.opaque & vertex.continues
        looked &= ~after.null & ~after.delta
        return state, dr.select(looked, after.densities.sunlit, NOT_SAMPLED)

    def escaped(self, path: Path, active) -> Emission:
        """Return the radiance of suns in the direction of an escaped path.

        Suns seen by reflections that `samples` samples are excluded.
        """
        radiance, pdf = self.distant.sun_radiance(path.ray.d, active)
        shown = active
        if self.images.count:
            state, _ = path.memory[self.name]
            shown &= ~self.images.known(state)
        return Emission(radiance, shown, pdf, heuristic=power_heuristic)

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield directions to a sun, to sunlit surfaces, and to a mirrored sun."""
        u, v = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
        pick = numbers.extra(0) if self.distant.suns > 1 else mi.Float(0)
        sun = self.distant.sample_sun(pick, u, v)
        shared = self.seeks_sunlit and path is not None
        yield self._direct(sun, path if shared else None)
        if self.seeks_sunlit:
            yield ConditionalSample(
                vertex.opaque & vertex.continues,
                lambda: self._on_surfaces(vertex, sun, numbers),
            )
        if self.images.count:
            yield self.by_image(vertex, numbers)

    def _share_of_path(self, vertex: Vertex, path: Path, sun: SunSample, active):
        # MIS weight of a path at a surface also sampled by rays to sunlit surfaces
        _, sunlit = path.memory[self.name]
        other = self._sunlit_pdf(sun, path.ray.d, sunlit)
        shared = (sunlit >= 0) & (path.pdf > 0)
        shared &= _is_sought(self.model, vertex.shape, active)
        share = path.pdf * balance_heuristic(path.pdf, other)
        return dr.select(shared, share, 1)

    def _direct(self, sun: SunSample, path: Path | None = None) -> LightSample:
        # `path`: path to be weighted against rays to sunlit surfaces
        def arriving(vertex: Vertex, active):
            start = vertex.leave(sun.direction, active)
            light = sun.radiance * self._seen(start, sun, active)
            if path is None:
                return light
            lit = active & (dr.max(light) > 0)
            return light * where_needed(
                lit,
                lambda lit: self._share_of_path(vertex, path, sun, lit),
                lambda: mi.Float(0),
            )

        always = mi.Bool(True)
        return LightSample(
            sun.direction, sun.pdf, always, arriving,
            heuristic=power_heuristic, luminaire=True,
        )  # fmt: skip

    def _seen(self, start: mi.Point3f, sun: SunSample, active):
        # Transmittance along the shadow ray from a point to the sun
        ray = along(sun.direction)
        return transmittance(self.model, start, ray, active, through_illums=True)

    def _on_surfaces(
        self, vertex: Vertex, sun: SunSample, numbers: PathNumbers
    ) -> LightSample:
        # Sample along a window's lobe of sunlight, or towards a portal. The coordinates
        # are also those of the sun sample of a later vertex, which causes no bias: the
        # contributions of both vertices are added, not multiplied
        other = numbers.at(numbers.vertex + VERTICES // 2)
        u, v, pick = other.sobol(CONNECT_U), other.sobol(CONNECT_V), numbers.extra(10)
        direction, valid = mi.Vector3f(0, 0, 1), mi.Bool(False)
        portals = self.portals if self.portals and self.portals.sunny else None
        if portals:
            direction, valid = portals.sample(
                portals.sunlit, vertex.point, vertex.cell, u, v
            )
        if self.lobes.groups:
            share = _LOBES if portals else 1.0
            chosen = pick < share
            group = dr.minimum(pick / share, 1)
            lobe = self.lobes.sample(group, sun.direction, u, v)
            direction = dr.select(chosen, lobe, direction)
            valid |= chosen

        def arriving(vertex: Vertex, active):
            ray = mi.Ray3f(vertex.leave(direction, active), direction)
            return self.on_surface(sun, ray, active)

        def pdf(densities: Densities):
            return self._sunlit_pdf(sun, direction, densities.sunlit)

        return LightSample(direction, pdf, valid, arriving)

    def on_surface(self, sun: SunSample, ray: mi.Ray3f, active):
        """Return the radiance of sunlight scattered along a ray by the surface hit.

        The radiance is zero for surfaces that `_is_sought` excludes.
        """
        hit = self.model.scene.ray_intersect_preliminary(ray, active=active)
        active = active & hit.is_valid()
        si = interaction(hit, ray, active)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        active &= _is_sought(self.model, shape, active)
        vertex = surface_vertex(self.model, None, si, shape, active, mi.Bool(False))
        light, lit = self._direct(sun).estimate(vertex, active)
        return dr.select(lit, light, 0)

    def _sunlit_pdf(self, sun: SunSample, direction, in_portals):
        # Density of sampling a direction as a ray to sunlit surfaces [1/sr]
        if not self.lobes.groups:
            return in_portals
        in_lobes = self.lobes.pdf(direction, sun.direction)
        if not (self.portals and self.portals.sunny):
            return in_lobes
        return _LOBES * in_lobes + (1 - _LOBES) * in_portals

    def direct(self, vertex: Vertex, numbers: PathNumbers) -> LightSample:
        """Return a sampled direction to a sun."""
        sun = self.distant.sample_sun(*(numbers.extra(n) for n in (4, 5, 6)))
        return self._direct(sun)

    def by_image(
        self, vertex: Vertex, numbers: PathNumbers, image: mi.UInt32 | None = None
    ) -> LightSample:
        """Return a sampled direction to an image, or to the given image, of a sun."""
        sun = self.distant.sample_sun(*(numbers.extra(n) for n in (4, 5, 6)))
        image, chance, rate = self.images.choose(
            numbers.extra(7), numbers, vertex.point, image
        )
        direction = self.images.image(image, sun.direction)

        def arriving(vertex: Vertex, active):
            start = vertex.leave(direction, active)
            share = by_mirrors(
                self.model, self.images, start, direction, image, numbers, active
            )
            return sun.radiance * share / rate

        return LightSample(
            direction, sun.pdf * chance, rate > 0, arriving,
            heuristic=None, luminaire=True,
        )  # fmt: skip


def _is_sought(model: LoweredScene, shape, active):
    # Whether rays to sunlit surfaces sample a shape: an opaque surface with a non-delta
    # BSDF, or a BSDF layer
    flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, active)
    depth = dr.gather(mi.Float, model.thickness_of_shape, shape, active)
    matt = mi.has_flag(flags, mi.BSDFFlags.Smooth) & only_reflects(flags)
    layer = dr.gather(mi.Bool, model.layer_of_shape, shape, active)
    emitter = dr.gather(mi.UInt32, model.emitter_of_shape, shape, active)
    return active & (depth == 0) & (emitter == 0) & (matt | layer)
