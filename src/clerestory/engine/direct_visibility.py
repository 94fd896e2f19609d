"""Direct transmittance from distant sources, and first surfaces, through glass."""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

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

# Difference of transmittances, as a fraction of the largest, for which all rays of a
# pair are traced
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
        row = np.repeat(unit.rows, columns)
        column = np.tile(unit.columns, rows)
        sums, differ = rays.pilot(row, column)

        # Trace the other rays of pairs with differing transmittances
        means, rest = sums / job.pilot, job.points - job.pilot
        few = max(1, LANES // (job.batches * max(1, rest)))
        for first in range(0, len(differ) * (rest > 0), few):
            some = differ[first : first + few]
            others = rays.sums(row[some], column[some], job.pilot, rest)
            means[some] = (sums[some] + others) / job.points
        shape = rows, columns, job.batches, -1
        return means.reshape(shape).transpose(0, 2, 1, 3)

    return trace


class _ParallelRays:
    # Rays from sensors to sample points of distant sources

    def __init__(self, job: UnscatteredJob) -> None:
        origin = job.sensors.position.mean(axis=0)
        self._job, self._model = job, lower(job.scene, origin=origin)
        self._position = vectors(mi.Point3f, job.sensors.position - origin)
        self._normal = vectors(mi.Vector3f, job.sensors.direction)
        self._direction = vectors(mi.Vector3f, job.directions.reshape(-1, 3))

    def pilot(self, row: np.ndarray, column: np.ndarray) -> tuple[np.ndarray, ...]:
        # Sums of the pilot rays of pairs, by batch and channel, and the numbers of
        # pairs with differing transmittances
        count = self._job.pilot
        with launching():
            share, cosine = self._traced(row, column, 0, count)
            dr.eval(share, cosine)
            found = np.stack([each.numpy() for each in share], axis=-1)
            weight = cosine.numpy()
        shape = len(row), self._job.batches, count, len(share)
        rays, sums = found.reshape(shape), np.zeros((*shape[:2], shape[3]))
        weight = weight.reshape(*shape[:3], 1)

        # Most sensors are in the shade of most suns
        lit = np.flatnonzero(found.reshape(len(row), -1).any(axis=1))
        rays = rays[lit]
        sums[lit] = (rays * weight[lit]).sum(axis=2)
        low, high = rays.min(axis=(1, 2)), rays.max(axis=(1, 2))
        differ = np.any(high - low > _DIFFERENT * high, axis=1)
        return sums, lit[differ]

    def sums(
        self, row: np.ndarray, column: np.ndarray, first: int, count: int
    ) -> np.ndarray:
        # Sums of some rays of pairs, by batch and channel
        with launching():
            share, cosine = self._traced(row, column, first, count)
            light = [dr.block_sum(each * cosine, count) for each in share]
            dr.eval(light)
            found = np.stack([each.numpy() for each in light], axis=-1)
        return found.reshape(len(row), self._job.batches, -1).astype(float)

    def _traced(
        self, row: np.ndarray, column: np.ndarray, first: int, count: int
    ) -> tuple[list[mi.Float], mi.Float]:
        # Transmittance by channel and cosine of rays `first` to `first + count` of each
        # batch, the rays of a pair one after the other
        job = self._job
        ray = dr.arange(mi.UInt32, len(row) * job.batches * count)
        place = ray // count
        pair = place // job.batches
        source = dr.gather(mi.UInt32, on_device(mi.UInt32, column), pair)
        batch = source * job.batches + place - pair * job.batches
        number = batch * job.points + first + ray - place * count
        sensor = dr.gather(mi.UInt32, on_device(mi.UInt32, row), pair)
        towards = dr.gather(mi.Vector3f, self._direction, number)
        start = dr.gather(mi.Point3f, self._position, sensor)
        normal = dr.gather(mi.Vector3f, self._normal, sensor)
        cosine = dr.maximum(dr.dot(normal, towards), 0)
        active = cosine > 0
        share = transmittance(self._model, start, along(towards), active)
        channels = job.shape[3]
        return [dr.select(active, share[c], 0) for c in range(channels)], cosine
