"""Direct light of scenes that have their glass: sky and sun, unscattered.

    C_d    sensors × sky   part of the daylight coefficients that no surface scatters
    C_sun  sensors × suns  irradiance per direct normal irradiance

Both follow straight rays that clear glass attenuates and all else stops, so that the
two-phase method can take the sun out of its sky patches and put it at its place.
"""

from typing import TypedDict, Unpack

import numpy as np
from jaxtyping import Float

from clerestory.constants import SUN_DIAMETER
from clerestory.engine.device import Device
from clerestory.engine.direct_sun_jobs import BATCHES, UnscatteredJob, trace_sun
from clerestory.engine.work_units import Executor, Local
from clerestory.hemisphere.reinhart import SkyPartition, reinhart
from clerestory.matrix.axis import Axis, sensor_axis, sky_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.progress import Progress
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors

# Steps of the R2 sequence (M. Roberts, 2018): powers of the inverse plastic number
_R2 = 1.32471795724474602596 ** -np.arange(1.0, 3.0)


class Straight(TypedDict, total=False):
    """Keywords of both functions; see `view_matrix` for what they mean."""

    seed: int
    device: Device
    executor: Executor | None
    progress: Progress | None


def unscattered_coefficients(
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    samples: int = 32,
    **tracing: Unpack[Straight],
) -> TransferMatrix:
    """Direct part C_d of the daylight coefficients [sr]; the ground has none.

    Parameters
    ----------
    scene : with its glass
    subdivision : Reinhart's MF of the sky, 1…6
    samples : rays per sensor and sky patch
    """
    sky = reinhart(subdivision)
    points = _points(len(sky.dome), samples, tracing.get("seed", 0))
    return _traced(scene, sensors, _in_patches(sky, points), sky_axis(sky), tracing)


def unscattered_sun(
    scene: Scene,
    *,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    samples: int = 64,
    **tracing: Unpack[Straight],
) -> TransferMatrix:
    """Direct-sun coefficients C_sun: irradiance per direct normal irradiance.

    Parameters
    ----------
    scene : with its glass
    suns : unit vectors to the suns, whose discs are 0.533° wide
    samples : rays per sensor and sun
    """
    points = _points(len(suns), samples, tracing.get("seed", 0))
    directions = _on_discs(suns, points)
    return _traced(scene, sensors, directions, sun_axis(len(suns)), tracing)


def _traced(
    scene: Scene,
    sensors: Sensors,
    directions: Float[np.ndarray, "column point 3"],
    columns: Axis,
    tracing: Straight,
) -> TransferMatrix:
    executor = tracing.get("executor") or Local()
    device = executor.resolve(tracing.get("device", "auto"))
    job = UnscatteredJob(scene, sensors, directions, device)
    found = trace_sun(job, executor=executor, progress=tracing.get("progress"))
    rows = sensor_axis(len(sensors.position), sensors.names)
    values, components = found.values, found.components
    if columns.kind == "sky" and isinstance(columns.partition, SkyPartition):
        # Irradiance per radiance; nothing from the ground
        angle = columns.partition.dome.solid_angles()
        values, components = (
            _after_ground(values * angle),
            _after_ground(components * angle.astype(np.float32)),
        )
    return TransferMatrix(values, rows, columns, components, scene.bands)


def _after_ground(values: np.ndarray) -> np.ndarray:
    return np.concatenate([np.zeros_like(values[..., :1]), values], axis=-1)


def _points(
    columns: int, samples: int, seed: int
) -> Float[np.ndarray, "column point 2"]:
    # Points of the unit square; each batch has a sequence of its own
    each = max(1, -(-samples // BATCHES))
    start = np.random.default_rng(seed).random((columns, BATCHES, 1, 2))
    steps = np.arange(each)[:, None] * _R2
    return ((start + steps) % 1).reshape(columns, BATCHES * each, 2)


def _in_patches(
    sky: SkyPartition, points: Float[np.ndarray, "patch point 2"]
) -> Float[np.ndarray, "patch point 3"]:
    # Uniform in solid angle: heights are uniform, where `sample` takes their squares
    dome = sky.dome
    ring = np.repeat(np.arange(len(dome.count)), dome.count)
    patch = np.broadcast_to(np.arange(len(dome))[:, None], points.shape[:2])
    first, last = (np.cos(dome.theta[ring + n])[:, None] for n in (0, 1))
    height = first + (last - first) * points[..., 0]
    share = (first**2 - height**2) / (first**2 - last**2)
    return dome.sample(patch, np.stack([share, points[..., 1]], axis=-1))


def _on_discs(
    suns: Float[np.ndarray, "sun 3"], points: Float[np.ndarray, "sun point 2"]
) -> Float[np.ndarray, "sun point 3"]:
    # Uniform on the disc of each sun
    depth = points[..., 0] * (1 - np.cos(SUN_DIAMETER / 2))
    flat = np.sqrt(depth * (2 - depth))
    side = np.cross(suns, np.eye(3)[np.abs(suns).argmin(axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    across = np.cross(suns, side)
    angle = 2 * np.pi * points[..., 1]
    return np.asarray(
        suns[:, None] * (1 - depth)[..., None]
        + side[:, None] * (flat * np.cos(angle))[..., None]
        + across[:, None] * (flat * np.sin(angle))[..., None]
    )
