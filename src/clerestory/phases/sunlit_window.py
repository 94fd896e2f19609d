"""A window in sunlight in one shade state: what does not depend on the receivers.

The radiance of the window is tabulated by exit cell and sun, the transmittance from the
sun to the window by zone and sun. All pixels, sensors and view points of a room share
the tables.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float, Float32

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.spectral_channels import band_groups_of
from clerestory.directions import Frame
from clerestory.engine import device as devices
from clerestory.engine.device import Device
from clerestory.phases.exit_cells import ExitCells, IncidentCells
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
        where = self.cells.directions, self.suns[sun]
        light = [table.radiance(*where) for table in self._tables]
        if len(light) > 1:
            whole = [np.broadcast_to(one, (len(RGB), *one.shape[1:])) for one in light]
            light = [np.concatenate(whole)[: len(self.scene.bands)]]
        return np.asarray(light[0] * irradiance.astype(np.float32))

    @cached_property
    def _tables(self) -> list[Any]:
        # One for each group of three bands, or one if the BSDF is the same in all
        cells = IncidentCells.of(self.bsdf).find
        engine: Any = self._engine("sun_tables")
        return [
            engine.SunlitBsdf(part, self.frame, peak=self.peak, cells=cells)
            for part in band_groups_of(self.bsdf, self.scene.bands)
        ]

    @cached_property
    def transmittance(self) -> Float32[np.ndarray, "channel zone sun"]:
        """Transmittance from the suns to the zones of the window."""
        where = self.scene, self.windows, self.number
        return _transmittance(
            *where, np.asarray(self.suns, float).tobytes(), self.device
        )

    @cached_property
    def unscattered(self) -> Any:
        """Unscattered beams of the BSDF."""
        return self._engine("sun_beams").UnscatteredBeams(
            self.bsdf, self.frame, self.scene.bands
        )

    def _engine(self, module: str) -> Any:
        return devices.load(self.device, module)


@lru_cache(maxsize=4)
def _transmittance(
    scene: Scene, windows: tuple[Window, ...], number: int, suns: bytes, device: Device
) -> Float32[np.ndarray, "channel zone sun"]:
    # The same for all shade states without exterior shades
    window = windows[number]
    zones = WindowZones.of(windows).points(number, window.polygons, _ZONE_POINTS)
    engine: Any = devices.load(device, "sun_tables")
    directions = np.frombuffer(suns).reshape(-1, 3)
    found = engine.sun_transmittance(scene, zones, window.frame.normal, directions)
    return np.asarray(found)
