"""Pixels and sensors at one instant, on the device: what traces their units.

Rays come from the middles of pixels and how they change across them, so that any
view is traced alike; sensors send theirs from `path_tracer`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine import sampler
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.first_hit import seen_surface
from clerestory.engine.lower import lower
from clerestory.engine.mirrors import Mirrors
from clerestory.engine.next_event_estimation import Draw, LitScene
from clerestory.engine.path_guiding import guided
from clerestory.engine.path_tracer import NOTHING, gather_at_sensor, look
from clerestory.engine.pilot_paths import LOOKING, visit
from clerestory.engine.portals import Portals, window_rectangles
from clerestory.engine.radiance_jobs import IrradianceJob, PictureJob
from clerestory.engine.sampler import points
from clerestory.engine.sun_lobes import SunLobes
from clerestory.engine.sun_patches import sun_patches
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene
from clerestory.scene.view import View

# Numbers beside the sequence for the place in a pixel
_PIXEL = 0x40000


def prepare_picture(job: PictureJob) -> Tracer:
    """Return what traces the radiance of a view's pixels, or their irradiance."""
    rays = PixelRays.of(job.view, job.columns, job.rows)
    origin = np.asarray(job.view.position, dtype=float)
    limit = segments_of(job.bounces)
    paths = _some_seen(rays, job.columns * job.rows)
    lit = light_of(job.scene, origin, paths)
    parted = parts_count(job.scene, job.bounces)

    def irradiance(draw: Draw, row):
        # The first numbers of the sequence go to the surface, not to the pixel
        x, y = (
            sampler.random_number(draw.seed, draw.index + draw.points.first, purpose)
            for purpose in (_PIXEL, _PIXEL + 1)
        )
        ray, valid = rays.through(row, x, y)
        position, normal, found = seen_surface(lit.model, ray, valid)
        gained, ray, weight, pdf, sought = gather_at_sensor(lit, draw, position, normal)
        gained += look(
            lit, draw.points, ray, draw.seed, draw.index, weight, pdf, sought,
            mi.Bool(False), dr.opaque(mi.UInt32, max(limit - 1, 0)),
            found & (dr.max(weight) > 0), parted=parted,
        )  # fmt: skip
        return dr.select(found, gained, 0)

    def light(draw: Draw, row):
        ray, valid = rays.through(
            row,
            draw.number(sampler.DIRECTION_U),
            draw.number(sampler.DIRECTION_V),
        )
        return look(
            lit, draw.points, ray, draw.seed, draw.index, mi.Color3f(1), mi.Float(0),
            mi.Float(NOTHING), mi.Bool(True), dr.opaque(mi.UInt32, limit), valid,
            parted=parted,
        )  # fmt: skip

    kind = irradiance if job.quantity == "irradiance" else light
    return tracer_of(kind, job.seed, job.batches)


def prepare_irradiance(job: IrradianceJob) -> Tracer:
    """Return what traces the irradiance of sensors."""
    origin = np.mean(job.sensors.position, axis=0)
    position = vectors(mi.Point3f, job.sensors.position - origin)
    normal = vectors(mi.Vector3f, job.sensors.direction)
    count = len(job.sensors.position)
    lit = light_of(job.scene, origin, _some_gathered(position, normal, count))
    # Radiance counts a sensor's own gather as a bounce
    limit = (1 << 30) if job.bounces is None else job.bounces
    parted = parts_count(job.scene, job.bounces)

    def gathered(draw: Draw, row):
        o = dr.gather(mi.Point3f, position, row)
        n = dr.gather(mi.Vector3f, normal, row)
        light, ray, weight, pdf, sought = gather_at_sensor(lit, draw, o, n)
        active = dr.max(weight) > 0
        return light + look(
            lit, draw.points, ray, draw.seed, draw.index, weight, pdf, sought,
            mi.Bool(False), dr.opaque(mi.UInt32, limit), active,
            parted=parted,
        )  # fmt: skip

    return tracer_of(gathered, job.seed, job.batches)


def light_of(
    scene: Scene,
    origin: Float[np.ndarray, "3"],
    paths: Callable[[], mi.Ray3f] | None = None,
) -> LitScene:
    """Return a scene with all that lights it, around a point.

    Parameters
    ----------
    paths : function that returns first segments of paths, which look what there is to
        aim at
    """
    model = lower(scene, origin=origin)
    windows = window_rectangles(scene, origin)
    lit = LitScene(
        model=model,
        sky=DistantEmitters.of(scene),
        portals=Portals.unknown(windows),
        mirrors=Mirrors.of(scene),
        lobes=SunLobes.of(scene),
    )
    if paths is None:
        return lit
    places = visit(model, paths())
    return guided(lit, windows, sun_patches(lit, places), places)


def _first_points(count: int):
    # Numbers of the first segments that look for sun: row, and place within it
    index = dr.arange(mi.UInt32, LOOKING)
    sequence, seed = points(0, LOOKING), mi.UInt32(1)
    purposes = (sampler.LOBE, sampler.DIRECTION_U, sampler.DIRECTION_V)
    pick, u, v = (
        sampler.coordinate(sequence, seed, index, mi.UInt32(0), purpose)
        for purpose in purposes
    )
    rows = dr.opaque(mi.UInt32, count)
    return dr.minimum(mi.UInt32(pick * mi.Float(rows)), rows - 1), u, v


def _some_seen(rays: "PixelRays", count: int):
    def paths() -> mi.Ray3f:
        ray, _ = rays.through(*_first_points(count))
        return ray

    return paths


def _some_gathered(position: mi.Point3f, normal: mi.Vector3f, count: int):
    def paths() -> mi.Ray3f:
        row, u, v = _first_points(count)
        local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u, v))
        upwards = mi.Frame3f(dr.gather(mi.Vector3f, normal, row))
        return mi.Ray3f(dr.gather(mi.Point3f, position, row), upwards.to_world(local))

    return paths


def parts_count(scene: Scene, bounces: int | None) -> bool:
    """Whether matt and glossy parts of materials count differently for a limit."""
    materials = scene.materials.values()
    return bounces is not None and any(
        getattr(each, "specularity", 0) > 0 for each in materials
    )


def segments_of(bounces: int | None) -> int:
    """Return the most segments between diffuse reflections."""
    return (1 << 30) if bounces is None else bounces + 1


@dataclass
class PixelRays:
    """Rays through the middles of pixels, and how they change across a pixel.

    The view's position is the origin of the device's frame.
    """

    origin: mi.Point3f
    direction: mi.Vector3f
    across: mi.Vector3f
    upwards: mi.Vector3f
    origin_across: mi.Vector3f | None
    origin_upwards: mi.Vector3f | None
    valid: mi.Bool

    @classmethod
    def of(cls, view: View, columns: int, rows: int) -> "PixelRays":
        """Return the rays of a view's pixels, row by row from the top."""

        def at(x: float, y: float):
            return view.rays(columns, rows, np.full((rows, columns, 2), [x, y]))

        middle = at(0.5, 0.5)
        left, right, below, above = at(0, 0.5), at(1, 0.5), at(0.5, 0), at(0.5, 1)

        def change(one, two, what: str):
            both = (one.valid & two.valid)[..., None]
            return np.where(both, getattr(two, what) - getattr(one, what), 0)

        moving = view.kind == "parallel" or view.fore > 0
        return cls(
            _rays(mi.Point3f, middle.origin - view.position),
            _rays(mi.Vector3f, middle.direction),
            _rays(mi.Vector3f, change(left, right, "direction")),
            _rays(mi.Vector3f, change(below, above, "direction")),
            _rays(mi.Vector3f, change(left, right, "origin")) if moving else None,
            _rays(mi.Vector3f, change(below, above, "origin")) if moving else None,
            on_device(mi.Bool, middle.valid),
        )

    def through(self, pixel, x, y):
        """Return the ray through a place of a pixel."""
        x, y = x - 0.5, y - 0.5
        direction = (
            dr.gather(mi.Vector3f, self.direction, pixel)
            + dr.gather(mi.Vector3f, self.across, pixel) * x
            + dr.gather(mi.Vector3f, self.upwards, pixel) * y
        )
        origin = dr.gather(mi.Point3f, self.origin, pixel)
        if self.origin_across is not None:
            origin += dr.gather(mi.Vector3f, self.origin_across, pixel) * x
            origin += dr.gather(mi.Vector3f, self.origin_upwards, pixel) * y
        valid = dr.gather(mi.Bool, self.valid, pixel)
        return mi.Ray3f(origin, dr.normalize(direction)), valid


def _rays(kind: type, values: Float[np.ndarray, "row column 3"]):
    return vectors(kind, values.reshape(-1, 3))


def tracer_of(light: Callable, seed: int, batches: int) -> Tracer:
    """Return what traces units: consecutive rows and a range of the sequence."""
    stretch = lru_cache(maxsize=1)(points)

    def trace(unit: Unit) -> Float[np.ndarray, "row batch 1 3"]:
        sequence, count = stretch(unit.first, unit.count), unit.count
        lane = dr.arange(mi.UInt32, len(unit.rows) * batches * count)
        index = lane % dr.opaque(mi.UInt32, count)
        slot = lane // dr.opaque(mi.UInt32, count)
        absolute = slot + dr.opaque(mi.UInt32, int(unit.rows[0]) * batches)
        row = absolute // dr.opaque(mi.UInt32, batches)
        key = mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[0]
        with launching():
            found = light(Draw(sequence, key, index, mi.UInt32(0)), row)
            dr.eval(found)
            total = dr.block_reduce(dr.ReduceOp.Add, found, count).numpy()
        return total.T.reshape(len(unit.rows), batches, 1, 3).astype(float)

    return trace
