"""Direct transmittance from distant sources, and first surfaces, through glass."""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.lower import lower
from clerestory.engine.unscattered_jobs import LANES, UnscatteredJob
from clerestory.engine.unusual_lengths import scene_factor
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.visibility import (
    along,
    first_opaque,
    interaction,
    transmittance,
)
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled

# Difference of transmittances at the rim of a source, as a fraction of the largest, for
# which all sample points of a pair are traced
_DIFFERENT = 0.01


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
    rays = _ParallelRays(job)

    def trace(unit: Unit) -> Float[np.ndarray, "row batch column channel"]:
        rows, columns = len(unit.rows), len(unit.columns)
        row, column = np.repeat(unit.rows, columns), np.tile(unit.columns, rows)
        means = np.zeros((rows * columns, job.batches, job.shape[3]))
        chosen = np.arange(len(row))
        if job.probes is not None:
            alike, chosen, found = rays.probed(row, column)
            means[alike] = found
        few = max(1, LANES // (job.batches * job.points))
        for first in range(0, len(chosen), few):
            some = chosen[first : first + few]
            means[some] = rays.means(row[some], column[some])
        return means.reshape(rows, columns, job.batches, -1).transpose(0, 2, 1, 3)

    return trace


class _ParallelRays:
    # Rays from sensors to points of distant sources

    def __init__(self, job: UnscatteredJob) -> None:
        origin = job.sensors.position.mean(axis=0)
        self._job, self._model = job, lower(job.scene, origin=origin)
        self._position = vectors(mi.Point3f, job.sensors.position - origin)
        self._normal = vectors(mi.Vector3f, job.sensors.direction)
        self._points = vectors(mi.Vector3f, job.directions.reshape(-1, 3))
        if job.probes is not None:
            self._probes = vectors(mi.Vector3f, job.probes.reshape(-1, 3))

    def probed(
        self, row: np.ndarray, column: np.ndarray
    ) -> tuple[
        Int[np.ndarray, " alike"],
        Int[np.ndarray, " differing"],
        Float[np.ndarray, "alike batch channel"],
    ]:
        """Trace the probes of pairs of a sensor and a source.

        Return the indices of pairs that are alike at the rim of the source and receive
        light, those of pairs that differ at the rim, and the mean light of the former
        by batch. All others receive none.
        """
        job = self._job
        count, inside = job.first_rays, job.inside
        with launching():
            share, cosine = self._traced(row, column, self._probes, count)
            dr.eval(share, cosine)
            found = np.stack([each.numpy() for each in share], axis=-1)
            weight = cosine.numpy()

        # Most sensors are in the shade of most suns
        rays = found.reshape(len(row), count, -1)
        lit = np.flatnonzero(rays.any(axis=(1, 2)))
        rays, weight = rays[lit], weight.reshape(-1, count, 1)[lit]
        rim = rays[:, :-inside]
        low, high = rim.min(axis=1), rim.max(axis=1)
        differ = np.any(high - low > _DIFFERENT * high, axis=1)

        # Control variate: the mean cosine over the source is known, so that the
        # estimate of a source that is visible as a whole has no variance
        rays, weight, rim = rays[~differ], weight[~differ], rim[~differ]
        middle = weight[:, :-inside].mean(axis=1, keepdims=True)
        here = weight[:, -inside:]
        light = rays[:, -inside:] * here
        light -= rim.mean(axis=1, keepdims=True) * (here - middle)
        return lit[~differ], lit[differ], _by_batch(light, job.batches)

    def means(
        self, row: np.ndarray, column: np.ndarray
    ) -> Float[np.ndarray, "pair batch channel"]:
        """Return the mean light of all sample points of pairs, by batch."""
        batches, points = self._job.batches, self._job.points
        with launching():
            share, cosine = self._traced(row, column, self._points, batches * points)
            light = [dr.block_sum(each * cosine, points) for each in share]
            dr.eval(light)
            found = np.stack([each.numpy() for each in light], axis=-1)
        return found.reshape(len(row), batches, -1).astype(float) / points

    def _traced(
        self, row: np.ndarray, column: np.ndarray, points: mi.Vector3f, count: int
    ) -> tuple[list[mi.Float], mi.Float]:
        # Transmittance by channel, and cosine, of rays to `count` points of the source;
        # the rays of a pair one after the other
        ray = dr.arange(mi.UInt32, len(row) * count)
        pair = ray // count
        source = dr.gather(mi.UInt32, on_device(mi.UInt32, column), pair)
        sensor = dr.gather(mi.UInt32, on_device(mi.UInt32, row), pair)
        towards = dr.gather(mi.Vector3f, points, source * count + ray - pair * count)
        start = dr.gather(mi.Point3f, self._position, sensor)
        normal = dr.gather(mi.Vector3f, self._normal, sensor)
        cosine = dr.maximum(dr.dot(normal, towards), 0)
        active = cosine > 0
        share = transmittance(self._model, start, along(towards), active)
        channels = self._job.shape[3]
        return [dr.select(active, share[c], 0) for c in range(channels)], cosine


def _by_batch(
    light: Float[np.ndarray, "pair ray channel"], batches: int
) -> Float[np.ndarray, "pair batch channel"]:
    # Values of batches with the mean of the rays, and with the same standard error
    rays = light.shape[1]
    mean = light.mean(axis=1, keepdims=True, dtype=float)
    found = np.repeat(mean, batches, axis=1)
    scale = np.sqrt(batches * (batches - 1) / (rays * (rays - 1)))
    found[:, :rays] += scale * (light - mean)
    return found
