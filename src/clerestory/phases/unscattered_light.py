"""Coefficients of unscattered light from sky and sun, in scenes with clear glass.

    C_d    sensors × sky   unscattered part of the daylight coefficients [sr]
    C_ds   sensors × suns  irradiance per direct normal irradiance

Straight rays are attenuated by clear glass and blocked by all other surfaces. C_d and
C_ds are for the direct correction of the two-phase method.
"""

from collections.abc import Callable
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

# Probes of the solar disc: eight at 0.99 and four at half of its radius, as shares of
# the area within and angles in turns
_DEPTH = np.repeat([0.99**2, 0.5**2], [8, 4])
_ANGLE = np.concatenate([np.arange(8) / 8, np.arange(0.5, 4) / 4])


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
    found = _traced(_job(scene, sensors, directions, effort), effort)
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
    centre: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Direct-sun coefficients C_ds: irradiance per direct normal irradiance.

    `suns` are unit vectors, `samples` the number of rays per sensor and sun whose disc,
    of diameter 0.533°, is partly visible. Other discs are found by twelve rays, eight
    of them to the rim: up to 3 % of a disc that is taken as visible may be hidden by a
    straight edge, or conversely. Finer openings, as of perforated sheets, that are less
    than a tenth of the disc may be missed, and are better described by a BSDF. With
    `centre`, a sensor sees all of a disc or nothing, as it sees its centre.
    """
    job, effort = sun_job(unscattered_sun, scene, sensors, suns, keywords)
    if centre:
        middle = np.repeat(suns[:, None], job.samples, axis=1)
        job = _job(scene, sensors, middle, effort)
    values, components = _traced(job, effort)
    axes = sensors_axis(sensors), sun_axis(len(suns))
    return TransferMatrix(values, *axes, components, scene.bands)


def sun_job(
    function: Callable[..., object],
    scene: Scene,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    keywords: EffortKeywords,
) -> tuple[UnscatteredJob, Effort]:
    """Return the tracing job of `unscattered_sun`, and its effort.

    `keywords` are those of the public function `function`.
    """
    effort = sun_effort(function, keywords, samples=_SUN_SAMPLES)
    directions = disc_points(suns, _points(len(suns), effort))
    turn = np.random.default_rng(effort.seed).random((len(suns), 1))
    places = np.broadcast_to(_DEPTH, (len(suns), len(_DEPTH))), _ANGLE + turn
    probes = disc_points(suns, np.stack(places, axis=-1))
    return _job(scene, sensors, directions, effort, probes), effort


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


def _job(
    scene: Scene,
    sensors: Sensors,
    directions: Float[np.ndarray, "column point 3"],
    effort: Effort,
    probes: Float[np.ndarray, "column probe 3"] | None = None,
) -> UnscatteredJob:
    return UnscatteredJob(
        scene=scene,
        sensors=sensors,
        directions=directions,
        samples=directions.shape[1],
        probes=probes,
        **effort.job_options(),
    )


def _traced(job: UnscatteredJob, effort: Effort) -> tuple[np.ndarray, np.ndarray]:
    # Transmittance times cosine, averaged over the directions in each patch or sun
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
