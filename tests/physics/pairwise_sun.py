"""Sunlit pixels by the pairwise estimator: paths of their own for every pixel and sun.

It samples the window and the lobes of the BSDF for each sun, and shares no paths,
tables or zones with `clerestory.phases.window_paths`.
"""

import numpy as np

from clerestory.engine.direct_sun_jobs import PixelSunJob, trace_pixel_sun
from clerestory.engine.effort import Effort


def pairwise_sun(
    scene, windows, bsdf, camera, suns, *, number=0, peak=False, samples=512, seed=91,
    device="cpu",
):  # fmt: skip
    """Return the radiance (band, pixel, sun) per direct normal irradiance, and error.

    Of two batches, one is the mean plus the error, the other the mean minus the error.
    """
    effort = Effort(samples=samples, seed=seed, device=device)
    job = PixelSunJob(
        scene=scene,
        windows=tuple(windows),
        number=number,
        bsdf=bsdf,
        suns=suns,
        peak=peak,
        view=camera.view,
        columns=camera.columns,
        rows=camera.rows,
        samples=samples,
        **effort.job_options(2),
    )
    one, other = trace_pixel_sun(job, np.arange(len(suns)), effort)
    behind = suns @ windows[number].frame.normal < 0
    return (one + other) / 2 * behind, (one - other) / 2 * behind
