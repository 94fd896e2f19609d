"""Next-event estimation and multiple importance sampling.

A *source* is a light source or a receiver: suns, sky, emitters, or the windows and sky
patches of a matrix. A source returns the radiance found by a path (BSDF sampling), and
samples directions from a vertex to the source (next-event estimation). This module
combines both techniques.

References: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
chapter 9 (balance and power heuristics); M. Pharr, W. Jakob, G. Humphreys, Physically
Based Rendering, 4th edition, 2023, section 13.4.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.caustic_lobes import Cones
from clerestory.engine.conditional_evaluation import where_needed
from clerestory.engine.sampler import PathNumbers

# Values in three channels, or in all bands of a scene
Bandwise = Any

Heuristic = Callable[[mi.Float, mi.Float], mi.Float]


def balance_heuristic(own, other):
    """Return the balance heuristic weight per density `own` [sr].

    `own` and `other` are the densities of both sampling techniques [1/sr].
    """
    return dr.rcp(own + other)


def power_heuristic(own, other):
    """Return the power heuristic weight (exponent 2) per density `own` [sr].

    Paths transmitted unscattered by a layer occasionally hit the small solar disc. With
    the balance heuristic, one pixel in some hundreds would receive a twentieth of the
    sun's radiance in this way; with the power heuristic the contribution is negligible.
    """
    return dr.rcp(own * (1 + dr.square(other / own)))


@dataclass
class Densities:
    """Densities of sampling a direction at a vertex [1/sr].

    `path` is the density of the continued path, `sunlit` the density of rays towards
    sunlit surfaces in portals.
    """

    path: mi.Float
    sunlit: mi.Float


@dataclass
class Vertex:
    """A point at which light arrives and is scattered.

    Attributes
    ----------
    leave : function of direction and mask that returns the vertex point, offset from
        the surface
    faces : function of a direction that returns whether light from there can be
        scattered
    scatter : function of a direction, and of a flag for light directly from a
        luminaire or the sun (`materials.lamp_context`), that returns BSDF × cosine and
        the density of BSDF sampling [1/sr]
    densities : function of direction, density of BSDF sampling and mask that returns
        all densities of the vertex
    active : mask of vertices at which sources are sampled
    shape, flags : Mitsuba's shape index (None for a sensor), and BSDF flags
    cell, chance : guiding cell, and probability that a path continues towards a portal
    cones : cones in which focused sunlight arrives; None: no such light in the scene
    opaque : whether the material only reflects
    continues : whether the path may continue after the vertex
    in_bands : function from the three channels of scattered light to all bands; None if
        paths have three channels
    """

    point: mi.Point3f
    leave: Callable[[mi.Vector3f, mi.Bool], mi.Point3f]
    faces: Callable[[mi.Vector3f], mi.Bool]
    scatter: Callable[..., tuple[mi.Color3f, mi.Float]]
    densities: Callable[[mi.Vector3f, mi.Float, mi.Bool], Densities]
    active: mi.Bool
    shape: mi.UInt32 | None
    flags: mi.UInt32
    cell: mi.UInt32
    chance: mi.Float
    opaque: mi.Bool
    continues: mi.Bool
    cones: Cones | None = None
    in_bands: Callable[[mi.Color3f], Bandwise] | None = None

    def scattered(self, value: mi.Color3f) -> Bandwise:
        """Return scattered light in the channels of a path."""
        return value if self.in_bands is None else self.in_bands(value)


@dataclass
class Path:
    """A path, described at the current segment.

    Attributes
    ----------
    point : previous vertex at which a direction was sampled [m]
    pdf : density of sampling the segment's direction at `point` [1/sr]; 0 if light
        sources were not sampled there
    camera : whether the segment is a camera ray, possibly after mirror reflection or
        direct transmission
    memory : values returned by `Source.begin` or `Source.remember`, by source name
    scores : vertices chosen for derivatives; None if nothing is differentiated
    """

    ray: mi.Ray3f
    throughput: Bandwise
    point: mi.Point3f
    pdf: mi.Float
    camera: mi.Bool
    memory: dict
    scores: Any = None


@dataclass
class Scattering:
    """Continuation of a path at a vertex.

    `factor` multiplies the throughput. `flags` are the BSDF flags of the sampled
    component; `null` marks paths transmitted without deflection, `delta` paths mirrored
    or refracted.
    """

    direction: mi.Vector3f
    factor: mi.Color3f
    densities: Densities
    flags: mi.UInt32
    null: mi.Bool
    delta: mi.Bool

    def pass_straight(self, passed: mi.Bool, si: mi.SurfaceInteraction3f) -> None:
        """Let the masked paths pass the surface undeflected and unattenuated."""
        self.null |= passed
        self.delta &= ~passed
        self.direction = dr.select(passed, -si.to_world(si.wi), self.direction)
        self.factor = dr.select(passed, 1, self.factor)


@dataclass
class Emission:
    """Radiance of a source that a path hits, or 1 for a receiver in a matrix column.

    `pdf` is the density with which next-event estimation at the previous vertex samples
    the direction [1/sr], or None if it does not sample the source. `path_pdf` is the
    density of sampling it by the path, if it differs from that of the path's segment.
    """

    value: mi.Color3f
    active: mi.Bool
    pdf: mi.Float | None = None
    column: mi.UInt32 | None = None
    heuristic: Heuristic = balance_heuristic
    path_pdf: mi.Float | None = None

    def share(self, path: Path):
        """Return the MIS weight of the path against next-event estimation."""
        if self.pdf is None:
            return mi.Float(1)
        own = path.pdf if self.path_pdf is None else self.path_pdf
        return dr.select(own > 0, own * self.heuristic(own, self.pdf), 1)


@dataclass
class LightSample:
    """A sampled direction from a vertex to a source.

    Attributes
    ----------
    pdf : total density of all sampling techniques of the source [1/sr], or a function
        that computes this density from `Densities`, called after `arriving`
    active : mask of samples that may contribute radiance
    arriving : function of vertex and mask that returns the arriving radiance
    heuristic : heuristic that weights the sample and continued paths; None if continued
        paths never meet the source
    luminaire : whether the source is a luminaire or the sun, and not a window or sky
    shadow_ray : function from an origin to the ray to the sampled point
    """

    direction: mi.Vector3f
    pdf: mi.Float | Callable[[Densities], mi.Float]
    active: mi.Bool
    arriving: Callable[[Vertex, mi.Bool], mi.Color3f]
    column: mi.UInt32 | None = None
    heuristic: Heuristic | None = balance_heuristic
    luminaire: bool = False
    shadow_ray: Callable[[mi.Point3f], mi.Ray3f] | None = None

    def estimate(self, vertex: Vertex, active):
        """Return the estimate of scattered radiance, and the mask of nonzero values."""
        active = active & self.active & vertex.faces(self.direction)
        arriving = self.arriving(vertex, active)
        active &= dr.max(arriving) > 0

        def scattered(active):
            value, own = vertex.scatter(self.direction, self.luminaire)
            lit = active & (dr.max(value) > 0)
            densities = None
            if self.heuristic is not None:
                densities = vertex.densities(self.direction, own, lit)
            pdf = self.pdf(densities) if callable(self.pdf) else self.pdf
            weight = dr.rcp(pdf)
            if densities is not None and self.heuristic is not None:
                weight = self.heuristic(pdf, densities.path)
            return value * arriving * weight, lit & (pdf > 0)

        return where_needed(active, scattered, nothing)


@dataclass
class ConditionalSample:
    """A direction that is sampled in packets with active lanes only.

    `sampled` returns the sample; see `LightSample`.
    """

    active: mi.Bool
    sampled: Callable[[], LightSample]
    column: ClassVar[mi.UInt32 | None] = None

    def estimate(self, vertex: Vertex, active):
        """Return the estimate of scattered radiance, and the mask of nonzero values."""

        def estimated(active):
            return self.sampled().estimate(vertex, active)

        return where_needed(active & self.active, estimated, nothing)


def nothing() -> tuple[mi.Color3f, mi.Bool]:
    """Return no radiance, and an empty mask."""
    return mi.Color3f(0), mi.Bool(False)


class Source:
    """Base class of light sources; subclasses override the applicable methods."""

    name: ClassVar[str]

    def escaped(self, path: Path, active: mi.Bool) -> Emission | None:
        """Return the radiance along a path that leaves the scene."""
        return None

    def met(
        self, path: Path, si: mi.SurfaceInteraction3f, shape: mi.UInt32, active: mi.Bool
    ) -> tuple[Emission, mi.Bool] | None:
        """Return the radiance of the surface hit, and the mask of paths that end."""
        return None

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterable[LightSample | ConditionalSample]:
        """Yield samples of directions from a vertex to the source.

        `path` is the path that led to the vertex, or None at a sensor.
        """
        return ()

    def begin(self, pdf: mi.Float, sunlit: mi.Float, point: mi.Point3f):
        """Return the values that the source needs to weight the first path segment.

        `point` is its start, `pdf` the density of the segment's direction, or 0 for
        camera rays; `sunlit` is the density of rays to sunlit surfaces, negative if
        none were sampled [1/sr].
        """
        return

    def remember(
        self, si: mi.SurfaceInteraction3f, vertex: Vertex, after: Scattering, memory
    ):
        """Return the values that the source needs to weight the next path segment."""
        return memory
