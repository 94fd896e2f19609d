"""How much it is worth to aim at each portal, from each part of a room.

The best chances to share samples among several estimates of a sum are in proportion to
the root mean square of each (the single-sample model with disjoint parts: the variance
Σ mᵢ/pᵢ is least for pᵢ ∝ √mᵢ, where mᵢ is the second moment of part i). Here the parts
are the light from each portal and that from anywhere else. Their moments are measured
at places of the room before it is traced, in cells of space and of the way a surface
faces. Few paths are enough: chances that are a little wrong cost a little noise, never
light.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
chapter 9.
"""

from dataclasses import replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine import points as sampling
from clerestory.engine.aims import LitScene
from clerestory.engine.cells import Cells
from clerestory.engine.look import NOTHING, look
from clerestory.engine.places import Places
from clerestory.engine.points import points
from clerestory.engine.portals import Portals, Rectangles
from clerestory.engine.upload import launching, vectors

# Paths go on towards portals at most this often, for each such turn weakens those that
# go on elsewhere; portals that nowhere have more than the least share are none.
_MOST, _LEAST = 0.25, 0.02

# Glances in the whole room that count as much as one glance in a cell.
_PRIOR = 8.0

# Segments that a glance follows.
_SEGMENTS = 4


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
    cells = Cells.around(places.point)
    point, normal = (
        vectors(kind, values)
        for kind, values in ((mi.Point3f, places.point), (mi.Vector3f, places.normal))
    )
    found = _glances(trial, places)
    if not found[:, :-1].any():
        return trial
    size = _sizes(found, cells.number(point, normal).numpy(), cells.count)
    most = size[:, :-1] / np.maximum(size[:, :-1].sum(axis=1, keepdims=True), 1e-30)
    kept = most.max(axis=0) > _LEAST
    portals = (windows + patches).some(kept)
    return replace(
        lit, portals=_portals(portals, size[:, np.append(kept, True)], cells)
    )


def _portals(
    rectangles: Rectangles, size: Float[np.ndarray, "cell part"], cells: Cells
) -> Portals:
    # Chances in proportion to the sizes; even where none is of any worth
    total, other = size[:, :-1].sum(axis=1), size[:, -1]
    share = np.full((cells.count, len(rectangles)), 1 / len(rectangles))
    known = total > 0
    share[known] = size[known, :-1] / total[known, None]
    aimed = np.minimum(_MOST, total / np.maximum(total + other, 1e-30))
    return Portals.of(rectangles, cells, share, aimed)


def _glances(lit: LitScene, places: Places) -> Float[np.ndarray, "place part"]:
    # What one sample towards each portal, and one anywhere else, tells of irradiance
    portals = lit.portals
    parts = portals.count + 1
    lanes = dr.arange(mi.UInt32, len(places) * parts)
    place, part = lanes // parts, lanes % parts
    seed = mi.UInt32(3)
    u, v = (sampling.random_number(seed, lanes, mi.UInt32(n)) for n in range(2))
    origin = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), place)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), place)
    one = dr.minimum(part, portals.count - 1)
    there = portals.towards(one, origin, u, v)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    aimed = part < portals.count
    direction = dr.select(aimed, there, mi.Frame3f(normal).to_world(local))
    cosine = dr.dot(direction, normal)
    density = portals.density(one, origin, direction)
    at_portal = portals.pdf(origin, mi.UInt32(0), direction, mi.Bool(True)) > 0
    elsewhere = dr.select(at_portal, 0, dr.pi)
    weight = dr.select(aimed, dr.select(density > 0, cosine / density, 0), elsewhere)
    with launching():
        light = look(
            lit, points(0, 1), mi.Ray3f(origin, direction), lanes, mi.UInt32(0),
            mi.Color3f(1), mi.Float(0), mi.Float(NOTHING), mi.Bool(False),
            dr.opaque(mi.UInt32, _SEGMENTS), (cosine > 0) & (weight > 0),
        )  # fmt: skip
        found = dr.select(cosine > 0, weight * dr.mean(light), 0).numpy()
    return found.astype(float).reshape(len(places), parts)


def _sizes(
    glances: Float[np.ndarray, "place part"],
    cell: Int[np.ndarray, " place"],
    cells: int,
) -> Float[np.ndarray, "cell part"]:
    # Root mean square of what glances in a cell found, and some of all glances
    square = glances**2
    total = np.zeros((cells, glances.shape[1]))
    np.add.at(total, cell, square)
    seen = np.bincount(cell, minlength=cells)[:, None]
    size: Float[np.ndarray, "cell part"] = np.sqrt(
        (total + _PRIOR * square.mean(axis=0)) / (seen + _PRIOR)
    )
    return size
