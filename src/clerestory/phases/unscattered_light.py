"""Coefficients of unscattered light from sky and sun, in scenes with clear glass.

    C_d    sensors × sky   unscattered part of the daylight coefficients [sr]
    C_ds   sensors × suns  irradiance per direct normal irradiance

Straight rays are attenuated by clear glass and blocked by all other surfaces. C_d and
C_ds are for the direct correction of the two-phase method.
"""

from collections.abc import Callable
from dataclasses import replace
from math import ceil
from typing import Any, Unpack

import numpy as np
from jaxtyping import Bool, Float

from clerestory.constants import R2
from clerestory.engine import device as devices
from clerestory.engine.controller import estimate
from clerestory.engine.device import Device
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.sums import BATCHES
from clerestory.engine.unscattered_jobs import UnscatteredJob
from clerestory.engine.work_units import Goal
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sky_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import sun_effort
from clerestory.phases.traced_matrices import sensors_axis
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from clerestory.sky.solar_disc import GOLDEN_TURN, disc_points

# Default number of rays per sensor and sky patch, and per sensor and sun; largest
# number of rays per sensor and sun for a relative error
_PATCH_SAMPLES, _SUN_SAMPLES, _MOST_SAMPLES = 32, 64, 1024

# Probes of the solar disc: at 0.99 of its radius, and at independent random points
_RIM, _INSIDE = 6, 4
_RIM_RADIUS = 0.99

# Standard error of the visible share of half a disc by one batch of n sample points:
# _SPREAD n^-3/4 of the share, measured for straight edges
_SPREAD = 0.6


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
    of diameter 0.533°, is partly visible. With `relative_error`, it is the number for
    this standard error of half a disc at a straight edge, at most 1024. Partly visible
    discs are found by six rays to the rim. Other discs are estimated by four random
    rays, without bias: where they differ, as behind perforated sheets with holes finer
    than the disc, the standard error is that of four rays. With `centre`, a sensor sees
    all of a disc or nothing, as it sees its centre.
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
    *,
    batches: int = BATCHES,
) -> tuple[UnscatteredJob, Effort]:
    """Return the tracing job of `unscattered_sun`, and its effort.

    `keywords` are those of the public function `function`.
    """
    effort = effort_of(
        function, keywords, default=Goal(_SUN_SAMPLES), most_samples=1 << 20,
        without=("bounces", "batches", "components"),
    )  # fmt: skip
    each = -(-(effort.samples or _MOST_SAMPLES) // batches)
    if effort.relative_error is not None:
        enough = ceil((_SPREAD / effort.relative_error / batches**0.5) ** (4 / 3))
        each = min(each, enough)
    effort = replace(effort, samples=batches * each, relative_error=None)
    rng, count = np.random.default_rng(effort.seed), len(suns)
    places = _spiral(rng.random((count, batches, 1, 2)), each)
    directions = disc_points(suns, places.reshape(count, -1, 2))
    angle = np.arange(_RIM) / _RIM + rng.random((count, 1))
    rim = np.stack([np.full_like(angle, _RIM_RADIUS**2), angle], axis=-1)
    places = np.concatenate([rim, rng.random((count, _INSIDE, 2))], axis=1)
    job = _job(scene, sensors, directions, effort)
    probes = disc_points(suns, places)
    return replace(job, probes=probes, inside=_INSIDE, batches=batches), effort


def _spiral(
    start: Float[np.ndarray, "sun batch 1 2"], count: int
) -> Float[np.ndarray, "sun batch point 2"]:
    # Places of points of a disc that are evenly spread, and each uniform: on a spiral
    # by the golden angle, with a random start
    number = np.arange(count)[:, None]
    share = (start[..., :1] + number) / count
    angle = start[..., 1:] + number * GOLDEN_TURN
    return np.concatenate([share, angle], axis=-1)


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
) -> UnscatteredJob:
    return UnscatteredJob(
        scene=scene,
        sensors=sensors,
        directions=directions,
        samples=directions.shape[1],
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
