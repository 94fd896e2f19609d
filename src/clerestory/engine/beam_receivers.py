"""Pixels and sensors as receivers of narrow beams of sunlight."""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.engine.camera_rays import camera_rays, sampled_ray
from clerestory.engine.lower import LoweredScene
from clerestory.engine.path_tracer import PathTracer
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.sinks import RadianceSink
from clerestory.engine.upload import vectors
from clerestory.engine.vertices import sensor_vertex
from clerestory.engine.visibility import first_hit, interaction, only_reflects
from clerestory.engine.window_path_jobs import PixelWindowPaths, SensorWindowPaths

# Largest number of sample points of a pixel or cell in a batch
_MOST = 8


@dataclass
class Visible:
    """Points that receive light.

    Attributes
    ----------
    both : whether light may arrive from either side
    valid : whether there is such a point
    lambertian : whether the light that is scattered to the receiver is proportional to
        the irradiance of the point
    factor : light of the receiver per irradiance of a Lambertian point
    """

    point: mi.Point3f
    normal: mi.Vector3f
    both: mi.Bool
    valid: mi.Bool
    lambertian: mi.Bool
    factor: mi.Color3f


@dataclass
class Places:
    """Sample points of receivers: row, batch and sample numbers."""

    row: mi.UInt32
    batch: mi.UInt32
    numbers: PathNumbers


class BeamSensors:
    """Sensors, with an eighth of the sample points of the paths."""

    def __init__(self, job: SensorWindowPaths):
        self.points = max(4, power_of_two(job.points // 8))
        self.origin = np.mean(job.sensors.position, axis=0)
        self.position = vectors(mi.Point3f, job.sensors.position - self.origin)
        self.normal = vectors(mi.Vector3f, job.sensors.direction)

    def visible(self, model: LoweredScene, places: Places) -> Visible:
        """Return the positions of the sensors."""
        point = dr.gather(mi.Point3f, self.position, places.row)
        normal = dr.gather(mi.Vector3f, self.normal, places.row)
        yes = dr.full(mi.Bool, True, dr.width(places.row))
        return Visible(point, normal, ~yes, yes, yes, mi.Color3f(yes & yes))

    def light(self, tracer: PathTracer, places: Places) -> mi.Color3f:
        """Return the irradiance of sensors."""
        point = dr.gather(mi.Point3f, self.position, places.row)
        normal = dr.gather(mi.Vector3f, self.normal, places.row)
        vertex, sink = sensor_vertex(None, point, normal), RadianceSink()
        return tracer.sample_sources(
            sink, sink.begin(), vertex, places.numbers, mi.Color3f(1)
        )


class BeamPixels:
    """Pixels or cells, with a quarter of the sample points of the paths, at most 8.

    More points are needed for reflected paths, not for the edges of sun patches.
    """

    def __init__(self, job: PixelWindowPaths):
        self.points = max(2, min(_MOST, power_of_two(job.points // 4)))
        self.origin = np.asarray(job.camera.position, dtype=float)
        self.rays = camera_rays(job.camera)

    def visible(self, model: LoweredScene, places: Places) -> Visible:
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
        even = dr.gather(mi.Bool, model.lambertian_of_shape, shape, met) & (role == 0)
        # BRDF: that of light along the normal
        si = interaction(hit, ray, even)
        upwards = mi.Vector3f(0, 0, dr.mulsign(mi.Float(1), si.wi.z))
        factor = si.bsdf().eval(mi.BSDFContext(), si, upwards, even)
        valid = (found & (role == 0)) | both
        return Visible(point, normal, both, valid, even, dr.select(even, factor, 0))

    def light(self, tracer: PathTracer, places: Places) -> mi.Color3f:
        """Return the radiance of pixels."""
        ray, valid = self._ray(places)
        path, sink = tracer.camera_path(ray), RadianceSink()
        return tracer.trace(sink, path, places.numbers, 1, valid)

    def _ray(self, places: Places):
        return sampled_ray(self.rays, places.row, places.numbers)


def power_of_two(count: int) -> int:
    """Return the least power of two that is not less than a number."""
    return 1 << max(0, count - 1).bit_length()
