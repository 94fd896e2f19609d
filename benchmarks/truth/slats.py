"""Truth by the path tracer: geometry of slats and panes under the sun's disc."""

from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

import clerestory as cl
from clerestory.engine.controller import lengthen
from clerestory.engine.effort import Effort
from clerestory.engine.radiance_jobs import PICTURE_BATCHES, PictureJob
from clerestory.image.camera import Camera
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import Polygon, Scene, Trans
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window
from truth.facades import Kind
from truth.setting import demo

# Pixels within this angle of the sun take more paths [rad]
_AROUND = np.radians(1.5)


@dataclass(frozen=True)
class PixelPaths:
    """Paths of a pixel, and of one in which the sun, or an image of it, is seen."""

    usual: int
    sunny: int


class Slats:
    """The truth behind one system; without the sun, if it does not shine."""

    def __init__(self, kind: Kind, shines: bool = True):
        scene, window, _, _ = demo()
        self.room = scene + kind.geometry() + portal(window)
        self.shines = shines

    def illuminance(
        self,
        hours: cl.Weather,
        moment: datetime,
        sensors: Sensors,
        *,
        samples: int,
        seed: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Illuminance of sensors, and its standard error [lux]."""
        lit = self.room + self._light(hours, moment)
        found = irradiance(lit, sensors, samples=samples, seed=seed)
        return found.illuminance(), found.illuminance_error

    def picture(
        self,
        hours: cl.Weather,
        moment: datetime,
        camera: Camera,
        *,
        paths: PixelPaths,
        seed: int,
    ) -> np.ndarray:
        """Radiance of a camera's pixels by independent parts (part, pixel, channel)."""
        light = self._light(hours, moment)
        effort = Effort(samples=paths.usual, seed=seed)
        job = PictureJob(
            scene=self.room + light,
            view=camera.view,
            columns=camera.columns,
            rows=camera.rows,
            **effort.job_options(PICTURE_BATCHES),
        )
        numbers, sums = np.arange(len(camera)), job.empty_sums(len(camera))
        sunny = near_the_sun(light, camera)
        for some, samples in ((~sunny, paths.usual), (sunny, paths.sunny)):
            if some.any():
                lengthen(job, numbers, sums, some, samples // job.batches, effort)
        return np.moveaxis(sums.collected(), 1, 0)

    def _light(self, hours: cl.Weather, moment: datetime) -> Scene:
        light = cl.sky_at(hours, moment)
        kept = [each for each in light.distant if self.shines or each.angle_deg > 1]
        return replace(light, distant=tuple(kept))


def near_the_sun(light: Scene, camera: Camera) -> np.ndarray:
    """Return which pixels are near a sun, or its image in a level mirror."""
    suns = [source.direction for source in light.distant if source.angle_deg < 1]
    suns = [sun * [1, 1, side] for sun in suns for side in (1, -1)]
    rays = camera.view.rays(camera.columns, camera.rows)
    cosine = (rays.direction @ np.reshape(suns, (-1, 3)).T).max(axis=-1, initial=-1)
    return (rays.valid & (cosine > np.cos(_AROUND))).ravel()


def portal(window: Window) -> Scene:
    """Return a sheet that passes all light straight, so that rays know the window."""
    sheet = Trans("sheet", np.ones(3), 0.0, 0.0, 1.0, 1.0)
    panes = tuple(
        Polygon(pane.vertices + window.frame.normal * 0.002, "sheet", "pane")
        for pane in window.polygons
    )
    return Scene({"sheet": sheet}, panes)
