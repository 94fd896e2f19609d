"""A window in sunlight in one shade state: what does not depend on the receivers.

The radiance of the window is tabulated by exit cell and sun, the transmittance from the
sun to the window by zone and sun. All pixels, sensors and view points of a room share
the tables.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float, Float32, Int

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

# Largest memory for the radiance of a window under all suns, to be kept [bytes]
_KEPT = 1 << 26

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
        channels, count = len(self.scene.bands), len(self.cells.sizes)
        if 4 * channels * count * len(self.suns) > _KEPT:
            light = self._lit_by(sun)
        else:
            known = self._known
            known.add(known.missing(sun), self._lit_by)
            light = known.of(sun)
        return np.asarray(light * irradiance.astype(np.float32))

    @cached_property
    def _known(self) -> "_KnownSuns":
        return _KnownSuns(np.full(len(self.suns), -1))

    def _lit_by(
        self, sun: Int[np.ndarray, " some"]
    ) -> Float32[np.ndarray, "channel cell some"]:
        # Radiance per direct normal irradiance
        where = self.cells.directions, self.suns[sun]
        light = [table.radiance(*where) for table in self._tables]
        if len(light) > 1:
            whole = [np.broadcast_to(one, (len(RGB), *one.shape[1:])) for one in light]
            light = [np.concatenate(whole)[: len(self.scene.bands)]]
        return np.asarray(light[0])

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


@dataclass(eq=False)
class _KnownSuns:
    # Radiance of the exit cells under the suns that were asked for so far: all view
    # points ask for the same suns
    column: Int[np.ndarray, " sun"]
    light: Float32[np.ndarray, "channel cell known"] | None = None

    def missing(self, sun: Int[np.ndarray, " some"]) -> Int[np.ndarray, " new"]:
        return np.unique(sun[self.column[sun] < 0])

    def add(self, new: Int[np.ndarray, " new"], make: "_Make") -> None:
        if not len(new):
            return
        parts = [make(new)]
        known = 0
        if self.light is not None:
            known = self.light.shape[2]
            parts.insert(0, self.light)
        # Light of few suns may be grey by chance
        channels = max(len(part) for part in parts)
        wide = [np.broadcast_to(p, (channels, *p.shape[1:])) for p in parts]
        self.light = np.concatenate(wide, axis=2)
        self.column[new] = known + np.arange(len(new))

    def of(
        self, sun: Int[np.ndarray, " some"]
    ) -> Float32[np.ndarray, "channel cell some"]:
        assert self.light is not None
        return self.light[:, :, self.column[sun]]


_Make = Callable[[Int[np.ndarray, " some"]], Float32[np.ndarray, "channel cell some"]]


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
