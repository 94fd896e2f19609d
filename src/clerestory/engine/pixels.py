"""Pictures and sensors at one instant: launches, batches and their errors.

Every pixel or sensor is estimated by independent batches, each along its own
scrambled sequence; their spread gives the standard error. More accuracy lengthens
the sequences.
"""

from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine import points as sampling
from clerestory.engine.estimate import Effort
from clerestory.engine.look import Draw, LitScene, gather_at_sensor, look
from clerestory.engine.lower import lower
from clerestory.engine.mirrors import Mirrors
from clerestory.engine.points import Points, points
from clerestory.engine.portals import Portals
from clerestory.engine.sky_light import SkyLight
from clerestory.engine.upload import launching, vectors
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

# Independent batches of a picture's pixel, and of a sensor.
PICTURE_BATCHES, SENSOR_BATCHES = 8, 16

# Most paths in one launch, fewest points of a batch in it, most points of a batch.
_PATHS = 1 << 21
_SHORTEST = 8
_LONGEST = 1 << 20

# Sample points of a batch in the first round, when an error is aimed at.
_PILOT = 8

# Rows darker than this share of the mean need not reach the relative error.
_DARK = 0.01


@dataclass(frozen=True, eq=False)
class Lit:
    """Light that was gathered.

    Attributes
    ----------
    value : RGB radiance of pixels or irradiance of sensors
    error : standard error of each
    paths : traced in all
    reached : whether the relative error aimed at was reached
    """

    value: Float[np.ndarray, "row 3"]
    error: Float[np.ndarray, "row 3"]
    paths: int
    reached: bool


def trace_picture(
    scene: Scene, view: View, columns: int, rows: int, effort: Effort
) -> Lit:
    """Return the radiance of a view's pixels, row by row from the top.

    The relative error is that of the mean pixel: the root mean square of the standard
    errors over the mean radiance.
    """
    rays = PixelRays.of(view, columns, rows)
    origin = np.asarray(view.position, dtype=float)
    lit = _lit(scene, origin)
    limit = _segments(effort.bounces)

    def launch(draw: Draw, row):
        ray, valid = rays.through(
            row,
            draw.number(sampling.DIRECTION_U),
            draw.number(sampling.DIRECTION_V),
            origin,
        )
        return look(
            lit, draw.points, ray, draw.seed, draw.index, mi.Color3f(1), mi.Float(0),
            mi.Bool(True), dr.opaque(mi.UInt32, limit), valid,
        )  # fmt: skip

    def error(values: _Batches) -> float:
        mean, deviation = values.mean(), values.error()
        return float(np.sqrt(np.mean(deviation**2)) / max(mean.mean(), 1e-30))

    return _estimate(launch, columns * rows, PICTURE_BATCHES, effort, error)


def trace_irradiance(scene: Scene, sensors: Sensors, effort: Effort) -> Lit:
    """Return the irradiance of sensors; every one reaches the relative error."""
    origin = np.mean(sensors.position, axis=0)
    lit = _lit(scene, origin)
    position = vectors(mi.Point3f, sensors.position - origin)
    normal = vectors(mi.Vector3f, sensors.direction)
    # Radiance counts a sensor's own gather as a bounce
    limit = (1 << 30) if effort.bounces is None else effort.bounces

    def launch(draw: Draw, row):
        o = dr.gather(mi.Point3f, position, row)
        n = dr.gather(mi.Vector3f, normal, row)
        light, ray, weight, pdf = gather_at_sensor(lit, draw, o, n)
        active = dr.max(weight) > 0
        return light + look(
            lit, draw.points, ray, draw.seed, draw.index, weight, pdf,
            mi.Bool(False), dr.opaque(mi.UInt32, limit), active,
        )  # fmt: skip

    def error(values: _Batches) -> float:
        mean, deviation = values.mean(), values.error()
        floor = np.maximum(mean, _DARK * mean.mean())
        return float(np.max(deviation / np.where(floor > 0, floor, 1), initial=0.0))

    return _estimate(launch, len(sensors.position), SENSOR_BATCHES, effort, error)


def _lit(scene: Scene, origin: Float[np.ndarray, "3"]) -> LitScene:
    model = lower(scene, origin=origin)
    portals, mirrors = Portals.of(scene, origin), Mirrors.of(scene)
    return LitScene(model, SkyLight.of(scene), portals, mirrors)


def _segments(bounces: int | None) -> int:
    return (1 << 30) if bounces is None else bounces + 1


@dataclass
class PixelRays:
    """Rays through the middles of pixels, and how they change across a pixel."""

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
            _rays(mi.Point3f, middle.origin),
            _rays(mi.Vector3f, middle.direction),
            _rays(mi.Vector3f, change(left, right, "direction")),
            _rays(mi.Vector3f, change(below, above, "direction")),
            _rays(mi.Vector3f, change(left, right, "origin")) if moving else None,
            _rays(mi.Vector3f, change(below, above, "origin")) if moving else None,
            mi.Bool(middle.valid.ravel()),
        )

    def through(self, pixel, x, y, centre: Float[np.ndarray, "3"]):
        """Return the ray through a place of a pixel, in the device's frame."""
        x, y = x - 0.5, y - 0.5
        direction = (
            dr.gather(mi.Vector3f, self.direction, pixel)
            + dr.gather(mi.Vector3f, self.across, pixel) * x
            + dr.gather(mi.Vector3f, self.upwards, pixel) * y
        )
        origin = dr.gather(mi.Point3f, self.origin, pixel)
        origin -= mi.Point3f(*[float(c) for c in centre])
        if self.origin_across is not None:
            origin += dr.gather(mi.Vector3f, self.origin_across, pixel) * x
            origin += dr.gather(mi.Vector3f, self.origin_upwards, pixel) * y
        valid = dr.gather(mi.Bool, self.valid, pixel)
        return mi.Ray3f(origin, dr.normalize(direction)), valid


def _rays(kind: type, values: Float[np.ndarray, "row column 3"]):
    return vectors(kind, values.reshape(-1, 3))


@dataclass
class _Batches:
    # Sums over the sample points of each batch
    total: Float[np.ndarray, "batch row 3"]
    count: int = 0

    def mean(self) -> Float[np.ndarray, "row 3"]:
        return self.total.mean(axis=0) / self.count

    def error(self) -> Float[np.ndarray, "row 3"]:
        return self.total.std(axis=0, ddof=1) / (self.count * len(self.total) ** 0.5)


def _estimate(
    launch: Callable, rows: int, batches: int, effort: Effort, error: Callable
) -> Lit:
    sums = _Batches(np.zeros((batches, rows, 3)))
    length = _PILOT
    if effort.samples is not None:
        length = max(1, -(-effort.samples // batches))
    start, share = 0.0, 1.0 if effort.samples is not None else 0.05
    while True:
        _lengthen(launch, sums, length, effort, start, share)
        if effort.samples is not None:
            reached = True
            break
        ratio = error(sums) / effort.relative_error
        reached = ratio <= 1
        if reached or length >= _LONGEST:
            break
        growth = float(np.clip(ratio**1.6, 2, 16))
        start, share = start + share, (1 - start - share) * 0.8
        length = min(int(length * 2 ** np.ceil(np.log2(growth))), _LONGEST)
    if effort.progress:
        effort.progress(1.0, "done")
    return Lit(sums.mean(), sums.error(), rows * batches * sums.count, reached)


def _lengthen(
    launch: Callable,
    sums: _Batches,
    length: int,
    effort: Effort,
    start: float,
    share: float,
) -> None:
    # Bring every batch to `length` sample points, many rows or many points a launch
    batches, rows, _ = sums.total.shape
    have = begin = sums.count
    while have < length:
        count = min(length - have, max(_SHORTEST, _PATHS // (batches * rows)))
        block = max(1, _PATHS // (batches * count))
        sequence = points(have, count)
        for at in range(0, rows, block):
            number = np.arange(at, min(at + block, rows))
            sums.total[:, number] += _launch(
                launch, sequence, effort.seed, number, batches
            )
            if effort.progress:
                part = (have - begin + count * (number[-1] + 1) / rows) / (
                    length - begin
                )
                effort.progress(start + share * part, f"{length * batches} samples")
        have += count
    sums.count = length


def _launch(
    launch: Callable,
    sequence: Points,
    seed: int,
    rows: Int[np.ndarray, " row"],
    batches: int,
) -> Float[np.ndarray, "batch row 3"]:
    # Trace consecutive rows along a stretch of the sequence
    count = sequence.count
    lane = dr.arange(mi.UInt32, len(rows) * batches * count)
    index = lane % dr.opaque(mi.UInt32, count)
    slot = lane // dr.opaque(mi.UInt32, count)
    absolute = slot + dr.opaque(mi.UInt32, int(rows[0]) * batches)
    row = absolute // dr.opaque(mi.UInt32, batches)
    key = mi.sample_tea_32(absolute, dr.opaque(mi.UInt32, seed))[0]
    draw = Draw(sequence, key, index, mi.UInt32(0))
    with launching():
        light = launch(draw, row)
        dr.eval(light)
        total = dr.block_reduce(dr.ReduceOp.Add, light, count).numpy()
    return total.T.reshape(len(rows), batches, 3).transpose(1, 0, 2).astype(float)
