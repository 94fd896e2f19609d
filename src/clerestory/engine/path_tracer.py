"""Path tracer for radiance, irradiance and transfer matrices.

Paths are traced from the receiver. At every vertex the sources are sampled (next-event
estimation), then the path continues by BSDF sampling or path guiding; both techniques
are combined by multiple importance sampling. Contributions are added to a sink: the
columns of a matrix, or the radiance of a pixel or sensor.

References: J. Kajiya, "The rendering equation", SIGGRAPH 1986; M. Pharr, W. Jakob,
G. Humphreys, Physically Based Rendering, 4th edition, 2023, section 13.4.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi

from clerestory.engine.caustic_lobes import Caustics
from clerestory.engine.lower import LoweredScene
from clerestory.engine.material_derivatives import MaterialDerivatives
from clerestory.engine.next_event_estimation import (
    Bandwise,
    Emission,
    Path,
    Scattering,
    Source,
    Vertex,
)
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.sinks import Sink
from clerestory.engine.sun_sampling import NOT_SAMPLED
from clerestory.engine.vertices import (
    continue_from_sensor,
    continue_from_surface,
    sensor_vertex,
    surface_vertex,
)
from clerestory.engine.visibility import interaction, passes_proxy

# Largest number of vertices of a path, never reached in physical scenes.
_MOST_VERTICES = 1000

# Density of a first path segment whose contribution is left to next-event estimation.
SAMPLED_AT_START = 1e-20

# Density of directions along narrow cones of sunlight [1/sr].
_NARROW = 10.0

# Limit of segments that represents unlimited bounces.
_UNLIMITED = 1 << 30


def segments_of(bounces: int | None, *, first: int = 1) -> int:
    """Return 1 + the largest number of diffuse reflections of a path.

    `bounces` is Radiance's -ab, or None for no limit; `first` is 1 if the first segment
    is not a bounce (camera ray), and 0 if it is one (ray from a sensor).
    """
    return _UNLIMITED if bounces is None else bounces + first


@dataclass
class PathTracer:
    """Path tracer of a scene, with its sources and sampling techniques.

    Attributes
    ----------
    roulette : fraction of the throughput at the start, or behind the last surface that
        transmitted the path, below which Russian roulette applies
    caustics : cones of focused sunlight; None if no surface focuses any
    direct_only : whether paths end at the first surface, where sources are sampled by
        next-event estimation only
    without_direct : whether light is left out that comes straight from a source or by
        one reflection, other than in a mirror, at the first surface
    bounce_to_source : whether the segment to a source is counted as a bounce, as for
        the windows of a matrix
    derivatives : parameters by which matrices are differentiated; None without any
    """

    model: LoweredScene
    sources: tuple[Source, ...]
    roulette: float
    portals: Portals | None = None
    caustics: Caustics | None = None
    direct_only: bool = False
    without_direct: bool = False
    bounce_to_source: bool = False
    split_lobes: bool = False
    derivatives: MaterialDerivatives | None = None

    def path(self, ray, throughput, pdf, *, sunlit=NOT_SAMPLED, camera=False) -> Path:
        """Return a path at its first segment; see `Path` and `Source.begin`."""
        pdf, sunlit = mi.Float(pdf), mi.Float(sunlit)
        memory = {each.name: each.begin(pdf, sunlit, ray.o) for each in self.sources}
        return Path(
            mi.Ray3f(ray), self.model.uniform(throughput), mi.Point3f(ray.o), pdf,
            mi.Bool(camera), {name: each for name, each in memory.items() if each},
            self.derivatives and self.derivatives.begin(),
        )  # fmt: skip

    def camera_path(self, ray: mi.Ray3f) -> Path:
        """Return a path whose first segment is a camera ray."""
        return self.path(ray, 1, 0, camera=True)

    def gather(
        self,
        sink: Sink,
        numbers: PathNumbers,
        position: mi.Point3f,
        normal: mi.Vector3f,
    ) -> tuple[mi.Color3f | None, Path]:
        """Sample the sources at sensors; return the irradiance and continued paths."""
        caustics = self.caustics and self.caustics.sensors
        vertex = sensor_vertex(self.portals, position, normal, caustics)
        if self.model.throughput is not None:
            vertex = replace(vertex, in_bands=self.model.throughput.uniform)
        one = self.model.uniform(1)
        total = self.sample_sources(sink, sink.begin(), vertex, numbers, one)
        direction, weight, pdf = continue_from_sensor(
            self.portals, vertex, normal, numbers
        )
        ray = mi.Ray3f(position, direction)
        return total, self.path(ray, weight, pdf.path, sunlit=pdf.sunlit)

    def sample_sources(
        self,
        sink: Sink,
        total: mi.Color3f | None,
        vertex: Vertex,
        numbers: PathNumbers,
        throughput: Bandwise,
        path: Path | None = None,
        counted: mi.Bool | bool = True,
        si: mi.SurfaceInteraction3f | None = None,
    ) -> mi.Color3f | None:
        """Add the contributions of next-event estimation at a vertex."""
        active = vertex.active & counted
        if self.bounce_to_source:
            active = active & vertex.continues
        for source in self.sources:
            for number, sample in enumerate(source.samples(vertex, path, numbers)):
                light, lit = sample.estimate(vertex, active)
                value = throughput * vertex.scattered(light)
                total = sink.add(total, sample.column, value, lit)
                if self.derivatives is not None:
                    scores = self.derivatives.connected(
                        path, vertex, si, sample, numbers, number, lit
                    )
                    sink.differentiate(sample.column, value, scores, lit)
        return total

    @dr.syntax
    def trace(
        self,
        sink: Sink,
        path: Path,
        start: PathNumbers,
        limit: int,
        active: mi.Bool,
        total: mi.Color3f | None = None,
    ):
        """Trace paths to their ends; return the sum including their contributions.

        `start` holds the sample numbers of the paths' first vertex; `limit` is
        1 + the largest number of diffuse reflections.
        """
        model, scene = self.model, self.model.scene
        segments = dr.opaque(mi.UInt32, limit)
        total = sink.begin() if total is None else total

        # ----------------------------- Loop state -----------------------------
        strongest = dr.maximum(dr.max(path.throughput), 1e-20)
        depth = mi.UInt32(1)  # 1 + number of diffuse reflections so far
        number = mi.UInt32(1)  # number of vertices, including the start
        # Order of the light that the path meets: 0 straight, 1 reflected once, 2 other
        order = mi.UInt32(0) if self.without_direct else mi.UInt32(2)

        while active:
            hit = scene.ray_intersect_preliminary(path.ray, active=active)
            met = active & hit.is_valid()
            for source in self.sources:
                found = source.escaped(path, active & ~met)
                total = _collect(sink, total, path, found, order > 1)

            si = interaction(hit, path.ray, met)
            shape = dr.reinterpret_array(mi.UInt32, si.shape)
            active = mi.Bool(met)
            for source in self.sources:
                surface = source.met(path, si, shape, met)
                if dr.hint(surface is not None, mode="scalar"):
                    total = _collect(sink, total, path, surface[0], order > 1)
                    active &= ~surface[1]

            # Sample the sources at the vertex; camera rays see the proxied geometry
            thickness, passed, works = None, None, active
            if dr.hint(model.proxies, mode="scalar"):
                thickness = dr.gather(mi.Float, model.thickness_of_shape, shape, active)
                passed = (thickness != 0) & path.camera
                passed |= passes_proxy(thickness, si.wi.z)
                thickness = dr.select(passed, 0, thickness)
                works = active & ~passed
            numbers = start.at(number)
            vertex = surface_vertex(
                model, self.portals, si, shape, works, depth < segments, thickness,
                self.caustics and self.caustics.surfaces,
            )  # fmt: skip
            total = self.sample_sources(
                sink, total, vertex, numbers, path.throughput, path, order > 0, si
            )

            if dr.hint(self.direct_only and not model.panes, mode="scalar"):
                active = mi.Bool(False)
            else:
                # Continue the path; null transmission keeps the previous vertex and pdf
                after = continue_from_surface(
                    self.portals, vertex, si, numbers, works,
                    split_lobes=self.split_lobes,
                )  # fmt: skip
                if dr.hint(model.proxies, mode="scalar"):
                    after.pass_straight(passed, si)
                path = self._continued(path, vertex, si, after, numbers, active)
                diffuse = mi.has_flag(after.flags, mi.BSDFFlags.Diffuse)
                diffuse &= ~after.null & ~after.delta
                depth += dr.select(diffuse, mi.UInt32(1), mi.UInt32(0))
                strength = dr.max(path.throughput)
                active &= (strength > 0) & (depth <= segments)
                if dr.hint(self.direct_only, mode="scalar"):
                    active &= after.null
                if dr.hint(self.without_direct, mode="scalar"):
                    other = (order > 0) | after.delta
                    order = dr.select(after.null, order, dr.select(other, 2, 1))

                # Russian roulette; transmitted paths and those along a cone of sunlight
                # carry little until they find the bright sky or the sun
                through = dr.dot(after.direction, si.n) * si.wi.z < 0
                through &= active & (strength > 0)
                strongest = dr.select(through, strength, strongest)
                if dr.hint(self.caustics is not None, mode="scalar"):
                    narrow = (after.densities.path > _NARROW) & (strength > 0)
                    strongest = dr.select(narrow, strength, strongest)
                survive = dr.minimum(strength / (strongest * self.roulette), 1)
                active &= start.hashed(number + 0x10000) < survive
                path.throughput /= survive
                number += 1
                active &= number < _MOST_VERTICES

        return total

    def _continued(
        self, path: Path, vertex: Vertex, si, after: Scattering, numbers, active
    ) -> Path:
        # Next segment of a path
        scores = path.scores
        if self.derivatives is not None:
            works = vertex.active
            scores = self.derivatives.continued(
                scores, vertex, si, after, numbers, works
            )
        sampled = ~after.delta
        if self.bounce_to_source:
            sampled &= vertex.continues
        pdf = dr.select(sampled, after.densities.path, 0)
        memory = {
            source.name: source.remember(si, vertex, after, path.memory[source.name])
            for source in self.sources
            if source.name in path.memory
        }
        return Path(
            mi.Ray3f(vertex.leave(after.direction, active), after.direction),
            path.throughput * vertex.scattered(after.factor),
            dr.select(after.null, path.point, si.p),
            dr.select(after.null, path.pdf, pdf),
            path.camera & (after.null | after.delta),
            memory,
            scores,
        )


def _collect(sink: Sink, total, path: Path, found: Emission | None, counted):
    # Add the radiance of a source hit by the path
    if found is None:
        return total
    arriving = found.value
    if not isinstance(path.throughput, mi.Color3f):
        arriving = arriving[0]  # receivers are the same in all bands
    value = path.throughput * arriving * found.share(path)
    if path.scores is not None:
        sink.differentiate(found.column, value, path.scores, found.active & counted)
    return sink.add(total, found.column, value, found.active & counted)
