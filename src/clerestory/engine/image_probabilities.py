"""Learned probabilities of sampling each mirror image of a light source.

The second moment of the light by way of each image is measured at surface points of the
room; the variance is smallest for probabilities proportional to its square root, as in
`path_guiding`. Where mirrored light is much weaker than direct light, or absent, fewer
vertices of a path sample it. Inexact probabilities increase noise but cause no bias.
"""

from dataclasses import replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.emitter_sampling import SurfaceEmitters
from clerestory.engine.illumination import Illumination
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.sampler import PathNumbers, points
from clerestory.engine.sun_sampling import Suns
from clerestory.engine.upload import launching, vectors
from clerestory.engine.vertices import sensor_vertex

# Largest number of pairs of a surface point and an image, and of surface points.
_PAIRS, _PLACES = 1 << 19, 1 << 12

# Weight of probabilities by area and reflectance, which are added to the learned ones.
_PRIOR = 0.1

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
    if sensors is not None and len(sensors):
        tests = min(max(len(sensors), _PLACES // 8), _PLACES // 2)
        places = sensors.repeated(tests) + places.thinned(_PLACES - tests)
    if len(places) == 0:
        return scene
    suns = scene.images_of_suns
    if suns.count and scene.distant.suns:
        suns = _learned(suns, scene.suns(None), places)
    lamps = scene.images_of_emitters
    if lamps.count and scene.model.emitters.count:
        lamps = _learned(lamps, SurfaceEmitters(scene.model, lamps), places)
    return replace(scene, images_of_suns=suns, images_of_emitters=lamps)


def _learned(
    images: MirrorImages, source: Suns | SurfaceEmitters, places: SurfacePoints
) -> MirrorImages:
    places = places.thinned(min(_PLACES, max(1, _PAIRS // images.other)))
    mirrored = _root_mean_squares(images, source, places)
    direct, total = mirrored[0], float(mirrored[1:].sum())
    mirrored[0] = 0
    prior = images.weight / images.weight.sum()
    weight = _PRIOR * prior + (1 - _PRIOR) * (mirrored / total if total else prior)
    rate = 1.0 if total else _LEAST_RATE
    if direct:
        rate = min(1.0, max(_LEAST_RATE, _RATE * total / direct))
    return images.sampled_by(weight, rate)


def _root_mean_squares(
    images: MirrorImages,
    source: Suns | SurfaceEmitters,
    places: SurfacePoints,
) -> Float[np.ndarray, " state"]:
    # Light at the points by way of each image; state 0 is direct light
    count = len(places)
    lane = dr.arange(mi.UInt32, count * images.other)
    state, row = lane // dr.opaque(mi.UInt32, count), lane % dr.opaque(mi.UInt32, count)
    point = dr.gather(mi.Point3f, vectors(mi.Point3f, places.start), row)
    normal = dr.gather(mi.Vector3f, vectors(mi.Vector3f, places.normal), row)
    numbers = PathNumbers(points(0, count), mi.UInt32(3), row, mi.UInt32(0))
    vertex = sensor_vertex(None, point, normal)
    with launching():
        mirrored, lit = source.by_image(vertex, numbers, state).estimate(
            vertex, state > 0
        )
        straight, seen = source.direct(vertex, numbers).estimate(vertex, state == 0)
        light = dr.select(lit, dr.max(mirrored), 0)
        light += dr.select(seen, dr.max(straight), 0)
        dr.eval(light)
        found = light.numpy().reshape(images.other, count)
    return np.asarray(np.sqrt(np.mean(np.square(found.astype(float)), axis=1)))
