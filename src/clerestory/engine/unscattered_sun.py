"""Unscattered sunlight through a window, on visible surfaces and as the solar disc.

Sunlight that a BSDF transmits without scattering reaches few of the pixels. The line
from each visible point to the sun is tested against the window's rectangle; paths are
traced for the points that pass.
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, UInt32

from clerestory.engine.camera_rays import CameraRays
from clerestory.engine.channels import GROUP, band_groups
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.sampler import (
    CONNECT_U,
    CONNECT_V,
    DIRECTION_U,
    DIRECTION_V,
    PathNumbers,
    points,
)
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.sun_tables import solar_disc
from clerestory.engine.sunlit_window import SunlitWindow, UnscatteredWindow
from clerestory.engine.unusual_lengths import in_usual_lengths
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.visibility import first_hit, only_reflects
from clerestory.engine.window_path_jobs import PixelSunPaths
from clerestory.scene.view import solid_angles
from clerestory.scene.window_zones import WindowZones

# Sample points per pixel and batch
_POINTS = 2

# Largest number of points and suns that are tested together
_TESTED = 1 << 24

# Number of points of the solar disc
_DISC = 256

# Angle by which the test exceeds the solar disc [rad]
_MARGIN = 0.01


@dataclass
class _Visible:
    # Visible points: positions, normals, whether light may arrive from either side, and
    # whether there is a surface that is not a window
    point: mi.Point3f
    normal: mi.Vector3f
    both: mi.Bool
    valid: mi.Bool


class UnscatteredSuns:
    """Radiance of the pixels of a view due to unscattered sunlight through a window."""

    def __init__(self, job: PixelSunPaths):
        job = in_usual_lengths(job)
        scenes = band_groups(job.scene)
        self.groups = [_Group(replace(job, scene=scene)) for scene in scenes]

    def add(
        self,
        total: list[list[mi.Float]],
        weights: Float[np.ndarray, "out band"],
        suns: Float[np.ndarray, "step 3"],
        irradiance: Float[np.ndarray, " step"],
        width: int,
    ) -> None:
        """Add the radiance at each pixel and step to sums by batch and output.

        Steps are `width` elements of the sums apart from pixel to pixel.
        """
        for number, group in enumerate(self.groups):
            share = weights[:, GROUP * number : GROUP * (number + 1)]
            group.add(total, share, suns, irradiance, width)


class _Group:
    # The radiance in three bands

    def __init__(self, job: PixelSunPaths):
        self.origin = np.asarray(job.view.position, dtype=float)
        whole = SunlitWindow.of(job, self.origin)
        self.window = UnscatteredWindow(**vars(whole))
        self.job = job
        self.rays = CameraRays.of(job.view, job.columns, job.rows)
        self.sequence = points(0, _POINTS)
        self.tracer = PathTracer(whole.inside, (self.window,), 1.0, direct_only=True)
        zones = WindowZones.of((job.windows[job.number],))
        self.corner = zones.corner[0] - self.origin
        self.edges = np.array([zones.across[0], zones.upwards[0]])
        self.normal = job.windows[job.number].frame.normal
        self.visible = self._visible()
        self.angles = solid_angles(job.view, job.columns, job.rows)

    @property
    def points(self) -> int:
        """Number of sample points of all pixels and batches."""
        return self.job.pixels * self.job.batches * _POINTS

    def add(
        self,
        total: list[list[mi.Float]],
        share: Float[np.ndarray, "out channel"],
        suns: Float[np.ndarray, "step 3"],
        irradiance: Float[np.ndarray, " step"],
        width: int,
    ) -> None:
        # See `UnscatteredSuns.add`
        every = max(1, _TESTED // max(1, len(suns)))
        for first in range(0, self.points, every):
            count = min(every, self.points - first)
            found = self._lit(first, count, suns)
            if len(found):
                self._trace(total, share, found, first, suns, irradiance, width)
        self._disc(total, share, suns, irradiance, width)

    def _numbers(self, place):
        # Pixel, batch and sample numbers of a sample point
        each = dr.opaque(mi.UInt32, _POINTS)
        slot, index = place // each, place % each
        batches = dr.opaque(mi.UInt32, self.job.batches)
        pixel = slot // batches
        key = mi.sample_tea_32(slot, dr.opaque(mi.UInt32, self.job.seed))[0]
        return (
            pixel,
            slot % batches,
            PathNumbers(self.sequence, key, index, mi.UInt32(0)),
        )

    def _ray(self, place):
        pixel, batch, numbers = self._numbers(place)
        x, y = numbers.sobol(DIRECTION_U), numbers.sobol(DIRECTION_V)
        ray, valid = self.rays.through(pixel, x, y)
        return pixel, batch, numbers, ray, valid

    def _visible(self) -> _Visible:
        model = self.window.inside
        with launching():
            _, _, _, ray, valid = self._ray(dr.arange(mi.UInt32, self.points))
            hit = model.scene.ray_intersect_preliminary(ray, active=valid)
            shape = dr.reinterpret_array(mi.UInt32, hit.shape)
            met = valid & hit.is_valid()
            flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, met)
            role = dr.gather(mi.UInt32, model.window_of_shape, shape, met)
            point, normal, found = first_hit(model, ray, valid)
            # Surfaces that transmit and scatter are traced for all suns
            both = met & ~only_reflects(flags)
            both &= mi.has_flag(flags, mi.BSDFFlags.Smooth)
            seen = _Visible(point, normal, both, (found & (role == 0)) | both)
            dr.eval(seen.point, seen.normal, seen.both, seen.valid)
        return seen

    def _lit(
        self, first: int, count: int, suns: Float[np.ndarray, "step 3"]
    ) -> UInt32[np.ndarray, " pair"]:
        # Pairs (point × suns + sun) for which the line to the sun crosses the window
        seen, width = self.visible, dr.opaque(mi.UInt32, len(suns))
        with launching():
            pair = dr.arange(mi.UInt32, count * len(suns))
            place = pair // width + dr.opaque(mi.UInt32, first)
            sun = dr.gather(mi.Vector3f, vectors(mi.Vector3f, suns), pair % width)
            point = dr.gather(mi.Point3f, seen.point, place)
            facing = dr.dot(dr.gather(mi.Vector3f, seen.normal, place), sun)
            corner, normal, across, upwards = (
                vectors(mi.Vector3f, each[None])
                for each in (self.corner, self.normal, *self.edges)
            )
            away = dr.dot(normal, sun)
            distance = dr.dot(mi.Vector3f(corner - point), normal) / away
            offset = mi.Vector3f(point + sun * distance - corner)
            inside = (away < 0) & (distance > 0)
            for edge in (across, upwards):
                length2 = dr.squared_norm(edge)
                slack = (distance * _MARGIN / dr.abs(away)) * dr.rsqrt(length2) + 1e-3
                share = dr.dot(offset, edge) / length2
                inside &= (share > -slack) & (share < 1 + slack)
            inside &= facing > -_MARGIN
            inside |= dr.gather(mi.Bool, seen.both, place)
            inside &= dr.gather(mi.Bool, seen.valid, place)
            return np.asarray(dr.compress(inside).numpy())

    def _trace(self, total, share, found, first, suns, irradiance, width) -> None:
        with launching():
            pair = on_device(mi.UInt32, found)
            step = pair % dr.opaque(mi.UInt32, len(suns))
            place = pair // dr.opaque(mi.UInt32, len(suns)) + dr.opaque(
                mi.UInt32, first
            )
            pixel, batch, numbers, ray, valid = self._ray(place)
            a, b = numbers.sobol(CONNECT_U), numbers.sobol(CONNECT_V)
            middle = dr.gather(mi.Vector3f, vectors(mi.Vector3f, suns), step)
            tracer = PathTracer(
                self.tracer.model, (self.window.lit_by(middle, a, b),), 1.0,
                direct_only=True,
            )  # fmt: skip
            path = tracer.camera_path(ray)
            light = tracer.trace(RadianceSink(), path, numbers, 1, valid)
            light *= (
                dr.gather(mi.Float, on_device(mi.Float, irradiance), step) / _POINTS
            )
            at = pixel * dr.opaque(mi.UInt32, width) + step
            _add(total, share, light, at, batch)

    def _disc(self, total, share, suns, irradiance, width) -> None:
        # Points of the solar disc seen through the window, each in its pixel
        job, view = self.job, self.job.view
        toward = solar_disc(suns, _DISC)
        where = view.pixel(toward, columns=job.columns, rows=job.rows)
        row, column = (
            np.floor(np.nan_to_num(where, nan=-1)).astype(int).reshape(-1, 2).T
        )
        seen = (row >= 0) & (row < job.rows) & (column >= 0) & (column < job.columns)
        point, step = np.divmod(np.flatnonzero(seen), len(suns))
        if not len(point):
            return
        row, column = row[seen], column[seen]
        angle = self.angles[row, column]
        strength = irradiance[step] * job.batches / _DISC
        strength = np.where(angle > 0, strength / np.maximum(angle, 1e-12), 0)
        with launching():
            pixel = on_device(mi.UInt32, row * job.columns + column)
            direction = vectors(mi.Vector3f, toward[point, step])
            light = self.window.straight_to_eye(
                dr.gather(mi.Point3f, self.rays.origin, pixel), direction
            )
            light *= on_device(mi.Float, strength)
            place = pixel * dr.opaque(mi.UInt32, width) + on_device(mi.UInt32, step)
            batch = on_device(mi.UInt32, point % job.batches)
            _add(total, share, light, place, batch)


def _add(total, share, light, place, batch) -> None:
    # Add the weighted light to the sums by batch and output
    for number, outputs in enumerate(total):
        for output, weights in enumerate(share):
            value = mi.Float(0)
            for channel, weight in enumerate(weights.tolist()):
                value += light[channel] * dr.opaque(mi.Float, weight)
            dr.scatter_add(outputs[output], value, place, batch == number)
    dr.eval(total)
