"""Solar radiation on window groups, by incident patch, with the sun at its position.

    E(t) = Λ [D S_sky + (D − D_d) S_ds](t) + E_sun(t)

S_sky is the radiance of sky and ground, S_ds that of the sun, D − D_d scatters sunlight
at surfaces outdoors. Unscattered sunlight, E_sun, has the direction of the sun, and the
share of the window that the sun sees. Where it is between the outermost ring of patches
and grazing incidence, an increasing part is reflected instead of belonging to patches.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Series
from clerestory.brief_repr import brief
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.patch_interpolation import patch_weights
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.unscattered_light import sun_visible
from clerestory.scene.window_zones import spread_points
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.study.job import Job
from clerestory.study.study_tracing import window_daylight

# Points of a window group at which the sun may be hidden; distance from it [m]
_POINTS, _DISTANCE = 256, 1e-3


@dataclass(frozen=True, eq=False)
class IncidentRadiation:
    """Solar radiation on a window group over time [W/m²].

    Attributes
    ----------
    patches : radiation by incident patch, of which the window transmits, absorbs and
        reflects what it does of light in the centres of the patches
    grazing : further radiation near grazing incidence, of which it reflects all
    """

    patches: Float[np.ndarray, "patch time"]
    grazing: Series

    __repr__ = brief

    @property
    def irradiance(self) -> Series:
        """Irradiance of the window [W/m²]."""
        return np.asarray(self.patches.sum(axis=0) + self.grazing)


def incident_radiation(
    job: Job, number: int, partition: RingPartition
) -> IncidentRadiation:
    """Return the solar radiation on a window group.

    Parameters
    ----------
    number : number of the window group
    partition : patches of the result
    """
    group, weather = job.inputs.groups[number], job.inputs.weather
    make = partial(
        sky_matrix,
        weather,
        subdivision=job.study.sky.subdivision,
        ground_reflectance=job.study.sky.ground_reflectance,
        rotation_deg=job.study.sky.rotation_deg,
        bands=job.inputs.scene.bands,
        spectrum="solar",
    )
    black = replace(job.inputs, scene=blackened(job.scene))
    whole, direct = (
        window_daylight(each, group, number)[0]
        for each in (job, replace(job, inputs=black, direct=True))
    )
    sun = make(include="sun")
    scattered = _radiance(whole, sun) - _radiance(direct, sun)
    radiance = _radiance(whole, make(include="sky")) + np.maximum(scattered, 0)
    outer = group.outer.partition
    flux = radiance * outer.projected_solid_angles()[:, None]
    found = flux
    if not outer.matches(partition):
        found = patch_weights(partition, outer.centres()) @ flux
    unscattered = sunlight(job, number, partition)
    grazing = flux.sum(axis=0) - found.sum(axis=0) + unscattered.grazing
    return IncidentRadiation(found + unscattered.patches, grazing)


def _radiance(
    matrix: TransferMatrix, sky: SkyMatrix
) -> Float[np.ndarray, "patch time"]:
    # Radiance of the patches [W/(m²·sr)]
    size = matrix.rows.size
    rows = replace(matrix, rows=sensor_axis(size), components=None)
    lux = (rows @ sky).illuminance()["illuminance"].values
    return np.asarray(lux / LUMINOUS_EFFICACY)


def sunlight(job: Job, number: int, partition: RingPartition) -> IncidentRadiation:
    """Return the radiation of the unscattered sun, interpolated to patches."""
    group, weather = job.inputs.groups[number], job.inputs.weather
    rotation = job.study.sky.rotation_deg
    suns = sun_over(weather, rotation_deg=rotation).directions()
    frame = group.outer.frame
    cosine = -suns @ frame.normal
    steps = np.flatnonzero(
        (cosine > 0) & (suns[:, 2] > 0) & (weather.direct_normal > 0)
    )
    found, grazing = np.zeros((len(partition), len(suns))), np.zeros(len(suns))
    if not len(steps):
        return IncidentRadiation(found, grazing)
    points = spread_points(group.outer.polygons, _POINTS) - _DISTANCE * frame.normal
    seen = sun_visible(job.scene, points, suns[steps], device=job.device).mean(axis=0)
    axes = np.array([frame.right, frame.up, frame.normal])
    travel = -suns[steps] @ axes.T
    level = weather.direct_normal[steps] * cosine[steps] * seen
    weights = patch_weights(partition, travel)
    found[:, steps] = weights * level
    grazing[steps] = (1 - weights.sum(axis=0)) * level
    return IncidentRadiation(found, grazing)
