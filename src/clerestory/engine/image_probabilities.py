"""Learned probabilities of sampling each mirror image of a light source.

Of the images that may be seen from a cell of the room (`image_cells`), half of the
samples choose each with a probability proportional to its reflectance, even if it is
rarely seen, so that standard errors include it. The other half follow learned
probabilities: the second moment of the light by way of each image is measured at
surface points of the room; the variance is smallest for probabilities proportional to
its square root, as in `path_guiding`. Where mirrored light is much weaker than direct
light, or absent, fewer vertices of a path sample it. Inexact probabilities increase
noise but cause no bias.
"""

from dataclasses import replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float

from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.emitter_sampling import SurfaceEmitters
from clerestory.engine.emitters import Emitters
from clerestory.engine.illumination import Illumination
from clerestory.engine.image_cells import Sources
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.path_guiding import root_mean_squares, shares_of
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.sampler import PathNumbers, points
from clerestory.engine.sun_sampling import Suns
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.vertices import sensor_vertex

# Largest number of pairs of a surface point and an image, and of surface points.
_PAIRS, _PLACES = 1 << 19, 1 << 12

# Fraction of the samples that choose images by reflectance.
_PRIOR = 0.5

# Fraction of surface points outside the cells at either end of an axis.
_OUTLYING = 0.004

# Largest half angle of a group of suns [rad].
_WIDE = 1.5

# Sampling rate divided by the ratio of mirrored to direct light (root mean squares),
# and smallest rate.
_RATE, _LEAST_RATE = 2.0, 0.125


def with_learned_images(
    scene: Illumination, places: SurfacePoints, sensors: SurfacePoints | None
) -> Illumination:
    """Return the scene with image probabilities learned at surface points and sensors.

    Between an eighth and half of the points are sensors. If there are few sensors, each
    is tested repeatedly, since one sample may miss an image that is partly hidden.
    """
    # Cells contain all sensors and nearly all surface points
    inside = places.start
    if len(inside):
        inside = np.quantile(inside, [_OUTLYING, 1 - _OUTLYING], axis=0)
    if sensors is not None and len(sensors):
        inside = np.concatenate([inside, sensors.start])
        tests = min(max(len(sensors), _PLACES // 8), _PLACES // 2)
        places = sensors.repeated(tests) + places.thinned(_PLACES - tests)
    if len(places) == 0:
        return scene
    suns = scene.images_of_suns
    if suns.count and scene.distant.suns:
        suns = _learned(suns, scene.suns(None), _suns(scene.distant), places, inside)
    lamps = scene.images_of_emitters
    emitters = scene.model.emitters
    if lamps.count and emitters.count:
        source = SurfaceEmitters(scene.model, lamps)
        lamps = _learned(lamps, source, _emitters(emitters), places, inside)
    return replace(scene, images_of_suns=suns, images_of_emitters=lamps)


def _suns(distant: DistantEmitters) -> Sources:
    direction = np.array(distant.direction).T.astype(float)
    half = np.arccos(1 - np.array(distant.one_minus_cos).astype(float))
    found = Sources.of(direction, 2 * np.sin(half / 2))
    angle = np.minimum(2 * np.arcsin(np.minimum(found.radius / 2, 1)), _WIDE)
    length = np.linalg.norm(found.centre, axis=1, keepdims=True)
    return Sources(found.centre / length, np.tan(angle))


def _emitters(emitters: Emitters) -> Sources:
    triangles = emitters.triangles
    corner, u, v = (
        np.array(part).T.astype(float)
        for part in (triangles.corner, triangles.edge_u, triangles.edge_v)
    )
    middle = corner + (u + v) / 3
    away = [corner - middle, corner + u - middle, corner + v - middle]
    return Sources.of(middle, np.linalg.norm(away, axis=2).max(axis=0))


def _learned(
    images: MirrorImages,
    source: Suns | SurfaceEmitters,
    sources: Sources,
    places: SurfacePoints,
    inside: Float[np.ndarray, "n 3"],
) -> MirrorImages:
    places = places.thinned(min(_PLACES, max(1, _PAIRS // images.other)))
    cells = images.reach.cells(inside, sources)
    seen = images.reach.seen(cells, sources)
    cell = cells.number(vectors(mi.Point3f, places.start)).numpy()
    light = _samples(images, source, places, seen[cell] > 0)
    direct, *mirrored = np.sqrt(np.mean(np.square(light), axis=0))
    total = float(np.sum(mirrored))
    light[:, 0] = 0
    learned = (seen > 0) * root_mean_squares(light, cell, len(seen))
    weight = _PRIOR * shares_of(seen) + (1 - _PRIOR) * shares_of(learned)
    rate = 1.0 if total else _LEAST_RATE
    if direct:
        rate = min(1.0, max(_LEAST_RATE, _RATE * total / direct))
    return images.sampled_by(cells, weight, rate)


def _samples(
    images: MirrorImages,
    source: Suns | SurfaceEmitters,
    places: SurfacePoints,
    seen: Bool[np.ndarray, "place state"],
) -> Float[np.ndarray, "place state"]:
    # Light at the points by way of each image that may be seen; state 0 is direct light
    wanted = seen.copy()
    wanted[:, 0] = True
    of_row, of_state = np.nonzero(wanted)
    row, state = on_device(mi.UInt32, of_row), on_device(mi.UInt32, of_state)
    point = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), row)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), row)
    numbers = PathNumbers(points(0, len(places)), mi.UInt32(3), row, mi.UInt32(0))
    vertex = sensor_vertex(None, point, normal)
    found = np.zeros(wanted.shape)
    with launching():
        mirrored, lit = source.by_image(vertex, numbers, state).estimate(
            vertex, state > 0
        )
        straight, shone = source.direct(vertex, numbers).estimate(vertex, state == 0)
        light = dr.select(lit, dr.max(mirrored), 0)
        light += dr.select(shone, dr.max(straight), 0)
        found[wanted] = light.numpy()
    return found
