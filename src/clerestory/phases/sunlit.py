"""Product of recorded paths to a window and its radiance in sunlight: C_ds S_sun.

The radiance of the window is tabulated by exit cell and time step, the transmittance
from the sun to the window by zone and sun. Narrow beams of light, which the paths would
miss, are traced for the suns in question.
"""

import itertools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float, Float32
from scipy.sparse import csc_array

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.spectral_channels import has_bands
from clerestory.checks import require
from clerestory.engine.device import Device
from clerestory.phases.direct_light import window_number
from clerestory.phases.kept_beams import KeptBeams
from clerestory.phases.received_sunlight import ReceivedSunlight
from clerestory.phases.sunlit_window import SunlitWindow
from clerestory.phases.window_paths import WindowPaths
from clerestory.scene.model import Scene

# Suns per block of C_ds
_SUNS = 64


@dataclass(frozen=True, eq=False)
class SunlitReceivers:
    """Pixels or sensors in sunlight transmitted by one window in one shade state.

    C_ds of a pixel is its radiance per direct normal irradiance [1/sr], C_F-ds + C_R-ds
    in the notation of the extended five-phase method; of a sensor, its irradiance.
    """

    paths: WindowPaths
    window: SunlitWindow
    _last: dict[tuple[bytes, ...], ReceivedSunlight] = field(default_factory=dict)
    _kept: dict[bytes, KeptBeams] = field(default_factory=dict)

    def of(self, paths: WindowPaths) -> "SunlitReceivers":
        """Return other receivers in the light of the same window."""
        return SunlitReceivers(paths, self.window)

    def keep_beams(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> None:
        """Trace the narrow beams of all suns in `normal`, and keep their light.

        This is faster than tracing them block by block, and for each product again.
        """
        job, window = self.paths.job, self.window
        shape = job.batches, len(weights), job.receivers
        key, none = weights.tobytes(), np.full(len(window.suns), -1)
        suns = normal.tocoo().coords[0]
        suns = suns[window.behind[suns]]
        kept = self._kept.setdefault(key, KeptBeams(shape, none))
        suns = kept.missing(suns)
        if not (len(suns) and self.paths.traced):
            return
        ones = np.ones(len(suns))
        light = window.radiance(suns, ones)
        beams = self._beams(light, window.suns[suns], ones)
        parts = (self._beam_tracer.light(weights, each) for each in beams)
        kept.keep(suns, itertools.chain.from_iterable(parts))

    def received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> ReceivedSunlight:
        """Return the radiance under suns, weighted by band.

        `normal` is the direct normal irradiance (sun × step), of at most one sun per
        step.
        """
        # Pixels and blocks of pixels ask for the same product, one after the other
        parts = normal.indptr, normal.indices, normal.data, weights
        key = tuple(part.tobytes() for part in parts)
        if key not in self._last:
            self._last.clear()
            self._last[key] = self._received(normal, weights)
        return self._last[key]

    def _received(
        self, normal: csc_array, weights: Float[np.ndarray, "out band"]
    ) -> ReceivedSunlight:
        steps, pixels = normal.shape[1], self.paths.job.receivers
        sun = np.full(steps, -1)
        coordinates = normal.tocoo()
        sun[coordinates.coords[1]] = coordinates.coords[0]
        lit = np.flatnonzero(sun >= 0)
        lit = lit[self.window.behind[sun[lit]]]
        if len(lit) == 0 or not self.paths.traced:
            none = np.zeros((2, len(weights), pixels, 0), np.float32)
            return ReceivedSunlight(lit[:0], none)
        irradiance = np.asarray(normal.sum(axis=0)).ravel()[lit]
        found = self._batches(sun[lit], irradiance, weights)
        return ReceivedSunlight(lit, found[..., : len(lit)])

    def _batches(
        self,
        sun: np.ndarray,
        irradiance: np.ndarray,
        weights: Float[np.ndarray, "out band"],
    ) -> Float32[np.ndarray, "batch out pixel step"]:
        job = self.paths.job
        engine: Any = self.paths.engine("path_product")
        window, cells = self.window, self.window.cells
        product = self.paths.product(window.number, cells)
        width = engine.padded(len(sun))
        extra = [(0, 0), (0, 0), (0, width - len(sun))]
        radiance = window.radiance(sun, irradiance)
        both = self._spread(radiance), radiance
        light = np.pad(np.concatenate(both, axis=1), extra)
        passed = np.pad(window.transmittance[..., sun], extra)
        sums = [self._sum(product, row, light, passed) for row in weights]
        kept = self._kept.get(weights.tobytes())
        if kept is not None and len(kept.missing(sun)):
            kept = None
        beams: list[Any] = []
        if kept is None:
            beams = self._beams(radiance, window.suns[sun], irradiance)
        for each in beams:
            self._beam_tracer.add_lambertian(sums, width, weights, each)
        shape = job.batches, job.receivers, width
        parts = [each.numpy().reshape(shape) for each in sums]
        found = np.stack(parts, axis=1) if len(parts) > 1 else parts[0][:, None]
        if kept is not None:
            kept.add(found, sun, irradiance)
        for each in beams:
            self._beam_tracer.add(found, weights, each)
        return found

    def _sum(
        self,
        product: Any,
        weights: Float[np.ndarray, " band"],
        light: Float32[np.ndarray, "channel cell step"],
        passed: Float32[np.ndarray, "outside zone step"],
    ) -> Any:
        # Scattered sunlight by batch, pixel and step, on the compute device
        channels = len(self.paths.records[0].weights)
        if len(light) == len(passed) == 1:
            share = weights if channels > 1 else weights.sum(keepdims=True)
            return product.received(share, light[0], passed[0])
        total = 0.0
        for band, weight in enumerate(weights):
            if weight:
                share = np.zeros(channels)
                share[band % channels] = weight
                radiance, zones = light[band % len(light)], passed[band % len(passed)]
                total = product.received(share, radiance, zones) + total
        return total

    def _spread(
        self, light: Float32[np.ndarray, "channel cell step"]
    ) -> Float32[np.ndarray, "channel cell step"]:
        # Radiance for light reflected by pixels, without narrow beams
        engine: Any = self.paths.engine("sun_beams")
        narrow = engine.narrow_cells(light, self.window.cells.sizes)
        return np.where(narrow, 0, light) if narrow.any() else light

    def _beams(
        self,
        light: Float32[np.ndarray, "channel cell step"],
        suns: Float[np.ndarray, "step 3"],
        irradiance: Float[np.ndarray, " step"],
    ) -> list[Any]:
        # Narrow beams: those of bright cells, and unscattered light
        engine: Any = self.paths.engine("sun_beams")
        frame, cells, found = self.window.frame, self.window.cells, []
        count, job = self._beam_tracer.beams, self.paths.job
        how = {"count": count, "batches": job.batches, "seed": job.seed}
        narrow = engine.narrow_cells(light, cells.sizes)
        if narrow.any():
            bright = np.where(narrow, light, 0)
            rest = cells.sizes, cells.sample, suns, frame
            found.append(engine.narrow_beams(bright, *rest, **how))
        if self.window.peak:
            unscattered = self.window.unscattered
            found.append(unscattered.of(suns, irradiance, **how))
        return found

    @property
    def _beam_tracer(self) -> Any:
        return self.paths.beam_tracer(self.window.number, self.window.scene)

    def disc(
        self, weights: Float[np.ndarray, "out band"]
    ) -> tuple[Float[np.ndarray, "out sun"], Float[np.ndarray, " sun"]]:
        """Return the irradiance from the discs of the suns, seen at a point.

        The point is that of cells of the sphere. The irradiance perpendicular to the
        light, weighted by band, is per direct normal irradiance; the second value is
        the visible share of each disc.
        """
        window, suns = self.window, self.window.suns
        flux, share = np.zeros((len(weights), len(suns))), np.zeros(len(suns))
        lit = np.flatnonzero(self.window.behind)
        if not (window.peak and self.paths.traced and len(lit)):
            return flux, share
        count = self._beam_tracer.beams
        beams = window.unscattered.of(suns[lit], np.ones(len(lit)), count)
        if len(beams.steps):
            some = lit[beams.steps]
            flux[:, some], share[some] = self._beam_tracer.disc(weights, beams)
        return flux, share

    def coefficients(
        self, bands: int
    ) -> tuple[
        Float32[np.ndarray, "band row sun"],
        Float32[np.ndarray, "component band row sun"],
    ]:
        """Return C_ds and its error components, in one band or in all of the scene."""
        job, weights = self.paths.job, np.eye(bands)
        shape = job.batches, bands, job.receivers, len(self.window.suns)
        found = np.zeros(shape, np.float32)
        lit = np.flatnonzero(self.window.behind)
        for first in range(0, len(lit) * self.paths.traced, _SUNS):
            sun = lit[first : first + _SUNS]
            part = self._batches(sun, np.ones(len(sun)), weights)
            found[..., sun] = part[..., : len(sun)]
        mean = found.mean(axis=0)
        found -= mean
        return mean, found / np.float32(np.sqrt(job.batches * (job.batches - 1)))


def in_sunlight(
    paths: WindowPaths,
    window: str,
    bsdf: Bsdf,
    *,
    suns: Float[np.ndarray, "sun 3"],
    peak: bool = False,
    scene: Scene | None = None,
) -> SunlitReceivers:
    """Return the pixels or sensors in sunlight from one window, in one shade state.

    `scene`, by default that of the paths, contains what shades the window outside.
    """
    number = window_number(paths.job.windows, window, bsdf, suns)
    bands = paths.job.scene.bands
    require(
        bands == RGB
        or has_bands(bsdf, bands)
        or not bsdf.in_colour("transmission_front"),
        f"the BSDF is in {RGB}, the scene in {bands}; a BSDF that is the same in"
        " all bands expected",
        file=bsdf.source,
    )
    job = paths.job
    device: Device = "cpu" if job.device == "cpu" else "auto"
    lit = SunlitWindow(
        job.windows, number, bsdf, suns, peak, scene or job.scene, device
    )
    return SunlitReceivers(paths, lit)
