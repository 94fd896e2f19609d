"""A window in sunlight in one shade state: what does not depend on the receivers.

The radiance of the window is tabulated by exit cell and sun, the transmittance from the
sun to the window by zone and sun. All pixels, sensors and view points of a room share
the tables.
"""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from jaxtyping import Float, Float32

from clerestory.bsdf.bsdf import Bsdf
from clerestory.directions import Frame
from clerestory.engine import device as devices
from clerestory.engine.device import Device
from clerestory.phases.exit_cells import ExitCells, incident_cells
from clerestory.scene.model import Scene
from clerestory.scene.window import Window
from clerestory.scene.window_zones import WindowZones

# Number of points of a zone at which the transmittance from the sun is sampled
_ZONE_POINTS = 16


@dataclass(frozen=True, eq=False)
class SunlitWindow:
    """One of several windows, in one shade state, lit by suns.

    Attributes
    ----------
    number : index of the window among all windows
    peak : whether direct transmission is extracted from the BSDF
    scene : what shades the window outside, and the room
    """

    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    suns: Float[np.ndarray, "sun 3"]
    peak: bool
    scene: Scene
    device: Device

    @property
    def frame(self) -> Frame:
        """Frame of the window."""
        return self.windows[self.number].frame

    @cached_property
    def behind(self) -> np.ndarray:
        """Whether each sun is on the outer side of the window."""
        return np.asarray(self.suns @ self.frame.normal < 0)

    @cached_property
    def cells(self) -> ExitCells:
        """Exit cells of the BSDF."""
        return ExitCells.of(self.bsdf)

    def radiance(
        self, sun: np.ndarray, irradiance: Float[np.ndarray, " step"]
    ) -> Float32[np.ndarray, "channel cell step"]:
        """Return the radiance of the exit cells under suns of given irradiance."""
        light = self._table.radiance(self.cells.directions, self.suns[sun])
        light *= irradiance.astype(np.float32)
        return np.asarray(light)

    @cached_property
    def _table(self) -> Any:
        cells = partial(incident_cells, self.bsdf)
        engine: Any = self._engine("sun_tables")
        return engine.SunlitBsdf(self.bsdf, self.frame, peak=self.peak, cells=cells)

    @cached_property
    def transmittance(self) -> Float32[np.ndarray, "channel zone sun"]:
        """Transmittance from the suns to the zones of the window."""
        zones, polygons = WindowZones.of(self.windows), self.windows[self.number]
        points = zones.points(self.number, polygons.polygons, _ZONE_POINTS)
        engine: Any = self._engine("sun_tables")
        return np.asarray(
            engine.sun_transmittance(self.scene, points, self.frame.normal, self.suns)
        )

    @cached_property
    def unscattered(self) -> Any:
        """Unscattered beams of the BSDF."""
        return self._engine("sun_beams").UnscatteredBeams(self.bsdf, self.frame)

    def _engine(self, module: str) -> Any:
        return devices.load(self.device, module)
