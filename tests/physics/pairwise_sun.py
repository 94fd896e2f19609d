"""Sunlit pixels by the pairwise estimator: paths of their own for every pixel and sun.

It samples the window and the lobes of the BSDF for each sun, and shares no paths,
tables or zones with `clerestory.phases.window_paths`.
"""

import importlib
from dataclasses import dataclass

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine.device import load, resolve
from clerestory.engine.work_units import Job, Unit
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Largest number of paths that are traced together
_LANES = 1 << 21


@dataclass(frozen=True, eq=False, kw_only=True)
class PixelSunJob(Job):
    """Radiance of columns × rows pixels per direct normal irradiance of suns [1/sr].

    Sunlight passes the window of index `number`; pairs have `samples` paths each.
    """

    windows: tuple[Window, ...]
    number: int
    bsdf: Bsdf
    suns: np.ndarray
    peak: bool
    samples: int
    view: View
    columns: int
    rows: int

    @property
    def points(self):
        return -(-self.samples // self.batches)

    @property
    def shape(self):
        pixels, bands = self.columns * self.rows, len(self.scene.bands)
        return pixels, self.batches, len(self.suns), bands

    def pilot_unit(self, paths):
        raise NotImplementedError


def pairwise_sun(
    scene, windows, bsdf, camera, suns, *, number=0, peak=False, samples=512, seed=91,
    device="cpu",
):  # fmt: skip
    """Return the radiance (band, pixel, sun) per direct normal irradiance, and error.

    Of two batches, one is the mean plus the error, the other the mean minus the error.
    """
    job = PixelSunJob(
        scene=scene, windows=tuple(windows), number=number, bsdf=bsdf, suns=suns,
        peak=peak, samples=samples, batches=2, seed=seed, device=resolve(device),
        view=camera.view, columns=camera.columns, rows=camera.rows,
    )  # fmt: skip
    one, other = _traced(job)
    behind = suns @ windows[number].frame.normal < 0
    return (one + other) / 2 * behind, (one - other) / 2 * behind


def _traced(job):
    # Radiance by batch, band, pixel and sun
    work_units = load(job.device, "work_units")
    prepare = importlib.import_module("pairwise_tracer").prepare_pixel_sun
    trace = work_units.tracer_of_bands(job, prepare)
    pixels, batches, suns, bands = job.shape
    values = np.zeros((batches, bands, pixels, suns), np.float32)
    lanes = batches * job.points
    every = max(1, min(suns, _LANES // lanes))
    block = max(1, _LANES // (lanes * every))
    for first in range(0, suns, every):
        sun = np.arange(first, min(first + every, suns))
        for start in range(0, pixels, block):
            row = np.arange(start, min(start + block, pixels))
            part = trace(Unit(row, 0, job.points, sun))
            values[:, :, row[:, None], sun] = part.transpose(1, 3, 0, 2)
    return values
