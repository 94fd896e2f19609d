"""Learned probabilities of sampling each portal, by cells of a room.

Irradiance is a sum of terms: irradiance from each portal, and from all other
directions. If one term is sampled, term i with probability pᵢ, the variance Σ mᵢ/pᵢ is
smallest for pᵢ ∝ √mᵢ, where mᵢ is the second moment of the samples of term i. A pilot
run measures the second moments at surface points of the room, in cells of position and
normal, for continued paths and for rays towards sunlit surfaces. Few paths are enough:
inexact probabilities increase noise but cause no bias.

Reference: E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
chapter 9.
"""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.guiding_cells import GuidingCells
from clerestory.engine.illumination import Illumination
from clerestory.engine.light_behind_layers import LayerPoints
from clerestory.engine.path_tracer import SAMPLED_AT_START
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.portals import Portals, Rectangles
from clerestory.engine.sampler import PathNumbers, points, random_numbers
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.sun_sampling import NOT_SAMPLED
from clerestory.engine.upload import launching, vectors

# Largest probability of sampling a portal instead of the BSDF; least probability of a
# portal, which must be exceeded in at least one cell.
_MOST, _LEAST = 0.25, 0.02

# Weight of the mean over the room in the estimate of a cell, as number of samples.
_PRIOR = 2.0

# Number of segments of a pilot path.
_SEGMENTS = 4


def learned_portals(
    scene: Illumination,
    windows: Rectangles,
    patches: Rectangles,
    places: SurfacePoints,
    layers: LayerPoints,
) -> Portals | None:
    """Return windows and sunlit areas as portals, with learned probabilities.

    The second moments are measured at surface points of the room. The same pilot run
    tells the choice between transmission and reflection at layers.
    """
    trial = Portals.uniform(windows + patches)
    if trial is None or len(places + layers.places) == 0:
        return trial
    samples = _pilot_samples(scene, trial, places, layers.places)
    layers.apply(scene.model, samples[0][len(places) :].sum(axis=1))
    if len(places) == 0:
        return trial
    cells = GuidingCells.around(places.point)
    point = vectors(mi.Point3f, places.point)
    normal = vectors(mi.Vector3f, places.normal)
    number = cells.number(point, normal).numpy()
    onward, sunlit = (
        root_mean_squares(found[: len(places)], number, cells.count)
        for found in samples
    )
    most = np.maximum(shares_of(onward[:, :-1]), shares_of(sunlit)).max(axis=0)
    kept = most > _LEAST
    if not kept.any():
        return trial
    total, other = onward[:, :-1].sum(axis=1), onward[:, -1]
    return Portals.of(
        (windows + patches).some(kept),
        cells,
        _even(shares_of(onward[:, :-1][:, kept])),
        shares_of(sunlit[:, kept]),
        np.minimum(_MOST, total / np.maximum(total + other, 1e-30)),
    )


def shares_of(size: Float[np.ndarray, "cell part"]) -> Float[np.ndarray, "cell part"]:
    """Return probabilities proportional to values of a cell; 0 if all values are 0."""
    shares: Float[np.ndarray, "cell part"]
    shares = size / np.maximum(size.sum(axis=1, keepdims=True), 1e-30)
    return shares


def _even(shares: Float[np.ndarray, "cell part"]) -> Float[np.ndarray, "cell part"]:
    # Replace the probabilities of a cell by equal ones if all are zero
    none = shares.sum(axis=1, keepdims=True) == 0
    return np.where(none, 1 / shares.shape[1], shares)


def _pilot_samples(
    scene: Illumination,
    portals: Portals,
    room: SurfacePoints,
    layers: SurfacePoints,
) -> tuple[Float[np.ndarray, "place part"], Float[np.ndarray, "place portal"]]:
    # Irradiance at each point from one sample towards each portal and one elsewhere: by
    # a continued path (without next-event estimation at the point), and by a ray to
    # sunlit surfaces. No rays to sunlit surfaces are sampled at layers
    parts, places = portals.count + 1, room + layers
    every = dr.opaque(mi.UInt32, portals.count)
    lanes = dr.arange(mi.UInt32, len(places) * parts)
    place, part = lanes // (every + 1), lanes % (every + 1)
    u, v, pick, x, y = random_numbers(3, lanes, 5)
    origin = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), place)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), place)
    one = dr.minimum(part, every - 1)
    there = portals.towards(one, origin, u, v)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    in_portal = part < every
    elsewhere = mi.Frame3f(normal).to_world(local)
    ray = mi.Ray3f(origin, dr.select(in_portal, there, elsewhere))
    cosine = dr.dot(ray.d, normal)
    at_portals, _ = portals.pdf(origin, mi.UInt32(0), ray.d, mi.Bool(True))
    # Divide light from overlapping portals in proportion to their densities
    all_portals = mi.Float(every) * at_portals
    shared = dr.select(at_portals > 0, cosine / all_portals, 0)
    weight = dr.select(in_portal, shared, dr.select(at_portals > 0, 0, dr.pi))
    works = (cosine > 0) & (weight > 0)
    numbers = PathNumbers(points(0, 1), lanes, mi.UInt32(0), mi.UInt32(0))
    tracer, sink = scene.tracer(portals), RadianceSink()
    in_room = place < dr.opaque(mi.UInt32, len(room))
    with launching():
        sought = dr.select(in_room, 1, mi.Float(NOT_SAMPLED))
        path = tracer.path(ray, 1, SAMPLED_AT_START, sunlit=sought)
        onward = tracer.trace(sink, path, numbers, _SEGMENTS, works)
        sunlit = mi.Color3f(0)
        if scene.distant.suns:
            suns = scene.suns(portals)
            sun = scene.distant.sample_sun(pick, x, y)
            sunlit = suns.on_surface(sun, ray, works & in_portal)
        found = [
            dr.select(works, weight * dr.sum(light) / 3, 0).numpy().astype(float)
            for light in (onward, sunlit)
        ]
    both = [light.reshape(len(places), parts) for light in found]
    return both[0], both[1][:, :-1]


def root_mean_squares(
    samples: Float[np.ndarray, "place part"],
    cell: Int[np.ndarray, " place"],
    cells: int,
) -> Float[np.ndarray, "cell part"]:
    """Return the root mean square of each term in a cell.

    The prior is the mean over the room. Squares are normalised by their sum in each
    cell, so that sunlit cells have no larger weight.
    """
    square = samples**2
    total = np.zeros((cells, samples.shape[1]))
    np.add.at(total, cell, square)
    seen = np.bincount(cell, minlength=cells)[:, None]
    part = total / np.maximum(total.sum(axis=1, keepdims=True), 1e-30)
    whole = (seen * part).sum(axis=0) / seen.sum()
    size: Float[np.ndarray, "cell part"]
    size = np.sqrt((seen * part + _PRIOR * whole) / (seen + _PRIOR))
    return size
