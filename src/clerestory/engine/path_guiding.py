"""How much it is worth to aim at each portal, from each part of a room.

The best chances to share samples among several estimates of a sum are in proportion to
the root mean square of each (the single-sample model with disjoint parts: the variance
Σ mᵢ/pᵢ is least for pᵢ ∝ √mᵢ, where mᵢ is the second moment of part i). Here the parts
are the light from each portal and that from anywhere else. Their moments are measured
at places of the room before it is traced, in cells of space and of the way a surface
faces: for paths that go on there, and for rays that seek what a sun lights. Few paths
are enough: chances that are a little wrong cost a little noise, never light.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
chapter 9.
"""

from dataclasses import replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine import sampler
from clerestory.engine.guiding_cells import GuidingCells
from clerestory.engine.next_event_estimation import LitScene, SunAim, sunlit
from clerestory.engine.path_tracer import look
from clerestory.engine.pilot_paths import Places
from clerestory.engine.portals import Portals, Rectangles
from clerestory.engine.sampler import points
from clerestory.engine.upload import launching, vectors

# Paths go on towards portals at most this often, for each such turn weakens those that
# go on elsewhere; portals that nowhere have more than the least share are none.
_MOST, _LEAST = 0.25, 0.02

# Glances in the whole room that count as much as one glance in a cell.
_PRIOR = 8.0

# Segments that a glance follows, and the pdf of its first: so small that all that was
# aimed at from its origin is left to the aim.
_SEGMENTS = 4
_LEFT = 1e-20


def guided(
    lit: LitScene, windows: Rectangles, patches: Rectangles, places: Places
) -> LitScene:
    """Return the scene with windows and patches as portals, aimed at by their worth.

    Parameters
    ----------
    places : of the room, from which light is gathered
    """
    trial = replace(lit, portals=Portals.unknown(windows + patches))
    if trial.portals.count == 0 or len(places) == 0:
        return trial
    cells = GuidingCells.around(places.point)
    point, normal = (
        vectors(kind, values)
        for kind, values in ((mi.Point3f, places.point), (mi.Vector3f, places.normal))
    )
    number = cells.number(point, normal).numpy()
    onward, sought = (
        _sizes(found, number, cells.count) for found in _glances(trial, places)
    )
    most = np.maximum(_shares(onward[:, :-1]), _shares(sought)).max(axis=0)
    kept = most > _LEAST
    if not kept.any():
        return trial
    total, other = onward[:, :-1].sum(axis=1), onward[:, -1]
    portals = Portals.of(
        (windows + patches).some(kept),
        cells,
        _even(_shares(onward[:, :-1][:, kept])),
        _shares(sought[:, kept]),
        np.minimum(_MOST, total / np.maximum(total + other, 1e-30)),
    )
    return replace(lit, portals=portals)


def _shares(size: Float[np.ndarray, "cell part"]) -> Float[np.ndarray, "cell part"]:
    # Chances in proportion to the sizes, 0 where none is of any worth
    shares: Float[np.ndarray, "cell part"]
    shares = size / np.maximum(size.sum(axis=1, keepdims=True), 1e-30)
    return shares


def _even(shares: Float[np.ndarray, "cell part"]) -> Float[np.ndarray, "cell part"]:
    # Even chances where none is of any worth
    none = shares.sum(axis=1, keepdims=True) == 0
    return np.where(none, 1 / shares.shape[1], shares)


def _glances(
    lit: LitScene, places: Places
) -> tuple[Float[np.ndarray, "place part"], Float[np.ndarray, "place portal"]]:
    # What one sample towards each portal, and one anywhere else, tells of irradiance:
    # from a path that goes on there, without what is aimed at from the place itself;
    # and from asking what a sun lights there
    portals = lit.portals
    parts = portals.count + 1
    every = dr.opaque(mi.UInt32, portals.count)
    lanes = dr.arange(mi.UInt32, len(places) * parts)
    place, part = lanes // (every + 1), lanes % (every + 1)
    seed = mi.UInt32(3)
    u, v, pick, x, y = (
        sampler.random_number(seed, lanes, mi.UInt32(n)) for n in range(5)
    )
    origin = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), place)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), place)
    one = dr.minimum(part, every - 1)
    there = portals.towards(one, origin, u, v)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    aimed = part < every
    ray = mi.Ray3f(origin, dr.select(aimed, there, mi.Frame3f(normal).to_world(local)))
    cosine = dr.dot(ray.d, normal)
    at_portals, _ = portals.pdf(origin, mi.UInt32(0), ray.d, mi.Bool(True))
    # Where portals overlap, each has its share in proportion to its density
    all_portals = mi.Float(every) * at_portals
    shared = dr.select(at_portals > 0, cosine / all_portals, 0)
    weight = dr.select(aimed, shared, dr.select(at_portals > 0, 0, dr.pi))
    works = (cosine > 0) & (weight > 0)
    with launching():
        onward = look(
            lit, points(0, 1), ray, lanes, mi.UInt32(0), mi.Color3f(1),
            mi.Float(_LEFT), mi.Float(1), mi.Bool(False),
            dr.opaque(mi.UInt32, _SEGMENTS), works, parted=False,
        )  # fmt: skip
        sought = mi.Color3f(0)
        if lit.sky.suns:
            sought = sunlit(lit, SunAim(*lit.sky.aim(pick, x, y)), ray, works & aimed)
        found = [
            dr.select(works, weight * dr.sum(light) / 3, 0).numpy().astype(float)
            for light in (onward, sought)
        ]
    both = [light.reshape(len(places), parts) for light in found]
    return both[0], both[1][:, :-1]


def _sizes(
    glances: Float[np.ndarray, "place part"],
    cell: Int[np.ndarray, " place"],
    cells: int,
) -> Float[np.ndarray, "cell part"]:
    # Root mean square of what glances in a cell found, over that of all parts, and some
    # of all glances: those out in the sun count no more than those in the shade
    square = glances**2
    total = np.zeros((cells, glances.shape[1]))
    np.add.at(total, cell, square)
    seen = np.bincount(cell, minlength=cells)[:, None]
    part = total / np.maximum(total.sum(axis=1, keepdims=True), 1e-30)
    whole = (seen * part).sum(axis=0) / seen.sum()
    size: Float[np.ndarray, "cell part"]
    size = np.sqrt((seen * part + _PRIOR * whole) / (seen + _PRIOR))
    return size
