"""Next-event estimation and multiple importance sampling.

A *source* is whatever paths collect: windows, patches of the sky, suns, emitters. It
returns the light that a path meets by itself, and samples directions in which its light
arrives at a vertex, with their density. Both are combined here, and nowhere else.

References: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
chapter 9 (balance and power heuristics); M. Pharr, W. Jakob, G. Humphreys, Physically
Based Rendering, 4th edition, 2023, section 13.4.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar

import drjit as dr
import mitsuba as mi

from clerestory.engine.sampler import PathNumbers

Heuristic = Callable[[mi.Float, mi.Float], mi.Float]


def balance_heuristic(own, other):
    """Return the share of a technique beside another one, over its own density [sr].

    Parameters
    ----------
    own, other : densities of both techniques [1/sr]
    """
    return dr.rcp(own + other)


def power_heuristic(own, other):
    """Return the share of a technique by the squares of densities, over its own [sr].

    A layer that passes light straight on sends a path into the small disc of a sun now
    and then. By densities alone, it would bring a twentieth of the sun's light so, in
    a pixel of some hundreds; by their squares, next to nothing.
    """
    return dr.rcp(own * (1 + dr.square(other / own)))


@dataclass
class Densities:
    """Densities of sampling a direction at a vertex [1/sr].

    Attributes
    ----------
    path : of continuing the path
    sunlit : of looking for sunlit surfaces in portals
    """

    path: mi.Float
    sunlit: mi.Float


@dataclass
class Vertex:
    """A point at which light arrives, and how it is scattered.

    Attributes
    ----------
    point : [m]
    leave : function of direction and mask that returns the point moved off its surface
    scatter : function of a direction that returns BSDF × cosine for light straight from
        a source, and the density of BSDF sampling
    densities : function of direction, density of BSDF sampling and mask that returns
        all densities of the vertex
    active : whether light is sampled
    shape : Mitsuba's shape number; None for a sensor
    flags : Mitsuba's flags of its material
    cell, chance : guiding cell, and chance that a path continues towards a portal
    opaque : whether it only reflects
    continues : whether the path may take another segment
    """

    point: mi.Point3f
    leave: Callable[[mi.Vector3f, mi.Bool], mi.Point3f]
    scatter: Callable[[mi.Vector3f], tuple[mi.Color3f, mi.Float]]
    densities: Callable[[mi.Vector3f, mi.Float, mi.Bool], Densities]
    active: mi.Bool
    shape: mi.UInt32 | None
    flags: mi.UInt32
    cell: mi.UInt32
    chance: mi.Float
    opaque: mi.Bool
    continues: mi.Bool


@dataclass
class Path:
    """A path at one of its segments.

    Attributes
    ----------
    ray : the segment
    throughput : what light that arrives along it counts
    point : the previous vertex at which directions were sampled [m]
    pdf : density of the segment's direction there [1/sr]; 0 if no source could be
        sampled in it
    camera : whether it is a camera ray, or one that was only mirrored or passed
        straight since
    memory : by the name of a source, what it remembers of the previous vertex
    """

    ray: mi.Ray3f
    throughput: mi.Color3f
    point: mi.Point3f
    pdf: mi.Float
    camera: mi.Bool
    memory: dict


@dataclass
class Scattering:
    """How a path continued at a vertex.

    Attributes
    ----------
    direction, factor : of the next segment, and of the throughput
    densities : of the direction
    flags : of the sampled part of the material
    null, delta : whether it passed straight, or was mirrored or refracted
    """

    direction: mi.Vector3f
    factor: mi.Color3f
    densities: Densities
    flags: mi.UInt32
    null: mi.Bool
    delta: mi.Bool


@dataclass
class Emission:
    """Light of a source that a path meets.

    Attributes
    ----------
    value : radiance, or 1 for a receiver of a matrix
    active : where the source is met
    pdf : density of sampling the source so at the previous vertex [1/sr]; None if it
        is not sampled
    column : of a matrix
    heuristic : that shares the light between both
    """

    value: mi.Color3f
    active: mi.Bool
    pdf: mi.Float | None = None
    column: mi.UInt32 | None = None
    heuristic: Heuristic = balance_heuristic

    def share(self, path: Path):
        """Return what of the light counts, beside next-event estimation."""
        if self.pdf is None:
            return mi.Float(1)
        shared = path.pdf * self.heuristic(path.pdf, self.pdf)
        return dr.select(path.pdf > 0, shared, 1)


@dataclass
class LightSample:
    """A direction in which light of a source arrives at a vertex.

    Attributes
    ----------
    direction : unit vector to the source
    pdf : density of all techniques of the source [1/sr], or a function that returns it
        for the densities of the vertex, called after `arriving`
    active : where there is something to gain
    arriving : function of a vertex and mask that returns the radiance that arrives
    column : of a matrix
    heuristic : that shares the light with continued paths; None if they never meet it
    """

    direction: mi.Vector3f
    pdf: mi.Float | Callable[[Densities], mi.Float]
    active: mi.Bool
    arriving: Callable[[Vertex, mi.Bool], mi.Color3f]
    column: mi.UInt32 | None = None
    heuristic: Heuristic | None = balance_heuristic

    def estimate(self, vertex: Vertex, active):
        """Return the light that the vertex scatters, and where there is any."""
        value, own = vertex.scatter(self.direction)
        lit = active & self.active & (dr.max(value) > 0)
        arriving = self.arriving(vertex, lit)
        lit &= dr.max(arriving) > 0
        densities = None
        if self.heuristic is not None:
            densities = vertex.densities(self.direction, own, lit)
        pdf = self.pdf(densities) if callable(self.pdf) else self.pdf
        weight = dr.rcp(pdf)
        if densities is not None and self.heuristic is not None:
            weight = self.heuristic(pdf, densities.path)
        return value * arriving * weight, lit & (pdf > 0)


class Source:
    """What paths collect; sources override what applies to them."""

    name: ClassVar[str]

    def escaped(self, path: Path, active: mi.Bool) -> Emission | None:
        """Return the light that a path meets at infinity."""
        return None

    def met(
        self, path: Path, si: mi.SurfaceInteraction3f, shape: mi.UInt32, active: mi.Bool
    ) -> tuple[Emission, mi.Bool] | None:
        """Return the light of a surface that a path meets, and where the path ends."""
        return None

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterable[LightSample]:
        """Yield directions in which light arrives at a vertex.

        Parameters
        ----------
        path : that led to the vertex; None at a sensor
        """
        return ()

    def begin(self, pdf: mi.Float, sunlit: mi.Float):
        """Return the memory of a path's first segment.

        Parameters
        ----------
        pdf : of its direction; 0 for camera rays
        sunlit : density of looking for sunlit surfaces in it; negative if none was
        """
        return

    def remember(
        self, si: mi.SurfaceInteraction3f, vertex: Vertex, after: Scattering, memory
    ):
        """Return the memory of a path after a vertex."""
        return memory
