"""Light aimed at from a vertex of a path: suns, lamps, and what suns light.

At every vertex one of the suns and one of the lamps are aimed at directly; suns also
by way of plane mirrors, and along the lobes in which windows scatter them. A path
that goes on by itself shares what it meets with these aims by multiple importance
sampling.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation,
1997, chapter 9 (balance heuristic; for suns, power heuristic).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials, sampler
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import LoweredScene
from clerestory.engine.mirrors import Mirrors, reflected
from clerestory.engine.portals import Portals
from clerestory.engine.sampler import Points
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.walk import offset, passed, towards

# Surfaces without a diffuse part aim at portals so much less often.
_GLOSSY = 0.4

# Of the rays that seek what the sun lights, those along lobes of windows.
_LOBES = 0.5


@dataclass
class LitScene:
    """A scene with all that lights it."""

    model: LoweredScene
    sky: DistantEmitters
    portals: Portals
    mirrors: Mirrors
    lobes: SunLobes


@dataclass
class Draw:
    """Sample numbers of a path at one of its vertices."""

    points: Points
    seed: mi.UInt32
    index: mi.UInt32
    vertex: mi.UInt32

    def number(self, purpose: int):
        """Return a number of the sequence."""
        return sampler.coordinate(
            self.points, self.seed, self.index, self.vertex, purpose
        )

    def other(self, purpose: int):
        """Return a hashed number beside the sequence."""
        dimension = self.vertex * 8 + (0x20000 + purpose)
        return sampler.random_number(
            self.seed, self.index + self.points.first, dimension
        )


@dataclass
class Vertex:
    """A place where light is gathered, and how it scatters.

    Attributes
    ----------
    point : [m]
    leave : function that returns the point moved off its surface towards a direction
    scatter : function that returns BSDF × cosine for light straight from a lamp, and
        the pdf of the material's own sampling, for a direction
    aim : at portals
    """

    point: mi.Point3f
    leave: object
    scatter: object
    aim: "PortalAim"

    def portal_pdf(self, lit: LitScene, direction, active):
        """Return densities of aiming at any portal [1/sr], where that is done.

        Returns
        -------
        onward, sought : of paths that go on, and of seeking what suns light
        """
        active = active & self.aim.aims
        return lit.portals.pdf(self.point, self.aim.cell, direction, active)

    def mixture(self, onward, own):
        """Return the pdf with which the path goes on along a direction.

        Parameters
        ----------
        onward, own : density of aiming at portals, and of the material's sampling
        """
        return self.aim.chance * onward + (1 - self.aim.chance) * own


@dataclass
class PortalAim:
    """How a vertex aims at portals.

    Attributes
    ----------
    aims : whether it does
    cell : of the room that it lies in
    chance : that the path goes on towards any portal
    """

    aims: mi.Bool
    cell: mi.UInt32
    chance: mi.Float

    @classmethod
    def of(cls, lit: LitScene, point, normal, share) -> "PortalAim":
        """Return the aim of a surface that takes a share of the cell's chance."""
        if lit.portals.count == 0:
            return cls.none()
        cell = lit.portals.cells.number(point, normal)
        chance = dr.gather(mi.Float, lit.portals.aimed, cell, share > 0)
        return cls(share > 0, cell, share * chance)

    @classmethod
    def none(cls) -> "PortalAim":
        """Return no aim."""
        return cls(mi.Bool(False), mi.UInt32(0), mi.Float(0))


def share_of_portals(flags, smooth):
    """Return the share of chances that a surface takes, for what its material does."""
    diffuse = mi.has_flag(flags, mi.BSDFFlags.Diffuse)
    return dr.select(smooth, dr.select(diffuse, mi.Float(1), _GLOSSY), 0)


def at_surface(
    model: LoweredScene, si, context, depth, active, aim: PortalAim
) -> Vertex:
    """Return the vertex at a hit.

    Parameters
    ----------
    context : which parts of the material scatter light that is aimed at
    depth : of the geometry that the surface stands for; light leaves on its far side
    aim : at portals
    """
    bsdf, behind = si.bsdf(), si.n * depth

    def leave(direction, lit):
        through = dr.dot(direction, si.n) * si.wi.z < 0
        moved = offset(model, si, direction, lit)
        return dr.select(through, moved - behind, moved)

    def scatter(direction):
        return bsdf.eval_pdf(context, si, si.to_local(direction), active)

    return Vertex(si.p, leave, scatter, aim)


@dataclass
class SunAim:
    """A direction to a sun, its density, and the radiance there."""

    direction: mi.Vector3f
    pdf: mi.Float
    radiance: mi.Color3f

    @classmethod
    def of(cls, lit: LitScene, draw: Draw) -> "SunAim":
        """Return an aim at one of the suns."""
        u, v = draw.number(sampler.CONNECT_U), draw.number(sampler.CONNECT_V)
        pick = draw.other(0) if lit.sky.suns > 1 else mi.Float(0)
        return cls(*lit.sky.aim(pick, u, v))


def sunlight(lit: LitScene, vertex: Vertex, sun: SunAim, active):
    """Return the light of a sun that a vertex scatters, aimed at directly."""
    direction, pdf, radiance = sun.direction, sun.pdf, sun.radiance
    value, own = vertex.scatter(direction)
    lit_up = active & (dr.max(value) > 0)
    start = vertex.leave(direction, lit_up)
    seen = passed(lit.model, start, lambda o: mi.Ray3f(o, direction), lit_up, True)
    lit_up &= dr.max(seen) > 0
    onward, _ = vertex.portal_pdf(lit, direction, lit_up)
    share = share_of_sun(pdf, vertex.mixture(onward, own))
    return dr.select(lit_up, value * radiance * seen * share / pdf, 0)


def share_of_sun(own, other):
    """Return what one of two ways to a sun counts: the power heuristic.

    A layer that passes light straight on sends a path into the small disc of a sun now
    and then. By densities alone, it would bring a twentieth of the sun's light so, in
    a pixel of some hundreds; by their squares, next to nothing.

    Parameters
    ----------
    own, other : densities of both ways [1/sr]
    """
    return dr.rcp(1 + dr.square(other / own))


def seeks(lit: LitScene) -> bool:
    """Whether there is anything to seek that suns may light."""
    return bool(lit.sky.suns and (lit.portals.sunny or lit.lobes.groups))


def sought_sunlight(lit: LitScene, vertex: Vertex, sun: SunAim, draw: Draw, active):
    """Return the light of a sun that a vertex gets from what is likely lit by it.

    One ray looks back along a lobe in which a window scatters the sun, or towards a
    portal. What scatters the sun there is shared with paths that come to it by chance:
    see `sought_pdf`.
    """
    u, v, pick = draw.other(8), draw.other(9), draw.other(10)
    direction = mi.Vector3f(0, 0, 1)
    portals = lit.portals
    if portals.sunny:
        direction = portals.aim(portals.sought, vertex.point, vertex.aim.cell, u, v)
    if lit.lobes.groups:
        along = lit.lobes.draw(dr.minimum(pick / _LOBES, 1), sun.direction, u, v)
        chosen = pick < _LOBES if portals.sunny else mi.Bool(True)
        direction = dr.select(chosen, along, direction)
    value, own = vertex.scatter(direction)
    lit_up = active & (dr.max(value) > 0)
    ray = mi.Ray3f(vertex.leave(direction, lit_up), direction)
    light = sunlit(lit, sun, ray, lit_up)
    lit_up &= dr.max(light) > 0
    onward, sought = vertex.portal_pdf(lit, direction, lit_up)
    pdf = vertex.mixture(onward, own) + sought_pdf(lit, sun, direction, sought)
    return dr.select(lit_up & (pdf > 0), value * light / pdf, 0)


def sunlit(lit: LitScene, sun: SunAim, ray: mi.Ray3f, active):
    """Return the light of a sun that comes back along a ray from what it meets.

    None comes from what is not sought: see `is_sought`.
    """
    hit = lit.model.scene.ray_intersect_preliminary(ray, active=active)
    active = active & hit.is_valid()
    si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
    active &= is_sought(lit.model, dr.reinterpret_array(mi.UInt32, si.shape), active)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = si.to_local(-ray.d)
    straight = materials.lamp_context()
    place = at_surface(lit.model, si, straight, 0, active, PortalAim.none())
    return dr.select(active, sunlight(lit, place, sun, active), 0)


def sought_pdf(lit: LitScene, sun: SunAim, direction, at_portals):
    """Return the density with which a vertex seeks sunlit places along a direction.

    Parameters
    ----------
    at_portals : density of seeking them at portals
    """
    if not lit.lobes.groups:
        return at_portals
    along = lit.lobes.pdf(direction, sun.direction)
    return _LOBES * along + (1 - _LOBES) * at_portals if lit.portals.sunny else along


def is_sought(model: LoweredScene, shape, active):
    """Whether a shape is something that is sought where the sun lights it."""
    flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, active)
    depth = dr.gather(mi.Float, model.thickness_of_shape, shape, active)
    matt = mi.has_flag(flags, mi.BSDFFlags.Smooth)
    matt &= ~mi.has_flag(flags, mi.BSDFFlags.Null)
    matt &= ~mi.has_flag(flags, mi.BSDFFlags.Transmission)
    layer = dr.gather(mi.Bool, model.layer_of_shape, shape, active)
    lamp = dr.gather(mi.UInt32, model.emitter_of_shape, shape, active)
    return active & (depth == 0) & (lamp == 0) & (matt | layer)


def mirrored_sunlight(lit: LitScene, vertex: Vertex, draw: Draw, active):
    """Return the light of the suns by way of plane mirrors that a vertex scatters."""
    if lit.mirrors.count == 0:
        return mi.Color3f(0)
    sun, pdf, radiance = lit.sky.aim(draw.other(4), draw.other(5), draw.other(6))
    normal, chance = lit.mirrors.choose(draw.other(7))
    cosine = dr.dot(sun, normal)
    direction = sun - 2 * cosine * normal
    value, _ = vertex.scatter(direction)
    lit_up = active & (cosine > 0) & (dr.max(value) > 0)
    start = vertex.leave(direction, lit_up)
    share, point = reflected(lit.model, start, direction, normal, lit_up)
    lit_up &= dr.max(share) > 0
    seen = passed(lit.model, point, lambda o: mi.Ray3f(o, sun), lit_up, True)
    return dr.select(lit_up, value * radiance * share * seen / (pdf * chance), 0)


def lamplight(lit: LitScene, vertex: Vertex, draw: Draw, active):
    """Return the light of the lamps that a vertex scatters, aimed at directly."""
    lamps = lit.model.lamps
    if lamps.count == 0:
        return mi.Color3f(0)
    aim = lamps.aim(vertex.point, draw.other(1), draw.other(2), draw.other(3))
    point, direction, cosine, pdf, lamp = aim
    value, own = vertex.scatter(direction)
    lit_up = active & (dr.max(value) > 0) & (cosine > 1e-6)
    radiance = lamps.emitted(lamp, -direction, lit_up)
    lit_up &= dr.max(radiance) > 0
    start = vertex.leave(direction, lit_up)
    seen = passed(lit.model, start, lambda o: towards(o, point), lit_up)
    lit_up &= dr.max(seen) > 0
    onward, _ = vertex.portal_pdf(lit, direction, lit_up)
    mixed = vertex.mixture(onward, own)
    return dr.select(lit_up, value * radiance * seen / (pdf + mixed), 0)
