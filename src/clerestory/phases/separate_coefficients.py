"""Daylight coefficients with their part of direct light, from the same paths.

    C     receivers × sky patches   all light
    C_d   receivers × sky patches   direct light

The direct sun spread over sky patches then cancels in C S − C_d S_ds, path by path:
error components of equal index belong to the same paths.
"""

from typing import Unpack

import numpy as np

from clerestory.bands import Bands
from clerestory.checks import one_of
from clerestory.engine.controller import estimate
from clerestory.engine.effort import EffortKeywords
from clerestory.engine.matrix_jobs import CoefficientsJob
from clerestory.engine.sums import Estimate
from clerestory.hemisphere.reinhart import SkyPartition, reinhart
from clerestory.matrix.axis import Axis, sky_axis
from clerestory.matrix.derivatives import Derivatives
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.traced_matrices import (
    Differentiated,
    matrix_effort,
    require_sensors,
    sensors_axis,
    warn_if_short,
)
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import BsdfSurface, Scene
from clerestory.scene.sensors import Sensors


def separate_coefficients(
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    windows: tuple[str, ...] = (),
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> tuple[TransferMatrix, TransferMatrix]:
    """Return C and C_d: irradiance of sensors per radiance of sky patches [sr].

    C_d is the part of C due to light that passes clear glass unscattered. With
    `windows`, it is the part that meets only surfaces of these materials.

    Parameters
    ----------
    windows : names of materials of the scene. Without them, the scene has no proxied
        geometry, which direct light passes and other light does not

    See `daylight_coefficients` for the other parameters.
    """
    effort = matrix_effort(separate_coefficients, keywords)
    require_sensors(sensors, effort)
    for name in windows:
        one_of(name, "material of a window", choices=list(scene.materials))
    sky = reinhart(subdivision)
    job = CoefficientsJob(
        scene=scene,
        sky=sky,
        sensors=sensors,
        separate=True,
        windows=windows,
        derivatives=material_parameters(scene, derivatives),
        **effort.job_options(),
    )
    estimated = estimate(job, effort)
    warn_if_short(estimated, "daylight coefficients", effort)
    return all_and_direct(estimated, sensors_axis(sensors), sky, scene.bands)


def has_proxies(scene: Scene) -> bool:
    """Whether a scene has geometry that a BSDF with a thickness stands for."""
    materials = scene.materials.values()
    return any(isinstance(m, BsdfSurface) and m.thickness for m in materials)


def all_and_direct(
    estimated: Estimate, rows: Axis, sky: SkyPartition, bands: Bands
) -> tuple[TransferMatrix, TransferMatrix]:
    """Return C and C_d of an estimate with separate columns of direct and other light.

    The columns are the sky patches for direct light, then those for all other light.
    """
    columns, blank = sky_axis(sky), not estimated.paths
    values, direct = _summed(estimated.values, blank=blank)
    components = direct_components = None
    if estimated.components is not None:
        components, direct_components = _summed(estimated.components, blank=blank)
    whole, of_direct = _summed_derivatives(estimated.derivatives, blank=blank)
    C = TransferMatrix(values, rows, columns, components, bands, whole)
    return C, TransferMatrix(direct, rows, columns, direct_components, bands, of_direct)


def _summed_derivatives(
    derivatives: Derivatives | None, *, blank: bool
) -> tuple[Derivatives | None, Derivatives | None]:
    # Derivatives of all light, and of direct light
    if derivatives is None:
        return None, None
    first, second = (
        _summed(each, blank=blank) for each in (derivatives.first, derivatives.second)
    )
    parts = derivatives.components
    components = (None, None) if parts is None else _summed(parts, blank=blank)
    whole, direct = (
        Derivatives(derivatives.parameters, *each)
        for each in zip(first, second, components, strict=True)
    )
    return whole, direct


def _summed(columns: np.ndarray, *, blank: bool) -> tuple[np.ndarray, np.ndarray]:
    # The sum of the columns of direct and of other light, and those of direct light
    direct, other = np.split(columns, 2, axis=-1)
    if blank:
        # In a dry run, where a sum would take memory
        return direct, direct
    return direct + other, np.ascontiguousarray(direct)
