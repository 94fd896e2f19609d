"""Radiance of pixels and cells by the two-phase method, with the sun exact.

    C      pixels × sky patches   all light               sky_view_matrices
    C_d    pixels × sky patches   direct light            sky_view_matrices
    C_ds   pixels × suns          direct sunlight [1/sr]  sun_view_coefficients

The glazing is part of the scene: clear or scattering panes, mirrors and glossy façades
keep their materials. Direct light is scattered once, by the first surface that is seen,
or never. With the terms of the two-phase method, I = C S − C_d S_ds + C_ds S_sun, the
direct sun is thus sharp: on visible surfaces, in glossy reflections, and behind
scattering glass. C_ds does not contain the disc of the sun itself (`sun_disc`).
"""

import math
from dataclasses import replace
from typing import Any, Unpack

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.checks import has_shape
from clerestory.engine import device as devices
from clerestory.engine.controller import estimate
from clerestory.engine.device import Device
from clerestory.engine.effort import EffortKeywords
from clerestory.engine.sky_view_jobs import SkyViewJob, SunViewJob, trace_sun_view
from clerestory.hemisphere.reinhart import reinhart
from clerestory.image.camera import PixelsOrCells
from clerestory.matrix.axis import pixel_axis, sun_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import sun_effort
from clerestory.phases.separate_coefficients import all_and_direct
from clerestory.phases.traced_matrices import matrix_effort, warn_if_short
from clerestory.scene.model import Scene

# Number of batches of paths per pixel: half of their difference is the error
_BATCHES = 2

# Default number of paths per pixel and sun
SUN_SAMPLES = 4

# Points of the solar disc that are tested for visibility
_DISC = 64


def sky_view_matrices(
    scene: Scene,
    camera: PixelsOrCells,
    *,
    subdivision: int = 4,
    **keywords: Unpack[EffortKeywords],
) -> tuple[TransferMatrix, TransferMatrix]:
    """Return C and C_d: radiance of pixels per radiance of sky patches.

    C_d is the part of C due to direct light, from the same paths, so that the error of
    C_d largely cancels in C S − C_d S_ds. A row of C sums to one for a pixel that sees
    sky and ground alone.

    Parameters
    ----------
    scene : the room, its glazing and what surrounds it
    camera : pixels of a picture, or cells of the sphere
    samples : number of paths per pixel
    relative_error : instead of samples: target RMS of the pixels' standard errors under
        a uniform sky, relative to the mean pixel radiance

    See `view_matrix` for the other parameters.
    """
    effort = matrix_effort(sky_view_matrices, keywords)
    sky = reinhart(subdivision)
    options = effort.job_options(_BATCHES)
    job = SkyViewJob(scene=scene, camera=camera, sky=sky, **options)
    estimated = estimate(job, replace(effort, components=True))
    warn_if_short(estimated, "daylight coefficients of the view", effort)
    assert estimated.components is not None
    # The two components are opposite; one of them is the error
    found = replace(
        estimated,
        values=estimated.values.astype(np.float32),
        components=estimated.components[:1] * np.float32(math.sqrt(2)),
    )
    return all_and_direct(found, pixel_axis(len(camera)), sky, scene.bands)


def sun_view_coefficients(
    scene: Scene,
    camera: PixelsOrCells,
    *,
    suns: Float[np.ndarray, "sun 3"],
    indirect: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> TransferMatrix:
    """Return C_ds: radiance of pixels per direct normal irradiance of suns [1/sr].

    It is the sunlight that the first visible surface scatters towards the eye, without
    the discs of suns that are seen directly (see `sun_disc`).

    Parameters
    ----------
    suns : unit vectors
    indirect : whether the rays of `camera` start at a surface, into its hemisphere:
        proxies then scatter them by their BSDF, as in Radiance, and not by the geometry
        that they stand for
    samples : number of paths per pixel and sun
    """
    effort = sun_effort(sun_view_coefficients, keywords, samples=SUN_SAMPLES)
    has_shape(suns, (len(suns), 3), "array of unit vectors to the suns")
    job = SunViewJob(
        scene=scene,
        camera=camera,
        suns=suns,
        samples=effort.samples or SUN_SAMPLES,
        indirect=indirect,
        **effort.job_options(_BATCHES),
    )
    one, other = trace_sun_view(job, effort)
    axes = pixel_axis(len(camera)), sun_axis(len(suns))
    return TransferMatrix(
        (one + other) / 2, *axes, (one - other)[None] / 2, scene.bands
    )


def sun_disc(
    scene: Scene,
    position: Vector,
    suns: Float[np.ndarray, "sun 3"],
    *,
    device: Device = "auto",
) -> tuple[Float[np.ndarray, " sun"], Float[np.ndarray, " sun"]]:
    """Return the visible share of each sun's disc at a point, and its transmittance.

    The transmittance is the mean over the visible part and the bands: 1 for a sun that
    is seen through air, 0 for one that is hidden. `suns` are unit vectors.
    """
    if not len(suns):
        return np.zeros(0), np.zeros(0)
    tracer: Any = devices.load(device, "direct_visibility")
    disc = devices.load(device, "sun_tables").solar_disc(suns, _DISC)
    found = tracer.direct_transmittance(scene, position[None], disc.reshape(-1, 3))
    passed = found.reshape(_DISC, len(suns))
    share = (passed > 0).mean(axis=0)
    return share, passed.mean(axis=0) / np.maximum(share, 1 / _DISC)
