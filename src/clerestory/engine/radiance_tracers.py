"""Radiance and irradiance at one instant: tracers of pixels, sensors and patches."""

from collections.abc import Callable
from functools import lru_cache, partial

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.camera_rays import CameraRays
from clerestory.engine.illumination import Illumination
from clerestory.engine.image_probabilities import with_learned_images
from clerestory.engine.learned_caustics import learned_caustics
from clerestory.engine.light_behind_layers import LayerPoints
from clerestory.engine.origin import Origin
from clerestory.engine.path_guiding import learned_portals
from clerestory.engine.path_tracer import SAMPLED_AT_START, PathTracer, segments_of
from clerestory.engine.pilot_paths import PILOT_PATHS, SurfacePoints, sample_surfaces
from clerestory.engine.portals import Portals, window_rectangles
from clerestory.engine.radiance_jobs import (
    ExitingRadianceJob,
    IrradianceJob,
    PictureJob,
)
from clerestory.engine.sampler import (
    DIRECTION_U,
    DIRECTION_V,
    LOBE,
    PathNumbers,
    points,
)
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.spherical_rectangle import Parallelograms, fold
from clerestory.engine.sun_patches import sun_patches
from clerestory.engine.upload import launching, on_device, search, vectors
from clerestory.engine.visibility import first_hit
from clerestory.engine.window_gaps import window_gaps
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene

# Dimensions of the hashed random numbers for the point in a pixel or patch
_PLACE = 0x40000

# Distance from the patch at which rays of exiting radiance start [m]
_BEFORE = 1e-3

_SINK = RadianceSink()


def prepare_picture(job: PictureJob) -> Tracer:
    """Return the tracer of the radiance or irradiance of a view's pixels."""
    rays = CameraRays.of(job.view, job.columns, job.rows)
    origin = np.asarray(job.view.position, dtype=float)
    pilots = partial(_camera_pilots, rays, job.receivers)
    tracer = radiance_tracer(job.scene, origin, job.bounces, pilots)
    limit = segments_of(job.bounces)

    def irradiance(numbers: PathNumbers, row):
        # Hashed numbers for the point in a pixel, Sobol' numbers for the surface point
        x, y = numbers.hashed(_PLACE), numbers.hashed(_PLACE + 1)
        ray, valid = rays.through(row, x, y)
        position, normal, found = first_hit(tracer.model, ray, valid)
        light = irradiance_at(tracer, numbers, position, normal, limit - 1, found)
        return dr.select(found, light, 0)

    def radiance(numbers: PathNumbers, row):
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        ray, valid = rays.through(row, x, y)
        return tracer.trace(_SINK, tracer.camera_path(ray), numbers, limit, valid)

    kind = irradiance if job.quantity == "irradiance" else radiance
    return tracer_of(kind, job.seed, job.batches)


def prepare_irradiance(job: IrradianceJob) -> Tracer:
    """Return the tracer of the irradiance of sensors."""
    origin = np.mean(job.sensors.position, axis=0)
    position = vectors(mi.Point3f, job.sensors.position - origin)
    normal = vectors(mi.Vector3f, job.sensors.direction)
    pilots = partial(_sensor_pilots, position, normal, job.receivers)
    place = job.sensors.position - origin
    sensors = SurfacePoints(place, place, job.sensors.direction)
    tracer = radiance_tracer(job.scene, origin, job.bounces, pilots, sensors)
    limit = segments_of(job.bounces, first=0)

    def irradiance(numbers: PathNumbers, row):
        o = dr.gather(mi.Point3f, position, row)
        n = dr.gather(mi.Vector3f, normal, row)
        return irradiance_at(tracer, numbers, o, n, limit, mi.Bool(True))

    return tracer_of(irradiance, job.seed, job.batches)


def prepare_outgoing(job: ExitingRadianceJob) -> Tracer:
    """Return the tracer of the exiting radiance of patches by direction.

    Rays start in the room just in front of a patch, and are traced towards it against
    the direction of light. Suns visible through the patch are excluded, because
    pictures sample suns through illums.
    """
    patches = job.patches
    origin = patches.corner.reshape(-1, 3).mean(axis=0)
    portals = Portals.uniform(window_rectangles(job.scene, origin))
    illuminated = Illumination.of(job.scene, origin)
    caustics = learned_caustics(job.scene, illuminated, origin)
    tracer = illuminated.tracer(portals, caustics)
    limit = segments_of(job.bounces)
    corner, b, c = np.moveaxis(patches.corner, 1, 0)
    triangles = Parallelograms.of(corner - origin, b - corner, c - corner)
    axes = [vectors(mi.Vector3f, patches.frame[:, i]) for i in range(3)]
    first = on_device(mi.UInt32, patches.first)
    # Patch index plus cumulative area fraction, increasing over all triangles
    number = np.repeat(np.arange(len(patches.frame)), np.diff(patches.first))
    cumulative = on_device(mi.Float, number + patches.cumulative)
    rings, sectors = (dr.opaque(mi.UInt32, n) for n in (job.rings, job.sectors))

    def radiance(numbers: PathNumbers, row):
        sector, ring = row % sectors, row // sectors % rings
        patch = row // (sectors * rings)
        u, v, pick = (numbers.hashed(_PLACE + n) for n in range(3))

        # Sample a point of the patch by area
        low = dr.gather(mi.UInt32, first, patch)
        high = dr.gather(mi.UInt32, first, patch + 1)
        place = mi.Float(patch) + pick
        number = dr.clip(search(cumulative, len(corner), place), low, high - 1)
        point = triangles.take(number).point(*fold(u, v))

        # Sample a direction of the ring and sector by projected solid angle
        step = 0.5 * dr.pi / mi.Float(rings)
        inner = dr.square(dr.sin(mi.Float(ring) * step))
        outer = dr.square(dr.sin((mi.Float(ring) + 1) * step))
        share = numbers.sobol(DIRECTION_U)
        sine2 = dr.lerp(inner, outer, share)
        turn = mi.Float(sector) + numbers.sobol(DIRECTION_V)
        turn = turn * (2 * dr.pi / mi.Float(sectors)) - dr.pi
        sine, (s, c) = dr.safe_sqrt(sine2), dr.sincos(turn)
        across, along, normal = (dr.gather(mi.Vector3f, a, patch) for a in axes)
        leaving = (across * c + along * s) * sine + normal * dr.safe_sqrt(1 - sine2)
        ray = mi.Ray3f(point + normal * _BEFORE, -leaving)
        path = tracer.path(ray, 1, SAMPLED_AT_START)
        return tracer.trace(_SINK, path, numbers, limit, mi.Bool(True))

    return tracer_of(radiance, job.seed, job.batches)


def irradiance_at(tracer: PathTracer, numbers, position, normal, limit: int, active):
    """Return the irradiance at points, estimated by one path per point."""
    light, path = tracer.gather(_SINK, numbers, position, normal)
    active = active & (dr.max(path.throughput) > 0)
    return tracer.trace(_SINK, path, numbers, max(limit, 0), active, light)


def radiance_tracer(
    scene: Scene,
    origin: Origin,
    bounces: int | None,
    pilots: Callable[[], mi.Ray3f],
    sensors: SurfacePoints | None = None,
) -> PathTracer:
    """Return a path tracer of radiance, guided towards windows and sunlit areas.

    `origin` is the origin of translated coordinates; the function `pilots` returns the
    first segments of pilot paths; `sensors` are the points at which paths start.
    """
    illuminated = Illumination.of(scene, origin)
    windows = window_rectangles(scene, origin)
    places = sample_surfaces(illuminated.model, pilots())
    illuminated = with_learned_images(illuminated, places, sensors)
    patches = sun_patches(illuminated, places)
    layers = LayerPoints.of(scene, origin)
    openings = windows + window_gaps(illuminated.model, windows, places)
    portals = learned_portals(illuminated, openings, patches, places, layers)
    caustics = learned_caustics(scene, illuminated, origin, sensors)
    splits = _splits_lobes(scene, bounces)
    return illuminated.tracer(portals, caustics, split_lobes=splits)


def _splits_lobes(scene: Scene, bounces: int | None) -> bool:
    # Whether a bounce limit applies and materials have diffuse and glossy components
    materials = scene.materials.values()
    glossy = any(getattr(each, "specularity", 0) > 0 for each in materials)
    return bounces is not None and glossy


def _pilot_numbers(count: int):
    # Index of the pixel or sensor of each pilot path, and two random numbers
    lane = dr.arange(mi.UInt32, PILOT_PATHS)
    numbers = PathNumbers(points(0, PILOT_PATHS), mi.UInt32(1), lane, mi.UInt32(0))
    pick, u, v = (numbers.sobol(n) for n in (LOBE, DIRECTION_U, DIRECTION_V))
    rows = dr.opaque(mi.UInt32, count)
    return dr.minimum(mi.UInt32(pick * mi.Float(rows)), rows - 1), u, v


def _camera_pilots(rays: CameraRays, count: int) -> mi.Ray3f:
    ray, _ = rays.through(*_pilot_numbers(count))
    return ray


def _sensor_pilots(position: mi.Point3f, normal: mi.Vector3f, count: int) -> mi.Ray3f:
    row, u, v = _pilot_numbers(count)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
    upwards = mi.Frame3f(dr.gather(mi.Vector3f, normal, row))
    return mi.Ray3f(dr.gather(mi.Point3f, position, row), upwards.to_world(local))


def tracer_of(light: Callable, seed: int, batches: int) -> Tracer:
    """Return the tracer of units, each of some rows and a range of samples."""
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> Float[np.ndarray, "row batch 1 3"]:
        sequence, count = stretch(unit.first, unit.count), unit.count
        lane = dr.arange(mi.UInt32, len(unit.rows) * batches * count)
        index = lane % dr.opaque(mi.UInt32, count)
        slot, most = lane // dr.opaque(mi.UInt32, count), dr.opaque(mi.UInt32, batches)
        row = dr.gather(mi.UInt32, on_device(mi.UInt32, unit.rows), slot // most)
        absolute = row * most + slot % most
        key = mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[0]
        with launching():
            found = light(PathNumbers(sequence, key, index, mi.UInt32(0)), row)
            dr.eval(found)
            total = dr.block_reduce(dr.ReduceOp.Add, found, count).numpy()
        return total.T.reshape(len(unit.rows), batches, 1, 3).astype(float)

    return trace
