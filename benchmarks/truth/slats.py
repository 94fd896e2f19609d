"""Truth behind slats: path tracing of their geometry under the sun's disc."""

from datetime import datetime

import numpy as np

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import Polygon, Scene, Trans
from clerestory.scene.window import Window
from truth.setting import Kind, cameras, demo


class Slats:
    """The truth behind one system."""

    def __init__(self, kind: Kind):
        scene, window, self.sensors, _ = demo()
        self.room = scene + kind.geometry() + portal(window)

    def illuminance(
        self, hours: cl.Weather, moment: datetime, *, samples: int, seed: int
    ) -> np.ndarray:
        """Illuminance of the sensors [lux]."""
        lit = self.room + cl.sky_at(hours, moment)
        return irradiance(lit, self.sensors, samples=samples, seed=seed).illuminance()

    def pictures(
        self, hours: cl.Weather, moment: datetime, *, samples: int, seed: int
    ) -> list[np.ndarray]:
        """Radiance of the pixels of each eye's picture (pixel, channel)."""
        lit = self.room + cl.sky_at(hours, moment)
        made = [
            cl.render(
                lit, camera.view, columns=camera.columns, rows=camera.rows,
                samples=samples, seed=seed + number,
            )
            for number, camera in enumerate(cameras())
        ]  # fmt: skip
        return [each.picture.radiance.reshape(-1, 3) for each in made]


def portal(window: Window) -> Scene:
    """Return a sheet that passes all light straight, so that rays know the window."""
    sheet = Trans("sheet", np.ones(3), 0.0, 0.0, 1.0, 1.0)
    panes = tuple(
        Polygon(pane.vertices + window.frame.normal * 0.002, "sheet", "pane")
        for pane in window.polygons
    )
    return Scene({"sheet": sheet}, panes)
