"""Irradiance of the surfaces that rays meet, as rcontrib -i.

Rays that meet a receiver keep their radiance, as those to light sources in Radiance.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from clerestory.compat.ray_input import Table
from clerestory.engine.effort import Effort
from clerestory.phases.unscattered_light import first_surfaces
from clerestory.scene.model import Plastic, Scene
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

# Distance of sensors from the surfaces [m]
_ABOVE = 1e-4

# Number of rays in each block, and of paths along each ray without bounces
_BLOCK, _PATHS = 1 << 14, 8

Part = tuple[str | None, Table]


def by_surface(
    scene: Scene,
    bundles: RayBundles,
    windows: Sequence[Window],
    effort: Effort,
    irradiance: Callable[[Sensors, Effort], Iterator[Part]],
    radiance: Callable[[RayBundles, Effort], Iterator[Part]],
) -> Iterator[Part]:
    """Yield the mean irradiance of the surfaces that the rays of bundles meet.

    `irradiance` and `radiance` return the columns of each receiver for sensors and for
    rays; the latter are traced without bounces, and added for rays that meet a window
    or no surface.
    """
    blocks: list[list[Part]] = []
    every = max(1, _BLOCK // bundles.rays)
    straight = replace(effort, bounces=0, samples=_PATHS * bundles.rays)
    for first in range(0, len(bundles), every):
        own = bundles.select(slice(first, first + every))
        seen = list(radiance(own, straight))
        sensors, met = _surfaces(scene, own, windows)
        values = [(name, table.astype(np.float32)) for name, table in seen]
        if met.any():
            found = irradiance(sensors, effort)
            for (_, total), (_, part) in zip(values, found, strict=True):
                _add_means(total, part, met)
        blocks.append(values)
    for number, (name, _) in enumerate(blocks[0]):
        yield name, np.concatenate([block[number][1] for block in blocks], axis=1)


def _surfaces(
    scene: Scene, bundles: RayBundles, windows: Sequence[Window]
) -> tuple[Sensors, np.ndarray]:
    # Sensors on the surfaces that the rays meet, and whether each ray meets one
    given = np.flatnonzero(bundles.valid)
    origin, towards = (
        a.reshape(-1, 3)[given] for a in (bundles.origin, bundles.direction)
    )
    distance, normal = first_surfaces(scene, origin, towards)
    behind = np.full(len(origin), np.inf)
    if windows:
        panes = tuple(
            replace(polygon, material="pane")
            for window in windows
            for polygon in window.polygons
        )
        alone = Scene({"pane": Plastic("pane", np.zeros(3))}, panes)
        behind, _ = first_surfaces(alone, origin, towards)
    met = np.isfinite(distance) & (distance <= behind)
    facing = -np.sign(np.sum(normal * towards, axis=1, keepdims=True)) * normal
    place = origin[met] + distance[met, None] * towards[met] + _ABOVE * facing[met]
    of_ray = np.zeros(bundles.valid.shape, bool)
    of_ray.flat[given] = met
    return Sensors(place, facing[met]), of_ray


def _add_means(total: np.ndarray, part: np.ndarray, met: np.ndarray) -> None:
    # Add the mean over the rays of each bundle to its row
    bundle = np.nonzero(met)[0]
    share = (part / met.shape[1]).astype(np.float32)
    for channel in range(len(total)):
        np.add.at(total[channel], bundle, share[min(channel, len(part) - 1)])
