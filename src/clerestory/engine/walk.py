"""The walk of light through a scene, from receivers to windows and sky.

Paths run against the light. At every vertex they are connected to a point of the
windows (next-event estimation) and continued by the material; both ways to reach
a window share the work by multiple importance sampling. Paths that leave the
scene reach the sky. What they carry is summed in 64-bit fixed point: exact,
independent of the order of additions, reproducible to the bit.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation,
1997, chapter 9 (balance heuristic).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine import sampler
from clerestory.engine.lower import LoweredScene
from clerestory.engine.patches import SkyTable
from clerestory.engine.sampler import Points
from clerestory.engine.sums import FIXED_POINT

# A weight is cut into two whole numbers of twenty bits and more, which processors
# convert fastest.
_HALF = FIXED_POINT**0.5

# Weights are at most a few π; anything beyond this limit would overflow.
_HEAVIEST = 2000.0

# Paths below this share of their first weight go on only by Russian roulette. For
# windows in a room, the cost (time × variance) was flat from 0.25 to 1 and a fifth
# higher below 0.1; paths to the sky are short, and roulette would only add noise.
_ROULETTE_TO_WINDOWS = 0.4
_ROULETTE_TO_SKY = 0.1

# Offset from a surface, relative to coordinates: some float32 steps of 6·10⁻⁸.
_ROUNDING = 4e-6

# Safety net for unlimited bounces: no path of a physical scene comes near it.
_MOST_SEGMENTS = 1000


# Connections of each vertex to the windows, spread over them by a lattice. Each meets
# one patch of many: three instead of one take 1.7 times less work (time × variance)
# for single coefficients, as much for sums over many patches; beyond, sums lose.
CONNECTIONS = 3


@dataclass
class Target:
    """Where paths may end, and the sums they are scored into.

    Attributes
    ----------
    model : the scene
    sky : its patches receive escaping paths; None if these are of no interest
    sums : 64-bit fixed-point sums: a first one that counts the weights too heavy to
        be summed, then one for each (row and batch, column, channel)
    columns : receiving patches, of all windows or of the sky
    channels : 3, or 1 when everything is grey
    """

    model: LoweredScene
    sky: SkyTable | None
    sums: mi.UInt64
    columns: int
    channels: int

    def score(self, slot, column, weight, active):
        """Add a weight to a column of a row and batch."""
        index = (slot * self.columns + column) * self.channels + 1
        mode = _adding()
        for channel in range(self.channels):
            scaled = weight[channel] * _HALF
            whole = mi.UInt32(mi.Int32(scaled))
            rest = mi.UInt32(mi.Int32((scaled - mi.Float(whole)) * _HALF))
            amount = (mi.UInt64(whole) << 20) + mi.UInt64(rest)
            fits = weight[channel] < _HEAVIEST
            dr.scatter_add(self.sums, amount, index + channel, active & fits, mode)
            one, first = mi.UInt64(1), mi.UInt32(0)
            dr.scatter_add(self.sums, one, first, active & ~fits, mode)


def _adding() -> dr.ReduceMode:
    # Copies of the sums for each thread of a processor gain nothing here, and are
    # kernels of their own for every number of sums
    processor = dr.backend_v(mi.UInt64) == dr.JitBackend.LLVM
    return dr.ReduceMode.Direct if processor else dr.ReduceMode.Auto


@dataclass
class Connection:
    """A straight line from a point to a point of a window.

    Attributes
    ----------
    direction : unit vector to the window
    pdf : of the direction, per solid angle [1/sr]
    column : patch through which the light would come
    valid : whether the point lies before the window's front
    point : of the window, where the line ends [m]
    """

    direction: mi.Vector3f
    pdf: mi.Float
    column: mi.UInt32
    valid: mi.Bool
    point: mi.Point3f


def connect(model: LoweredScene, origin, u, v) -> Connection:
    """Choose a point of the windows to connect `origin` with, hidden or not."""
    point, window, spherical = model.windows.aim(origin, u, v)
    across = point - origin
    distance2 = dr.squared_norm(across)
    distance = dr.sqrt(distance2)
    direction = across / distance
    cosine = -dr.dot(direction, dr.gather(mi.Vector3f, model.windows.normal, window))
    valid = (cosine > 1e-6) & (distance2 > 1e-12)
    by_area = distance2 / (dr.maximum(cosine, 1e-6) * model.windows.area)
    pdf = dr.select(spherical > 0, spherical, by_area)
    column = model.windows.find(window, -direction)
    return Connection(direction, pdf, column, valid, point)


def spread(u, v, number: int):
    """Return the sample point of one of a vertex' connections."""
    u, v = u + number / CONNECTIONS, v + number * 0.618034
    return u - dr.floor(u), v - dr.floor(v)


def towards(origin, point) -> mi.Ray3f:
    """Return a ray that ends just before a point, also from a moved start."""
    across = point - origin
    distance = dr.norm(across)
    ray = mi.Ray3f(origin, across / distance)
    ray.maxt = distance * (1 - 1e-5) - 1e-5
    return ray


def visibility(model: LoweredScene, origin, line: Connection, active: mi.Bool):
    """Return the share of light that passes along a connection, by channel."""
    return passed(model, origin, lambda start: towards(start, line.point), active)


@dr.syntax
def passed(
    model: LoweredScene, origin, aim, active: mi.Bool, illums_pass: bool = False
):
    """Return the share of light that comes straight to a point, by channel.

    Parameters
    ----------
    aim : function that returns the ray from a point to where the light comes from
    illums_pass : whether illums let the light pass like what they look like: that of
        the sun, which they do not account for
    """
    ray = aim(origin)
    seen = mi.Color3f(1)
    if dr.hint(model.panes, mode="scalar"):
        # Look through panes of glass until something opaque stands in the way
        looking = mi.Bool(active)
        while looking:
            hit = model.scene.ray_intersect_preliminary(ray, active=looking)
            blocked = looking & hit.is_valid()
            shape = dr.reinterpret_array(mi.UInt32, hit.shape)
            proxy = dr.gather(mi.Float, model.thickness_of_shape, shape, blocked) != 0
            role = dr.gather(mi.UInt32, model.emitter_of_shape, shape, blocked)
            lamp = role > 0
            if dr.hint(illums_pass, mode="scalar"):
                lamp &= ~dr.gather(mi.Bool, model.lamps.veiled, role - 1, lamp)
            flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, blocked)
            pane = mi.has_flag(flags, mi.BSDFFlags.Null) & ~lamp | proxy
            pane &= blocked
            si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, pane)
            si.sh_frame = mi.Frame3f(si.n)
            si.wi = si.to_local(-ray.d)
            through = si.bsdf().eval_null_transmission(si, pane & ~proxy)
            through = dr.select(proxy, 1, dr.select(pane, through, 0))
            seen = dr.select(blocked, seen * through, seen)
            pane &= dr.max(seen) > 0
            start = offset(model, si, ray.d, pane)
            ray = aim(dr.select(pane, start, ray.o))
            looking &= pane
    else:
        seen = dr.select(active & model.scene.ray_test(ray, active), 0, seen)
    return seen


def offset(model: LoweredScene, si, direction, active):
    """Return the hit point moved off its surface to the side a direction goes to.

    A few float32 steps of the face's coordinates and of the distance travelled:
    enough to clear the rounding of intersections, small against millimetre slats in a
    room, and more on a ground that reaches to the horizon.
    """
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    face = dr.gather(mi.UInt32, model.first_face, shape, active) + si.prim_index
    reach = dr.maximum(dr.gather(mi.Float, model.reach, face, active), si.t)
    step = _ROUNDING * dr.maximum(reach, 0.05)
    return si.p + si.n * dr.mulsign(step, dr.dot(si.n, direction))


@dr.syntax
def walk(
    target: Target,
    points: Points,
    ray: mi.Ray3f,
    weight: mi.Color3f,
    pdf: mi.Float,
    slot: mi.UInt32,
    seed: mi.UInt32,
    index: mi.UInt32,
    active: mi.Bool,
    segments: mi.UInt32,
):
    """Follow paths from their first ray until they end, scoring what they reach.

    Parameters
    ----------
    ray : first segment of each path
    weight : what the path contributes per unit radiance met at its end
    pdf : of the first direction by the start's own sampling [1/sr]; 0: windows
        met by the first segment are not shared with connections
    slot : row and batch whose sums the path adds to
    seed, index : of the row and batch, and of the path's sample points
    segments : most segments between diffuse reflections
    """
    model = target.model
    scene = model.scene
    context = mi.BSDFContext()
    to_windows = target.sky is None
    weak = _ROULETTE_TO_WINDOWS if to_windows else _ROULETTE_TO_SKY

    # ------------------------------- Loop state -------------------------------
    origin = mi.Point3f(ray.o)  # last vertex that was connected to the windows
    start = dr.maximum(dr.max(weight), 1e-20)  # weight that roulette compares with
    segment = mi.UInt32(1)  # diffuse segments so far, this one included
    vertex = mi.UInt32(1)  # vertices so far, the start included

    while active:
        hit = scene.ray_intersect_preliminary(ray, active=active)
        met = active & hit.is_valid()

        # Score the paths that leave the scene
        if dr.hint(not to_windows, mode="scalar"):
            target.score(slot, target.sky.find(ray.d), weight, active & ~met)

        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
        if dr.hint(to_windows, mode="scalar"):
            # Score the paths that meet a window, sharing with the connections
            shape = dr.reinterpret_array(mi.UInt32, si.shape)
            role = dr.gather(mi.UInt32, model.window_of_shape, shape, met)
            at_window = met & (role > 0)
            window = role - 1
            normal = dr.gather(mi.Vector3f, model.windows.normal, window, at_window)
            cosine = -dr.dot(ray.d, normal)
            front = at_window & (cosine > 1e-6)
            first = dr.gather(mi.UInt32, model.windows.first_element, window, at_window)
            element = first + (si.prim_index >> 1)
            by_area = dr.squared_norm(si.p - origin) / (
                dr.maximum(cosine, 1e-6) * model.windows.area
            )
            seen_from = model.windows.look(origin, element)
            other = model.windows.spherical_pdf(element, seen_from)
            other = dr.select(other > 0, other, by_area)
            share = dr.select(pdf > 0, pdf / (pdf + CONNECTIONS * other), 1)
            column = model.windows.find(window, -ray.d)
            target.score(slot, column, weight * share, front)
            met &= role == 0

        # Prepare the vertex: its frame and its material
        active = mi.Bool(met)
        si.sh_frame = mi.Frame3f(si.n)
        si.wi = si.to_local(-ray.d)
        bsdf = si.bsdf()
        lobe = sampler.coordinate(points, seed, index, vertex, sampler.LOBE)
        u = sampler.coordinate(points, seed, index, vertex, sampler.DIRECTION_U)
        v = sampler.coordinate(points, seed, index, vertex, sampler.DIRECTION_V)
        more = active & (segment < segments)

        if dr.hint(to_windows, mode="scalar"):
            # Connect the vertex to points of the windows
            a = sampler.coordinate(points, seed, index, vertex, sampler.CONNECT_U)
            b = sampler.coordinate(points, seed, index, vertex, sampler.CONNECT_V)
            for number in range(CONNECTIONS):
                line = connect(model, si.p, *spread(a, b, number))
                local = si.to_local(line.direction)
                value, pdf_bsdf = bsdf.eval_pdf(context, si, local, active)
                lit = more & line.valid & (dr.max(value * weight) > 0)
                near = offset(model, si, line.direction, lit)
                seen = visibility(model, near, line, lit)
                gain = weight * value * seen / (CONNECTIONS * line.pdf + pdf_bsdf)
                target.score(slot, line.column, gain, lit & (dr.max(seen) > 0))
        sample, factor = bsdf.sample(context, si, lobe, mi.Point2f(u, v), active)

        # Continue the path; panes that it passes straight leave it as it was
        diffuse = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Diffuse)
        delta = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Delta)
        null = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Null)
        weight *= factor
        direction = si.to_world(sample.wo)
        ray = mi.Ray3f(offset(model, si, direction, active), direction)
        origin = dr.select(null, origin, si.p)
        # What no connection was made for is not shared with any
        pdf = dr.select(null, pdf, dr.select(delta | ~more, 0, sample.pdf))
        segment += dr.select(diffuse, mi.UInt32(1), mi.UInt32(0))
        active &= (dr.max(weight) > 0) & (segment <= segments)

        # Let weak paths go on only by chance, then with the weight of those that end
        survive = dr.minimum(dr.max(weight) / (start * weak), 1)
        chance = sampler.random_number(seed, index + points.first, vertex + 0x10000)
        weight = dr.select(survive < 1, weight / survive, weight)
        active &= (chance < survive) & (vertex < _MOST_SEGMENTS)
        vertex += 1
