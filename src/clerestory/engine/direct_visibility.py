"""Direct transmittance from distant sources, and first surfaces, through glass."""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.lower import lower
from clerestory.engine.unscattered_jobs import UnscatteredJob
from clerestory.engine.unusual_lengths import scene_factor
from clerestory.engine.upload import launching, vectors
from clerestory.engine.visibility import (
    along,
    first_opaque,
    interaction,
    transmittance,
)
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled


def direct_transmittance(
    scene: Scene,
    points: Float[np.ndarray, "point 3"],
    directions: Float[np.ndarray, "sun 3"],
) -> Float[np.ndarray, "point sun"]:
    """Return the direct (unscattered) transmittance from distant sources to points."""
    factor = scene_factor(scene)
    scene, points = scaled(scene, factor), points * factor
    origin = points.mean(axis=0)
    count = len(directions)
    with launching():
        model = lower(scene, origin=origin)
        start = vectors(mi.Point3f, np.repeat(points - origin, count, axis=0))
        towards = vectors(mi.Vector3f, np.tile(directions, (len(points), 1)))
        share = transmittance(model, start, along(towards), mi.Bool(True))
        found = np.asarray(dr.mean(share))
    return np.broadcast_to(found, len(points) * count).reshape(-1, count).astype(float)


def first_surfaces(
    scene: Scene,
    origins: Float[np.ndarray, "ray 3"],
    directions: Float[np.ndarray, "ray 3"],
) -> tuple[Float[np.ndarray, " ray"], Float[np.ndarray, "ray 3"]]:
    """Return distance, inf if none, and normal of the first surface of each ray."""
    factor = scene_factor(scene)
    scene, origins = scaled(scene, factor), origins * factor
    origin = origins.mean(axis=0)
    with launching():
        model = lower(scene, origin=origin)
        start = vectors(mi.Point3f, origins - origin)
        towards = vectors(mi.Vector3f, directions)
        _, ray, hit = first_opaque(model, start, along(towards), mi.Bool(True))
        met = hit.is_valid()
        surface = interaction(hit, ray, met)
        reach = dr.select(met, dr.norm(surface.p - start), dr.inf)
        distance, normal = np.asarray(reach), np.asarray(surface.n).T
    return distance.astype(float) / factor, normal.astype(float)


def prepare_unscattered(job: UnscatteredJob) -> Tracer:
    """Return the tracer of unscattered light from distant sources to sensors."""
    origin = job.sensors.position.mean(axis=0)
    model = lower(job.scene, origin=origin)

    _, batches, _, channels = job.shape

    def trace(unit: Unit) -> Float[np.ndarray, "row batch column channel"]:
        rows, columns = len(unit.rows), len(unit.columns)
        normal = job.sensors.direction[unit.rows]
        flat = job.directions[unit.columns].reshape(-1, 3)
        point = np.repeat(job.sensors.position[unit.rows] - origin, len(flat), axis=0)
        with launching():
            start = vectors(mi.Point3f, point)
            towards = vectors(mi.Vector3f, np.tile(flat, (rows, 1)))
            share = transmittance(model, start, along(towards), mi.Bool(True))
            dr.eval(share)
            found = share.numpy()
        share = np.broadcast_to(found, (3, rows * len(flat))).reshape(3, rows, -1)
        light = share * np.maximum(normal @ flat.T, 0)
        means = light.reshape(3, rows, columns, batches, job.points).mean(axis=-1)
        return means[:channels].transpose(1, 3, 2, 0).astype(float)

    return trace
