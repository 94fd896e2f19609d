"""Light aimed at from a vertex of a path: suns, lamps, and what suns light.

At every vertex one of the suns and one of the lamps are aimed at directly; suns also
by way of plane mirrors, and along the lobes in which windows scatter them. A path
that goes on by itself shares what it meets with these aims by multiple importance
sampling.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation,
1997, chapter 9 (balance heuristic).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.engine import points as sampling
from clerestory.engine.lower import LoweredScene
from clerestory.engine.mirrors import Mirrors, reflected
from clerestory.engine.points import Points
from clerestory.engine.portals import Portals
from clerestory.engine.sky_light import SkyLight
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.walk import offset, passed, towards

# Largest share of directions that are aimed at portals.
_AIMED = 0.35


@dataclass
class LitScene:
    """A scene with all that lights it."""

    model: LoweredScene
    sky: SkyLight
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
        return sampling.coordinate(
            self.points, self.seed, self.index, self.vertex, purpose
        )

    def other(self, purpose: int):
        """Return a hashed number beside the sequence."""
        dimension = self.vertex * 8 + (0x20000 + purpose)
        return sampling.random_number(
            self.seed, self.index + self.points.first, dimension
        )


@dataclass
class Vertex:
    """A place where light is gathered, and how it scatters.

    Attributes
    ----------
    point : [m]
    normal : on the side that light is gathered from
    leave : function that returns the point moved off its surface towards a direction
    scatter : function that returns BSDF × cosine for light straight from a lamp, and
        the pdf of the material's own sampling, for a direction
    aimed : chance of aiming at portals
    worth : of all portals from here
    """

    point: mi.Point3f
    normal: mi.Vector3f
    leave: object
    scatter: object
    aimed: mi.Float
    worth: mi.Float

    def mixture(self, lit: LitScene, direction, own, active):
        """Return the pdf with which the path goes on along a direction."""
        aimed = active & (self.aimed > 0)
        there = lit.portals.pdf(self.point, self.normal, direction, self.worth, aimed)
        return self.aimed * there + (1 - self.aimed) * own


def aims(lit: LitScene, point, normal, smooth):
    """Return the chance of aiming at portals, and what they are worth."""
    if lit.portals.count == 0:
        return mi.Float(0), mi.Float(1)
    worth = lit.portals.total(point, normal)
    share = dr.minimum(worth / (worth + dr.pi), _AIMED)
    return dr.select(smooth, share, 0), worth


def at_surface(model: LoweredScene, si, context, depth, active, portals) -> Vertex:
    """Return the vertex at a hit.

    Parameters
    ----------
    context : which parts of the material scatter light that is aimed at
    depth : of the geometry that the surface stands for; light leaves on its far side
    portals : chance of aiming at portals, and their worth
    """
    bsdf, behind = si.bsdf(), si.n * depth

    def leave(direction, lit):
        through = dr.dot(direction, si.n) * si.wi.z < 0
        moved = offset(model, si, direction, lit)
        return dr.select(through, moved - behind, moved)

    def scatter(direction):
        return bsdf.eval_pdf(context, si, si.to_local(direction), active)

    normal = dr.mulsign(si.n, si.wi.z)
    return Vertex(si.p, normal, leave, scatter, *portals)


@dataclass
class SunAim:
    """A direction to a sun, its density, and the radiance there."""

    direction: mi.Vector3f
    pdf: mi.Float
    radiance: mi.Color3f

    @classmethod
    def of(cls, lit: LitScene, draw: Draw) -> "SunAim":
        """Return an aim at one of the suns."""
        u, v = draw.number(sampling.CONNECT_U), draw.number(sampling.CONNECT_V)
        pick = draw.other(0) if lit.sky.suns > 1 else mi.Float(0)
        return cls(*lit.sky.aim(pick, u, v))


def sunlight(lit: LitScene, vertex: Vertex, sun: SunAim, active):
    """Return the light of a sun that a vertex scatters, aimed at directly."""
    direction, pdf, radiance = sun.direction, sun.pdf, sun.radiance
    value, own = vertex.scatter(direction)
    lit_up = active & (dr.max(value) > 0)
    mixed = vertex.mixture(lit, direction, own, lit_up)
    start = vertex.leave(direction, lit_up)
    seen = passed(lit.model, start, lambda o: mi.Ray3f(o, direction), lit_up, True)
    return dr.select(lit_up, value * radiance * seen / (pdf + mixed), 0)


def sunlight_by_lobes(lit: LitScene, vertex: Vertex, sun: SunAim, draw: Draw, active):
    """Return the light of a sun that a window scatters to a vertex along a lobe.

    Paths that go on to that window by chance share it: see `share_of_lobes`.
    """
    u, v, pick = draw.other(8), draw.other(9), mi.Float(0)
    if len(lit.lobes.groups) > 1:
        pick = draw.other(10)
    direction = lit.lobes.draw(pick, sun.direction, u, v)
    value, own = vertex.scatter(direction)
    lit_up = active & (dr.max(value) > 0)
    pdf = lit.lobes.pdf(direction, sun.direction)
    pdf += vertex.mixture(lit, direction, own, lit_up)
    ray = mi.Ray3f(vertex.leave(direction, lit_up), direction)
    hit = lit.model.scene.ray_intersect_preliminary(ray, active=lit_up)
    si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, lit_up)
    lit_up &= hit.is_valid()
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    lit_up &= dr.gather(mi.Bool, lit.model.layer_of_shape, shape, lit_up)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = si.to_local(-direction)
    straight = materials.lamp_context()
    window = at_surface(lit.model, si, straight, 0, lit_up, (mi.Float(0), mi.Float(1)))
    light = sunlight(lit, window, sun, lit_up)
    return dr.select(lit_up & (pdf > 0), value * light / pdf, 0)


def share_of_lobes(lit: LitScene, sun: SunAim, direction, pdf, shared):
    """Return the share of a sun's light that a path keeps which met a window by chance.

    Parameters
    ----------
    direction : in which the path came to the window, with the density `pdf`
    shared : whether the window is one that the vertex before looked for along lobes
    """
    density = lit.lobes.pdf(direction, sun.direction)
    return dr.select(shared, pdf / (pdf + density), 1)


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
    mixed = vertex.mixture(lit, direction, own, lit_up)
    start = vertex.leave(direction, lit_up)
    seen = passed(lit.model, start, lambda o: towards(o, point), lit_up)
    return dr.select(lit_up, value * radiance * seen / (pdf + mixed), 0)
