"""Narrow beams of sunlight on Lambertian surfaces and sensors.

The light that such a point scatters is a factor times its irradiance, so that no path
is traced: for each point and sun, the line against the chosen beam is tested against
the window's rectangle, and only then for occlusion. All points of a receiver are tested
and summed in one kernel.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.engine.beam_choice import BeamOrder, Rectangle, beam_of
from clerestory.engine.beam_receivers import Visible
from clerestory.engine.beam_window import BeamWindow
from clerestory.engine.conditional_evaluation import where_needed
from clerestory.engine.sun_beams import Beams
from clerestory.engine.upload import launching, on_device, vectors

# Suns of a lane, and most pairs of a receiver, in a batch, and a sun whose light is
# stored at once
_SUNS, _STORED = 16, 1 << 24


class BeamLight(NamedTuple):
    """Light by beams in some pairs of receiver and time step, in a batch of paths."""

    batch: Int[np.ndarray, " pair"]
    row: Int[np.ndarray, " pair"]
    step: Int[np.ndarray, " pair"]
    values: Float32[np.ndarray, "out pair"]


@dataclass
class LambertianPoints:
    """Sample points of receivers, and the window from which beams arrive.

    Attributes
    ----------
    seen, window, rectangle, order : points, window, and order of its beams
    slots : number of receivers times batches
    alone : whether all that crosses the rectangle crosses the window and no other one
    """

    seen: Visible
    window: BeamWindow
    rectangle: Rectangle
    order: BeamOrder
    slots: int
    alone: bool

    def add(
        self,
        totals: list[mi.Float],
        steps: int,
        weights: Float[np.ndarray, "out channel"],
        beams: Beams,
    ) -> None:
        """Add the light by beams to totals on the device, one for each output.

        A total is indexed by batch, receiver and step; `steps` is their number.
        """
        suns = len(beams.steps)
        if not suns:
            return
        with launching():
            share = [[dr.opaque(mi.Float, float(w)) for w in row] for row in weights]
            counts = (dr.opaque(mi.UInt32, n) for n in (self.slots, suns, steps))
            lanes = self.slots * -(-suns // _SUNS)
            _add(lanes, *counts, totals, share, _OnDevice.of(beams), self)
            dr.eval(*totals)

    def light(
        self, weights: Float[np.ndarray, "out channel"], beams: Beams
    ) -> Iterator[BeamLight]:
        """Yield the light by beams in pairs of receiver and step."""
        together = max(1, _STORED // self.slots)
        for first in range(0, len(beams.steps), together):
            part = beams.select(slice(first, first + together))
            steps = len(part.steps)
            totals = [dr.zeros(mi.Float, self.slots * steps) for _ in weights]
            self.add(totals, steps, weights, replace(part, steps=np.arange(steps)))
            batches = int(self.order.batches[0])
            shape = len(weights), batches, self.slots // batches, steps
            found = np.stack([each.numpy() for each in totals]).reshape(shape)
            batch, row, step = np.nonzero(found.any(axis=0))
            yield BeamLight(batch, row, part.steps[step], found[:, batch, row, step])


@dataclass
class _OnDevice:
    # Beams of several suns on the compute device
    steps: mi.UInt32
    key: mi.UInt32
    direction: mi.Vector3f
    sun: mi.Vector3f
    value: mi.Vector3f
    disc: bool

    @classmethod
    def of(cls, beams: Beams) -> "_OnDevice":
        parts = beams.direction, beams.sun, beams.value
        return cls(
            *(on_device(mi.UInt32, part) for part in (beams.steps, beams.key)),
            *(vectors(mi.Vector3f, part.reshape(-1, 3)) for part in parts),
            beams.disc,
        )


@dr.syntax
def _add(
    lanes,
    slots,
    suns,
    steps,
    totals,
    share,
    beams: _OnDevice,
    points: LambertianPoints,
):
    # A lane computes a receiver in a batch, and some suns
    lane = dr.arange(mi.UInt32, lanes)
    group = lane // slots
    slot = lane - group * slots
    row, batch = points.order.divided(slot, points.order.batches)
    rows, _ = points.order.divided(slots, points.order.batches)
    first = (batch * rows + row) * steps
    number = group * _SUNS
    last = dr.minimum(number + _SUNS, suns)
    while number < last:
        light = mi.Color3f(0)
        key = dr.gather(mi.UInt32, beams.key, number)
        index = mi.UInt32(0)
        while index < points.order.points:
            beam = beam_of(slot, batch, index, number, key, points.order)
            place = slot * points.order.points + index
            light += _scattered(place, beam, beams, points)
            index += 1
        lit = dr.max(light) > 0
        light /= mi.Float(points.order.points)
        where = first + dr.gather(mi.UInt32, beams.steps, number)
        _sum(totals, share, light, where, lit)
        number += 1


def _scattered(place, beam, beams: _OnDevice, points: LambertianPoints):
    # Light of a point by the beam that arrives there
    seen, window = points.seen, points.window
    # The sun is seen by way of the window, if at all
    straight = beams.disc and points.alone and not window.inside.panes
    point = dr.gather(mi.Point3f, seen.point, place)
    toward = dr.gather(mi.Vector3f, beams.direction, beam)
    slack = {"slack": 0.0} if straight else {}

    def scattered(active):
        normal = dr.gather(mi.Vector3f, seen.normal, place, active)
        factor = dr.gather(mi.Color3f, seen.factor, place, active)
        value = mi.Color3f(dr.gather(mi.Vector3f, beams.value, beam, active)) * factor
        cosine = dr.dot(normal, toward)
        active = active & (cosine > 0) & (dr.max(value) > 0)
        if straight:
            passed = window.open_to(toward, point, active)
        else:
            sun = dr.gather(mi.Vector3f, beams.sun, beam, active)
            passed = window.along(toward, sun).seen(point, active)
        return dr.select(active, value * passed * cosine, 0)

    crosses = points.rectangle.crossed(point, toward, **slack)
    return where_needed(crosses, scattered, lambda: mi.Color3f(0))


def _sum(totals, share, light, where, active) -> None:
    # Each element is added to once, so that additions need not be atomic
    for total, weights in zip(totals, share, strict=True):
        value = sum(w * each for w, each in zip(weights, light, strict=False))
        add, mode = dr.ReduceOp.Add, dr.ReduceMode.NoConflicts
        dr.scatter_reduce(add, total, value, where, active, mode)
