"""Sunlight that a window transmits in narrow beams, on visible surfaces and sensors.

Unscattered sunlight, and light scattered into few cells of a BSDF, reach few of the
points, and paths to random points of the window would miss them. For each point and
sun, one direction of the beams is chosen, and the line from the point against it is
tested against the window's rectangle. Only the pairs that pass are traced.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.engine.camera_rays import camera_rays
from clerestory.engine.channels import GROUP, band_groups
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.next_event_estimation import (
    Emission,
    LightSample,
    Path,
    Source,
    Vertex,
)
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.sampler import DIRECTION_U, DIRECTION_V, PathNumbers, mix, points
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.sun_beams import Beams
from clerestory.engine.unusual_lengths import in_usual_lengths
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.vertices import sensor_vertex
from clerestory.engine.visibility import (
    ROUNDING,
    along,
    first_hit,
    first_opaque,
    only_reflects,
    transmittance,
)
from clerestory.engine.window_path_jobs import (
    PixelWindowPaths,
    SensorWindowPaths,
    WindowPathsJob,
)
from clerestory.image.camera import Camera
from clerestory.scene.view import solid_angles
from clerestory.scene.window_zones import WindowZones

# Suns that are tested together: one bit each; most paths that are traced together
_BITS = 32
_PATHS = 1 << 22

# Least number of beams of a sun, a power of two
_BEAMS = 256

# Light by batch, output, receiver and step
Sums = Float32[np.ndarray, "batch out row step"]

# Tolerance of the test: relative to the window, and cosine of a surface turned away
_SLACK, _FACING = 1e-3, -1e-3


@dataclass
class BeamWindow(Source):
    """A window that transmits light towards a vertex along given directions.

    Attributes
    ----------
    inside, outside : scene with all windows as receivers, and without windows
    role : 1 + index of the window in `inside`
    normal : unit normal of the window, into the room
    direction, sun, value : by path, unit vectors against the beam and to the sun, and
        the irradiance perpendicular to the beam
    """

    name: ClassVar[str] = "beams"
    inside: LoweredScene
    outside: LoweredScene
    role: int
    normal: mi.Vector3f
    direction: mi.Vector3f | None = None
    sun: mi.Vector3f | None = None
    value: mi.Color3f | None = None

    def met(self, path: Path, si, shape, active) -> tuple[Emission, mi.Bool]:
        """Return no radiance: windows that are seen directly are not lit by beams."""
        role = dr.gather(mi.UInt32, self.inside.window_of_shape, shape, active)
        return Emission(mi.Color3f(0), mi.Bool(False)), active & (role > 0)

    def samples(
        self, vertex: Vertex, path: Path | None, numbers: PathNumbers
    ) -> Iterator[LightSample]:
        """Yield the direction against the beam."""

        def arriving(vertex: Vertex, active):
            start = vertex.leave(self.direction, active)
            return self.value * self.seen(start, active)

        active = dr.max(self.value) > 0
        yield LightSample(self.direction, mi.Float(1), active, arriving, heuristic=None)

    def seen(self, start: mi.Point3f, active) -> mi.Color3f:
        """Return the transmittance from the sun, by way of the window, to points."""
        inside = self.inside
        share, ray, hit = first_opaque(inside, start, along(self.direction), active)
        met = active & hit.is_valid()
        si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, met)
        shape = dr.reinterpret_array(mi.UInt32, si.shape)
        met &= dr.gather(mi.UInt32, inside.window_of_shape, shape, met) == self.role
        met &= dr.dot(self.normal, self.sun) < 0
        reach = dr.maximum(dr.max(dr.abs(si.p)), 0.05)
        start = si.p - self.normal * (ROUNDING * reach)
        passed = transmittance(self.outside, start, along(self.sun), met)
        return dr.select(met, share * passed, 0)


class BeamTracer:
    """Light of pixels or sensors due to beams of sunlight through a window.

    `number` is the index of the window in the job.
    """

    def __init__(self, job: WindowPathsJob, number: int):
        job = in_usual_lengths(job)
        scenes = band_groups(job.scene)
        self.groups = [_Group(replace(job, scene=scene), number) for scene in scenes]

    @property
    def beams(self) -> int:
        """Number of beams of a sun that the tracer expects."""
        return self.groups[0].beams

    def disc(
        self, weights: Float[np.ndarray, "out band"], beams: Beams
    ) -> tuple[Float[np.ndarray, "out step"], Float[np.ndarray, " step"]]:
        """Return what the solar disc contributes at the point of the cells of a sphere.

        The first value is the irradiance perpendicular to the beams, weighted by band,
        the second the share of the disc that is visible.
        """
        found = np.zeros((len(weights), len(beams.steps)))
        share = np.zeros(len(beams.steps))
        for number, group in enumerate(self.groups):
            light = group.disc(beams)
            own = weights[:, GROUP * number : GROUP * (number + 1)]
            mean = light.mean(axis=-1)[: own.shape[1]]
            found += own @ mean
            share = np.maximum(share, (light.max(axis=0) > 0).mean(axis=-1))
        return found, share

    def add(
        self,
        total: Sums,
        weights: Float[np.ndarray, "out band"],
        beams: Beams,
    ) -> None:
        """Add the light of each receiver and step to the sums."""
        for number, group in enumerate(self.groups):
            share = weights[:, GROUP * number : GROUP * (number + 1)]
            group.add(total, share, beams)


@dataclass
class _Visible:
    # Points that receive light: positions, normals, whether light may arrive from
    # either side, and whether there is such a point
    point: mi.Point3f
    normal: mi.Vector3f
    both: mi.Bool
    valid: mi.Bool


@dataclass
class _Places:
    # Sample points of receivers: row, batch and sample numbers
    row: mi.UInt32
    batch: mi.UInt32
    numbers: PathNumbers


class _Sensors:
    # Sensors, with an eighth of the sample points of the paths

    def __init__(self, job: SensorWindowPaths):
        self.points = max(4, _power_of_two(job.points // 8))
        self.origin = np.mean(job.sensors.position, axis=0)
        self.position = vectors(mi.Point3f, job.sensors.position - self.origin)
        self.normal = vectors(mi.Vector3f, job.sensors.direction)

    def visible(self, model: LoweredScene, places: _Places) -> _Visible:
        """Return the positions of the sensors."""
        point = dr.gather(mi.Point3f, self.position, places.row)
        normal = dr.gather(mi.Vector3f, self.normal, places.row)
        yes = dr.full(mi.Bool, True, dr.width(places.row))
        return _Visible(point, normal, ~yes, yes)

    def light(self, tracer: PathTracer, places: _Places) -> mi.Color3f:
        """Return the irradiance of sensors."""
        point = dr.gather(mi.Point3f, self.position, places.row)
        normal = dr.gather(mi.Vector3f, self.normal, places.row)
        vertex, sink = sensor_vertex(None, point, normal), RadianceSink()
        return tracer.sample_sources(
            sink, sink.begin(), vertex, places.numbers, mi.Color3f(1)
        )


class _Pixels:
    # Pixels, with a quarter of the sample points of the paths

    def __init__(self, job: PixelWindowPaths):
        self.points = max(2, _power_of_two(job.points // 4))
        self.origin = np.asarray(job.camera.position, dtype=float)
        self.rays = camera_rays(job.camera)

    def visible(self, model: LoweredScene, places: _Places) -> _Visible:
        """Return the points of surfaces that are seen in the pixels."""
        ray, valid = self._ray(places)
        hit = model.scene.ray_intersect_preliminary(ray, active=valid)
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        met = valid & hit.is_valid()
        flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, met)
        role = dr.gather(mi.UInt32, model.window_of_shape, shape, met)
        point, normal, found = first_hit(model, ray, valid)
        # Surfaces that transmit and scatter are traced for all suns
        both = met & ~only_reflects(flags) & mi.has_flag(flags, mi.BSDFFlags.Smooth)
        return _Visible(point, normal, both, (found & (role == 0)) | both)

    def light(self, tracer: PathTracer, places: _Places) -> mi.Color3f:
        """Return the radiance of pixels."""
        ray, valid = self._ray(places)
        path, sink = tracer.camera_path(ray), RadianceSink()
        return tracer.trace(sink, path, places.numbers, 1, valid)

    def _ray(self, places: _Places):
        numbers = places.numbers
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        return self.rays.through(places.row, x, y)


class _Group:
    # The light in three bands

    def __init__(self, job: WindowPathsJob, number: int):
        self.job = job
        pixels = isinstance(job, PixelWindowPaths)
        self.receivers = _Pixels(job) if pixels else _Sensors(job)
        origin, window = self.receivers.origin, job.windows[number]
        zones = WindowZones.of((window,))
        self.sequence = points(0, self.receivers.points)
        self.beams = max(_BEAMS, _power_of_two(job.batches) * self.receivers.points)
        with launching():
            self.window = BeamWindow(
                lower(job.scene, origin=origin, receivers=job.windows),
                lower(job.scene, origin=origin),
                number + 1,
                vectors(mi.Vector3f, window.frame.normal[None]),
            )
            self.corner = vectors(mi.Point3f, zones.corner - origin)
            self.edges = [
                vectors(mi.Vector3f, edge / np.square(edge).sum())
                for edge in (zones.across, zones.upwards)
            ]
            count = job.receivers * job.batches * self.receivers.points
            places = self._places(dr.arange(mi.UInt32, count))
            self.visible = self.receivers.visible(self.window.inside, places)
            dr.eval(self.visible)
        self.angles = _pixel_angles(job)

    def add(self, total: Sums, weights: np.ndarray, beams: Beams) -> None:
        # See `BeamTracer.add`
        for first in range(0, len(beams.steps), _BITS):
            part = beams.select(slice(first, first + _BITS))
            place, number = self._crossing(part)
            for start in range(0, len(place), _PATHS):
                some = slice(start, start + _PATHS)
                self._trace(total, weights, part, place[some], number[some])
        if beams.disc and self.angles is not None:
            self._disc(total, weights, beams, self.angles)

    def disc(self, beams: Beams) -> Float32[np.ndarray, "channel step beam"]:
        # Irradiance by the points of the solar disc at the point of the cells
        with launching():
            count = beams.value.shape[0] * beams.value.shape[1]
            light = self._seen(beams, dr.arange(mi.UInt32, count), mi.Point3f(0))
            dr.eval(light)
            return light.numpy().reshape(3, *beams.value.shape[:2])

    def _places(self, place) -> _Places:
        each = dr.opaque(mi.UInt32, self.receivers.points)
        batches = dr.opaque(mi.UInt32, self.job.batches)
        slot = place // each
        key = mi.sample_tea_32(slot, dr.opaque(mi.UInt32, self.job.seed))[0]
        numbers = PathNumbers(self.sequence, key, place % each, mi.UInt32(0))
        return _Places(slot // batches, slot % batches, numbers)

    def _order(self) -> "_Order":
        each, batches = self.receivers.points, self.job.batches
        own = self.beams // batches
        return _Order(
            *(
                dr.opaque(mi.UInt32, n)
                for n in (self.job.seed, each, batches, own, max(1, own // each))
            )
        )

    def _crossing(self, beams: Beams):
        # Sample points and suns for which the line against a beam crosses the window
        seen, count = self.visible, len(beams.steps)
        with launching():
            masks = _tested(
                seen.point, seen.normal, seen.both, seen.valid,
                vectors(mi.Vector3f, beams.direction.reshape(-1, 3)),
                on_device(mi.UInt32, beams.key), dr.opaque(mi.UInt32, count),
                self.corner, self.window.normal, *self.edges, self._order(),
            )  # fmt: skip
            found = masks.numpy()
        place = np.flatnonzero(found)
        bits = np.unpackbits(
            np.ascontiguousarray(found[place], "<u4").view(np.uint8).reshape(-1, 4),
            axis=1, bitorder="little", count=count,
        )  # fmt: skip
        row, number = np.nonzero(bits)
        return place[row], number

    def _trace(
        self,
        total: Sums,
        weights: np.ndarray,
        beams: Beams,
        found: Int[np.ndarray, " pair"],
        suns: Int[np.ndarray, " pair"],
    ) -> None:
        with launching():
            places = self._places(on_device(mi.UInt32, found))
            number, key = (
                on_device(mi.UInt32, part) for part in (suns, beams.key[suns])
            )
            beam = _chosen(on_device(mi.UInt32, found), number, key, self._order())
            lit = _lit(self.window, beams, beam)
            tracer = PathTracer(lit.inside, (lit,), 1.0, direct_only=True)
            light = self.receivers.light(tracer, places) / self.receivers.points
        _add(total, weights, light, places.row, beams.steps[suns], places.batch)

    def _disc(
        self, total: Sums, weights: np.ndarray, beams: Beams, angles: np.ndarray
    ) -> None:
        # Points of the solar disc seen through the window, each in its pixel
        job, (rows, columns) = self.job, angles.shape
        assert isinstance(job, PixelWindowPaths)
        assert isinstance(job.camera, Camera)
        camera = job.camera
        where = camera.view.pixel(beams.direction, columns=columns, rows=rows)
        place = np.floor(np.nan_to_num(where, nan=-1)).astype(int).reshape(-1, 2)
        row, column = place.T
        seen = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        chosen = np.flatnonzero(seen)
        angle = angles[row[chosen], column[chosen]]
        chosen, angle = chosen[angle > 0], angle[angle > 0]
        if not len(chosen):
            return
        with launching():
            pixel = on_device(mi.UInt32, (row * columns + column)[chosen])
            eye = dr.gather(mi.Point3f, self.receivers.rays.origin, pixel)
            light = self._seen(beams, on_device(mi.UInt32, chosen), eye)
            light *= on_device(mi.Float, job.batches / (self.beams * angle))
            batch = on_device(mi.UInt32, chosen % job.batches)
        step = beams.steps[chosen // self.beams]
        _add(total, weights, light, pixel, step, batch)

    def _seen(self, beams: Beams, beam, eye: mi.Point3f) -> mi.Color3f:
        # Light against beams that arrives at a point straight from the sun
        lit = _lit(self.window, beams, beam)
        return lit.value * lit.seen(eye, dr.max(lit.value) > 0)


@dr.syntax
def _tested(
    points,
    normals,
    both,
    valid,
    directions,
    keys,
    count,
    corner,
    plane,
    across,
    up,
    order,
):
    # Bit mask of the suns for which the line from each point crosses the window
    masks, number = mi.UInt32(0), mi.UInt32(0)
    place = dr.arange(mi.UInt32, dr.width(valid))
    apart = mi.Vector3f(corner - points)
    height = dr.dot(apart, plane)
    while number < count:
        key = dr.gather(mi.UInt32, keys, number)
        beam = _chosen(place, number, key, order)
        toward = dr.gather(mi.Vector3f, directions, beam)
        distance = height / dr.dot(toward, plane)
        offset = toward * distance - apart
        x, y = dr.dot(offset, across), dr.dot(offset, up)
        crosses = (distance > 0) & (dr.dot(toward, plane) < 0)
        crosses &= (x > -_SLACK) & (x < 1 + _SLACK) & (y > -_SLACK) & (y < 1 + _SLACK)
        crosses &= dr.dot(normals, toward) > _FACING
        masks |= dr.select(crosses | both, mi.UInt32(1) << number, 0)
        number += 1
    return dr.select(valid, masks, 0)


@dataclass
class _Order:
    # Seed, points per batch, batches, beams per batch, and beams from point to point
    seed: mi.UInt32
    points: mi.UInt32
    batches: mi.UInt32
    own: mi.UInt32
    apart: mi.UInt32


def _chosen(place, number, key, order: _Order):
    # Index of the beam of a sample point and sun. Batches have beams of their own; the
    # points of a batch take beams that are far apart
    slot, index = place // order.points, place % order.points
    start = mix(mix(slot, order.seed), key)
    own = (start + index * order.apart) % order.own
    beams = order.own * order.batches
    return number * beams + own * order.batches + slot % order.batches


def _pixel_angles(job: WindowPathsJob) -> Float[np.ndarray, "row column"] | None:
    # Solid angles of the pixels of a picture
    if isinstance(job, PixelWindowPaths) and isinstance(job.camera, Camera):
        return solid_angles(job.camera.view, job.camera.columns, job.camera.rows)
    return None


def _power_of_two(count: int) -> int:
    return 1 << max(0, count - 1).bit_length()


def _lit(window: BeamWindow, beams: Beams, beam) -> BeamWindow:
    # The window with the chosen beams
    direction, sun, value = (
        dr.gather(mi.Vector3f, vectors(mi.Vector3f, part.reshape(-1, 3)), beam)
        for part in (beams.direction, beams.sun, beams.value)
    )
    return replace(window, direction=direction, sun=sun, value=mi.Color3f(value))


def _add(total: Sums, weights: np.ndarray, light, row, step, batch) -> None:
    # Add the weighted light of receivers and steps, in a fixed order
    _, outputs, rows, steps = total.shape
    with launching():
        dr.eval(light, row, batch)
        found, row, batch = light.numpy(), row.numpy(), batch.numpy()
    values = weights @ found[: weights.shape[1]]
    place = row.astype(np.int64) * steps + step
    for output, value in enumerate(values):
        flat = (batch * outputs + output) * (rows * steps) + place
        np.add.at(total.reshape(-1), flat, value.astype(np.float32))
