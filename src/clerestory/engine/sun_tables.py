"""Radiance of windows in sunlight, tabulated by exit direction and sun.

    radiance        cells × suns   scattered by the BSDF, per direct normal irradiance
    transmittance   zones × suns   from the sun through the outside scene to the window

Both are means over the solar disc.
"""

from collections.abc import Callable, Iterator

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.bsdf.bsdf import Bsdf
from clerestory.directions import Frame, unit
from clerestory.engine.channels import band_groups, channels_of
from clerestory.engine.lower import lower
from clerestory.engine.materials.bsdf_file import forward_table
from clerestory.engine.peak_extraction import INWARDS, PeakTable, peak_cells
from clerestory.engine.unusual_lengths import scene_factor
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.visibility import ROUNDING, along, transmittance
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled
from clerestory.sky.solar_disc import GOLDEN_TURN, disc_points

# Numbers of points of the solar disc: for the transmittance from the sun, and for the
# shares of incident cells. With 64 points, the radiance of a blind was up to 10 % off
# in single exit cells, where the disc lies in incident cells of unlike transmission.
_DISC, _FINE = 16, 1024


class SunlitBsdf:
    """Radiance of a BSDF lit by suns, per direct normal irradiance [1/sr].

    `frame` is that of the window; if `peak`, unscattered transmission is left out.
    `cells` returns the incident cells of light in directions of the window's frame.
    """

    def __init__(
        self,
        bsdf: Bsdf,
        frame: Frame,
        *,
        peak: bool,
        cells: Callable[[Float[np.ndarray, "ray 3"]], Int[np.ndarray, " ray"]],
    ):
        self.table = forward_table(bsdf)
        self.peak = PeakTable(bsdf, INWARDS) if peak else None
        self.axes = np.array([frame.right, frame.up, frame.normal])
        self.cells = cells

    def radiance(
        self, leaving: Float[np.ndarray, "cell 3"], suns: Float[np.ndarray, "sun 3"]
    ) -> Float32[np.ndarray, "channel cell sun"]:
        """Return the scattered radiance in exit directions of the window's frame."""
        count = len(suns)
        lane = dr.arange(mi.UInt32, len(leaving) * count)
        width = dr.opaque(mi.UInt32, count)
        cell, sun = lane // width, lane % width
        with launching():
            out = dr.gather(mi.Vector3f, vectors(mi.Vector3f, leaving), cell)
            total = mi.Color3f(0)
            for direction, share in self._parts(suns):
                toward = vectors(mi.Vector3f, direction)
                weight = dr.gather(mi.Float, on_device(mi.Float, share), sun)
                total += weight * self._one(out, dr.gather(mi.Vector3f, toward, sun))
            dr.eval(total)
            found = np.asarray(total.numpy(), np.float32)
        return _grey(found.reshape(3, len(leaving), count))

    def _parts(
        self, suns: Float[np.ndarray, "sun 3"]
    ) -> Iterator[tuple[Float[np.ndarray, "sun 3"], Float[np.ndarray, " sun"]]]:
        # Parts of the solar disc in different incident cells: mean directions in the
        # window's frame, and shares of the disc
        disc = (solar_disc(suns, _FINE) @ self.axes.T).reshape(-1, 3)
        number = np.tile(np.arange(len(suns)), _FINE)
        disc, number = disc[disc[:, 2] < 0], number[disc[:, 2] < 0]
        keys = [self.cells(-disc)]
        if self.peak is not None:
            keys += peak_cells(-disc)
        # One number for each sun and cell, which is faster to sort than several
        key = number.astype(np.int64)
        for each in keys:
            key = key * (int(each.max(initial=0)) + 1) + each
        _, start, part = np.unique(key, return_index=True, return_inverse=True)
        sums = np.stack([np.bincount(part, axis) for axis in disc.T], axis=-1)
        share, sun = np.bincount(part) / _FINE, number[start]
        first = np.searchsorted(sun, sun, side="left")
        rank = np.arange(len(first)) - first
        for layer in range(rank.max(initial=-1) + 1):
            some, own = rank == layer, sun[rank == layer]
            directions, shares = (
                np.tile([0, 0, -1.0], (len(suns), 1)),
                np.zeros(len(suns)),
            )
            directions[own] = unit(sums[some])
            shares[own] = share[some]
            yield directions, shares

    def _one(self, leaving, incident):
        value, _ = self.table.evaluate(mi.UInt32(0), leaving, incident)
        value = self.table.colour(value)
        if self.peak is not None:
            value = self.peak.without(value, leaving, incident)
        return value * dr.maximum(-incident.z, 0)


def solar_disc(
    suns: Float[np.ndarray, "sun 3"], count: int = _DISC
) -> Float[np.ndarray, "point sun 3"]:
    """Return unit vectors to points of the solar disc around the centres of suns."""
    number = np.arange(count)
    place = np.stack([(number + 0.5) / count, number * GOLDEN_TURN], axis=-1)
    return disc_points(suns, place[None]).transpose(1, 0, 2)


def sun_transmittance(
    scene: Scene,
    points: Float[np.ndarray, "zone point 3"],
    normal: Float[np.ndarray, "3"],
    suns: Float[np.ndarray, "sun 3"],
) -> Float32[np.ndarray, "channel zone sun"]:
    """Return the transmittance from suns to zones of a window, given points of them.

    It is zero for suns on the side to which the window's normal points.
    """
    factor = scene_factor(scene)
    scene, points = scaled(scene, factor), points * factor
    groups = band_groups(scene)[: channels_of(scene)]
    parts = [_transmittance(group, points, normal, suns) for group in groups]
    return _grey(np.concatenate(parts)[: len(scene.bands)])


def _grey(
    values: Float32[np.ndarray, "channel row column"],
) -> Float32[np.ndarray, "channel row column"]:
    # One channel if all are equal
    return values[:1] if all(np.array_equal(values[0], v) for v in values) else values


def _transmittance(
    scene: Scene,
    points: Float[np.ndarray, "zone point 3"],
    normal: Float[np.ndarray, "3"],
    suns: Float[np.ndarray, "sun 3"],
) -> Float32[np.ndarray, "3 zone sun"]:
    zones, each, _ = points.shape
    origin = points.mean(axis=(0, 1))
    disc = solar_disc(suns)[np.arange(each) % _DISC]
    reach = np.maximum(np.abs(points - origin).max(axis=-1, keepdims=True), 0.05)
    start = points - origin - normal * (ROUNDING * reach)
    found = np.zeros((3, zones, len(suns)), np.float32)
    with launching():
        model = lower(scene, origin=origin)
        lane, count = dr.arange(mi.UInt32, zones * len(suns)), len(suns)
        width = dr.opaque(mi.UInt32, count)
        zone, sun = lane // width, lane % width
        for number in range(each):
            towards = disc[number]
            behind = dr.gather(mi.Bool, on_device(mi.Bool, towards @ normal < 0), sun)
            ray = along(dr.gather(mi.Vector3f, vectors(mi.Vector3f, towards), sun))
            position = dr.gather(
                mi.Point3f, vectors(mi.Point3f, start[:, number]), zone
            )
            share = transmittance(model, position, ray, behind)
            share = dr.select(behind, share, 0)
            dr.eval(share)
            part = np.broadcast_to(share.numpy(), (3, zones * count))
            found += part.reshape(found.shape)
    return found / each
