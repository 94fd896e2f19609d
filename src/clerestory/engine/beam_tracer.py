"""Sunlight that a window transmits in narrow beams, on visible surfaces and sensors.

Unscattered sunlight, and light scattered into few cells of a BSDF, reach few of the
points, and paths to random points of the window would miss them. For each point and
sun, one direction of the beams is chosen, and the line from the point against it is
tested against the window's rectangle. Only the pairs that pass are traced.
"""

from collections.abc import Iterator
from dataclasses import replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.engine.beam_choice import BeamOrder, Rectangle, chosen_beam, crossed
from clerestory.engine.beam_receivers import (
    BeamPixels,
    BeamSensors,
    Places,
    power_of_two,
)
from clerestory.engine.beam_window import BeamWindow
from clerestory.engine.channels import GROUP, band_groups, channels_of
from clerestory.engine.lambertian_beams import BeamLight, LambertianPoints
from clerestory.engine.lower import lower
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.sampler import PathNumbers, points
from clerestory.engine.sun_beams import Beams
from clerestory.engine.unusual_lengths import in_usual_lengths
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.window_path_jobs import PixelWindowPaths, WindowPathsJob
from clerestory.image.camera import Camera
from clerestory.scene.view import solid_angles
from clerestory.scene.window_zones import WindowZones, fills_rectangle

# Suns of a bit mask, most bit masks of a launch, most paths that are traced together
_BITS = 32
_MASKS = 1 << 21
_PATHS = 1 << 22

# Least number of beams of a sun, a power of two
_BEAMS = 256

# Light by batch, output, receiver and step; weights of the bands
Sums = Float32[np.ndarray, "batch out row step"]
Weights = Float[np.ndarray, "out band"]


class BeamTracer:
    """Light of pixels or sensors due to beams of sunlight through a window.

    `number` is the index of the window in the job.
    """

    def __init__(self, job: WindowPathsJob, number: int):
        job = in_usual_lengths(job)
        scenes = band_groups(job.scene)
        if channels_of(job.scene) == 1:
            # Only the beams have colours
            same = _Group(replace(job, scene=scenes[0]), number)
            self.groups = [same] * len(scenes)
            return
        self.groups = [_Group(replace(job, scene=scene), number) for scene in scenes]

    @property
    def beams(self) -> int:
        """Number of beams of a sun that the tracer expects."""
        return self.groups[0].beams

    def disc(
        self, weights: Weights, beams: Beams
    ) -> tuple[Float[np.ndarray, "out step"], Float[np.ndarray, " step"]]:
        """Return the irradiance by the solar disc at the centre of a sphere.

        The first value is the irradiance perpendicular to the beams, weighted by band,
        the second the share of the disc that is visible.
        """
        found = np.zeros((len(weights), len(beams.steps)))
        share = np.zeros(len(beams.steps))
        for number, group in enumerate(self._needed(weights)):
            light = group.disc(beams.group(number))
            own = weights[:, GROUP * number : GROUP * (number + 1)]
            mean = light.mean(axis=-1)[: own.shape[1]]
            found += own @ mean
            share = np.maximum(share, (light.max(axis=0) > 0).mean(axis=-1))
        return found, share

    def add(self, total: Sums, weights: Weights, beams: Beams) -> None:
        """Add the light of points that are not Lambertian to the sums."""
        _, outputs, rows, steps = total.shape
        for found in self._traced(weights, beams):
            place = found.row.astype(np.int64) * steps + found.step
            for output, value in enumerate(found.values):
                flat = (found.batch * outputs + output) * (rows * steps) + place
                np.add.at(total.reshape(-1), flat, value)

    def add_lambertian(
        self, totals: list[mi.Float], steps: int, weights: Weights, beams: Beams
    ) -> None:
        """Add the light of Lambertian points to sums on the device, by output."""
        for group, share, own in self._parts(weights, beams):
            group.lambertian.add(totals, steps, share, own)

    def light(self, weights: Weights, beams: Beams) -> Iterator[BeamLight]:
        """Yield the light of receivers and steps, weighted by band; add equal pairs."""
        for group, share, own in self._parts(weights, beams):
            yield from group.lambertian.light(share, own)
        yield from self._traced(weights, beams)

    def _traced(self, weights: Weights, beams: Beams) -> Iterator[BeamLight]:
        for group, share, own in self._parts(weights, beams):
            yield from group.light(share, own)

    def _parts(
        self, weights: Weights, beams: Beams
    ) -> "Iterator[tuple[_Group, np.ndarray, Beams]]":
        # Groups of the bands with weights; a single weight applies to grey light
        for number, group in enumerate(self._needed(weights)):
            share = weights[:, GROUP * number : GROUP * (number + 1)]
            yield group, share, beams.group(number)

    def _needed(self, weights: Weights) -> "list[_Group]":
        return self.groups[: -(-weights.shape[1] // GROUP)]


class _Group:
    # The light in three bands

    def __init__(self, job: WindowPathsJob, number: int):
        self.job = job
        pixels = isinstance(job, PixelWindowPaths)
        self.receivers = BeamPixels(job) if pixels else BeamSensors(job)
        origin, window = self.receivers.origin, job.windows[number]
        zones = WindowZones.of((window,))
        self.sequence = points(0, self.receivers.points)
        self.beams = max(_BEAMS, power_of_two(job.batches) * self.receivers.points)
        with launching():
            self.window = BeamWindow(
                lower(job.scene, origin=origin, receivers=job.windows),
                lower(job.scene, origin=origin),
                number + 1,
                vectors(mi.Vector3f, window.frame.normal[None]),
            )
            self.rectangle = Rectangle(
                vectors(mi.Point3f, zones.corner - origin),
                self.window.normal,
                *(
                    vectors(mi.Vector3f, edge / np.square(edge).sum())
                    for edge in (zones.across, zones.upwards)
                ),
            )
            self.alone = fills_rectangle(number, job.windows)
            self.slots = job.receivers * job.batches
            count = self.slots * self.receivers.points
            places = self._places(dr.arange(mi.UInt32, count))
            self.visible = self.receivers.visible(self.window.inside, places)
            # Other points are those at which paths are needed
            self.others = self.visible.valid & ~self.visible.lambertian
            dr.eval(self.visible, self.others)
            self.traces = bool(dr.any(self.others))
        self.angles = _pixel_angles(job)

    @property
    def lambertian(self) -> LambertianPoints:
        """Points at which no paths are needed."""
        points = self.visible, self.window, self.rectangle, self._order()
        return LambertianPoints(*points, self.slots, self.alone)

    def light(self, weights: np.ndarray, beams: Beams) -> Iterator[BeamLight]:
        # Light of the other points, and of the disc; see `BeamTracer.light`
        words = max(1, _MASKS // dr.width(self.visible.valid))
        suns = len(beams.steps) if self.traces else 0
        for first in range(0, suns, _BITS * words):
            part = beams.select(slice(first, first + _BITS * words))
            place, number = self._crossing(part)
            for start in range(0, len(place), _PATHS):
                some = slice(start, start + _PATHS)
                yield self._trace(weights, part, place[some], number[some])
        if beams.disc and self.angles is not None:
            yield from self._disc(weights, beams, self.angles)

    def disc(self, beams: Beams) -> Float32[np.ndarray, "channel step beam"]:
        # Irradiance by the points of the solar disc at the point of the cells
        with launching():
            count = beams.value.shape[0] * beams.value.shape[1]
            light = self._seen(beams, dr.arange(mi.UInt32, count), mi.Point3f(0))
            dr.eval(light)
            return light.numpy().reshape(3, *beams.value.shape[:2])

    def _places(self, place) -> Places:
        each = dr.opaque(mi.UInt32, self.receivers.points)
        batches = dr.opaque(mi.UInt32, self.job.batches)
        slot = place // each
        key = mi.sample_tea_32(slot, dr.opaque(mi.UInt32, self.job.seed))[0]
        numbers = PathNumbers(self.sequence, key, place % each, mi.UInt32(0))
        return Places(slot // batches, slot % batches, numbers)

    def _order(self) -> BeamOrder:
        job, each = self.job, self.receivers.points
        return BeamOrder.of(
            seed=job.seed, points=each, batches=job.batches, beams=self.beams
        )

    def _crossing(
        self, beams: Beams
    ) -> tuple[Int[np.ndarray, " pair"], Int[np.ndarray, " pair"]]:
        # Sample points and suns for which the line against a beam crosses the window
        seen, count = self.visible, len(beams.steps)
        words = -(-count // _BITS)
        with launching():
            masks = crossed(
                seen.point, seen.normal, seen.both, self.others,
                vectors(mi.Vector3f, beams.direction.reshape(-1, 3)),
                on_device(mi.UInt32, beams.key), dr.opaque(mi.UInt32, count), words,
                self.rectangle, self._order(),
            )  # fmt: skip
            found = masks.numpy()
        mask = np.flatnonzero(found)
        bits = np.unpackbits(
            np.ascontiguousarray(found[mask], "<u4").view(np.uint8).reshape(-1, 4),
            axis=1, bitorder="little",
        )  # fmt: skip
        row, bit = np.nonzero(bits)
        place, word = np.divmod(mask[row], words)
        return place, _BITS * word + bit

    def _trace(
        self,
        weights: np.ndarray,
        beams: Beams,
        found: Int[np.ndarray, " pair"],
        suns: Int[np.ndarray, " pair"],
    ) -> BeamLight:
        with launching():
            places = self._places(on_device(mi.UInt32, found))
            number, key = (
                on_device(mi.UInt32, part) for part in (suns, beams.key[suns])
            )
            beam = chosen_beam(on_device(mi.UInt32, found), number, key, self._order())
            lit = self.window.lit(beams, beam)
            tracer = PathTracer(lit.inside, (lit,), 1.0, direct_only=True)
            light = self.receivers.light(tracer, places) / self.receivers.points
        return _weighted(weights, light, places.row, beams.steps[suns], places.batch)

    def _disc(
        self, weights: np.ndarray, beams: Beams, angles: np.ndarray
    ) -> Iterator[BeamLight]:
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
        yield _weighted(weights, light, pixel, step, batch)

    def _seen(self, beams: Beams, beam, eye: mi.Point3f) -> mi.Color3f:
        # Light against beams that arrives at a point straight from the sun
        lit = self.window.lit(beams, beam)
        return lit.value * lit.seen(eye, dr.max(lit.value) > 0)


def _pixel_angles(job: WindowPathsJob) -> Float[np.ndarray, "row column"] | None:
    # Solid angles of the pixels of a picture
    if isinstance(job, PixelWindowPaths) and isinstance(job.camera, Camera):
        return solid_angles(job.camera.view, job.camera.columns, job.camera.rows)
    return None


def _weighted(weights: np.ndarray, light, row, step, batch) -> BeamLight:
    # Light weighted by band, of receivers and steps
    with launching():
        dr.eval(light, row, batch)
        found, row, batch = light.numpy(), row.numpy(), batch.numpy()
    values = weights @ found[: weights.shape[1]]
    return BeamLight(batch, row, step, values.astype(np.float32))
