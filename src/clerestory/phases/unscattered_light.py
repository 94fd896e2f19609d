"""Coefficients of unscattered light from sky and sun, in scenes with clear glass.

    C_d    sensors × sky   unscattered part of the daylight coefficients [sr]
    C_ds   sensors × suns  irradiance per direct normal irradiance

Straight rays are attenuated by clear glass and blocked by all other surfaces. C_d and
C_ds are for the direct correction of the two-phase method.
"""

from typing import Any, Unpack

import numpy as np
from jaxtyping import Bool, Float

from clerestory.constants import R2
from clerestory.engine import device as devices
from clerestory.engine.controller import estimate
from clerestory.engine.device import Device
from clerestory.engine.effort import Effort, EffortKeywords
from clerestory.engine.sums import BATCHES
from clerestory.engine.unscattered_jobs import UnscatteredJob
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sky_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import sun_effort
from clerestory.phases.traced_matrices import sensors_axis
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.sky.solar_disc import disc_points

# Default number of rays per sensor and sky patch, and per sensor and sun
_PATCH_SAMPLES, _SUN_SAMPLES = 32, 64


def unscattered_coefficients(
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Daylight coefficients C_d of unscattered light [sr]; zero for the ground.

    `samples` is the number of rays per sensor and sky patch.
    """
    effort = sun_effort(unscattered_coefficients, keywords, samples=_PATCH_SAMPLES)
    sky = reinhart(subdivision)
    directions = _in_patches(sky.dome, _points(len(sky.dome), effort))
    every = directions.shape[1] // BATCHES
    found = _traced(scene, sensors, directions, effort, pilot=every)
    # Irradiance per patch radiance; zero for the ground, which is patch 0
    angle = sky.dome.solid_angles()
    values, components = (
        np.insert(part * angle.astype(part.dtype), 0, 0, axis=-1) for part in found
    )
    axes = sensors_axis(sensors), sky_axis(sky)
    return TransferMatrix(values, *axes, components, scene.bands)


def unscattered_sun(
    scene: Scene,
    *,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients C_ds: irradiance per direct normal irradiance.

    `suns` are unit vectors, `samples` the number of rays per sensor and sun with a
    partly visible disc. Of other suns, 16 rays are traced. The solar disc has a
    diameter of 0.533°.
    """
    effort = sun_effort(unscattered_sun, keywords, samples=_SUN_SAMPLES)
    directions = disc_points(suns, _points(len(suns), effort))
    values, components = _traced(scene, sensors, directions, effort, pilot=1)
    axes = sensors_axis(sensors), sun_axis(len(suns))
    return TransferMatrix(values, *axes, components, scene.bands)


def sun_visible(
    scene: Scene,
    points: Float[np.ndarray, "point 3"],
    suns: Float[np.ndarray, "sun 3"],
    *,
    device: Device = "auto",
) -> Bool[np.ndarray, "point sun"]:
    """Return whether the centre of the solar disc is visible from each point.

    Clear glass and proxied geometry of a BSDF are transparent, all other surfaces are
    opaque. `suns` are unit vectors.
    """
    if not (len(points) and len(suns)):
        return np.zeros((len(points), len(suns)), dtype=bool)
    tracer: Any = devices.load(device, "direct_visibility")
    return np.asarray(tracer.direct_transmittance(scene, points, suns) > 0)


def first_surfaces(
    scene: Scene,
    origins: Float[np.ndarray, "ray 3"],
    directions: Float[np.ndarray, "ray 3"],
    *,
    device: Device = "auto",
) -> tuple[Float[np.ndarray, " ray"], Float[np.ndarray, "ray 3"]]:
    """Return distance [m] and unit normal of the first surface along each ray.

    The distance is infinite if there is none. Clear glass and proxied geometry of a
    BSDF are passed. `directions` are unit vectors.
    """
    if not (len(origins) and scene.surfaces):
        return np.full(len(origins), np.inf), np.zeros((len(origins), 3))
    tracer: Any = devices.load(device, "direct_visibility")
    distance, normal = tracer.first_surfaces(scene, origins, directions)
    return np.asarray(distance), np.asarray(normal)


def _traced(
    scene: Scene,
    sensors: Sensors,
    directions: Float[np.ndarray, "column point 3"],
    effort: Effort,
    *,
    pilot: int,
) -> tuple[np.ndarray, np.ndarray]:
    # Transmittance times cosine, averaged over the directions in each patch or sun
    job = UnscatteredJob(
        scene=scene,
        sensors=sensors,
        directions=directions,
        samples=directions.shape[1],
        pilot=pilot,
        **effort.job_options(),
    )
    found = estimate(job, effort)
    assert found.components is not None
    return found.values, found.components


def _points(columns: int, effort: Effort) -> Float[np.ndarray, "column point 2"]:
    # Points of the unit square, with one R2 sequence per batch
    each = -(-(effort.samples or 1) // BATCHES)
    start = np.random.default_rng(effort.seed).random((columns, BATCHES, 1, 2))
    steps = np.arange(each)[:, None] * R2
    return ((start + steps) % 1).reshape(columns, BATCHES * each, 2)


def _in_patches(
    dome: RingPartition, points: Float[np.ndarray, "patch point 2"]
) -> Float[np.ndarray, "patch point 3"]:
    # Directions uniform in solid angle, that is in z; `RingPartition.sample` is uniform
    # in z²
    ring = np.repeat(np.arange(len(dome.count)), dome.count)
    patch = np.broadcast_to(np.arange(len(dome))[:, None], points.shape[:2])
    first, last = (np.cos(dome.theta[ring + n])[:, None] for n in (0, 1))
    height = first + (last - first) * points[..., 0]
    share = (first**2 - height**2) / (first**2 - last**2)
    return dome.sample(patch, np.stack([share, points[..., 1]], axis=-1))
