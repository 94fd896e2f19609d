"""BSDFs with closed-form values: Lambertian diffuser, clear air and clear glass."""

import numpy as np

from clerestory.array_types import ExitIncident, Values
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.checks import not_negative, require, within
from clerestory.hemisphere.partition import RingPartition

# Number of incidence angles per ring over which glass properties are averaged.
_SAMPLES_PER_RING = 64


def lambertian(
    transmittance: float, partition: RingPartition, *, reflectance: float = 0.0
) -> Bsdf:
    """Lambertian diffuser with equal properties on both sides.

    `transmittance`, `reflectance`: 0…1, with a sum of at most 1.

    >>> from clerestory.hemisphere.klems import klems
    >>> lambertian(0.4, klems("half")).direct_hemispherical().round(9)[:2].tolist()
    [0.4, 0.4]
    """
    not_negative([transmittance, reflectance], "transmittance or reflectance")
    both = transmittance + reflectance
    within(both, "transmittance plus reflectance", least=0, most=1)
    even = np.full((len(partition), len(partition)), 1 / np.pi)
    return _symmetric(
        "Lambertian diffuser", partition, transmittance * even, reflectance * even
    )


def clear_air(partition: RingPartition) -> Bsdf:
    """Layer that transmits all light undeviated.

    The transmission matrix of the layer is the identity.
    """
    straight = np.diag(1 / partition.projected_solid_angles())
    return _symmetric("Clear air", partition, straight, np.zeros_like(straight))


def thin_pane(
    transmissivity: float,
    partition: RingPartition,
    *,
    index: float = 1.52,
    panes: int = 1,
) -> Bsdf:
    """Layer of clear glass panes, modelled as Radiance's material `glass`.

    Transmittance and reflectance are averaged over each patch with cosine weights.

    Parameters
    ----------
    transmissivity : internal transmittance of one pane at normal incidence, 0…1
    index : refractive index, 1 or more
    panes : number of panes
    """
    within(transmissivity, "transmissivity", least=0, most=1)
    require(index >= 1, f"refractive index is {index}; 1 or more expected")
    require(panes >= 1, f"number of panes is {panes}; 1 or more expected")
    # Average over equal parts of the projected solid angle of each ring
    part = (np.arange(_SAMPLES_PER_RING) + 0.5) / _SAMPLES_PER_RING
    low, high = np.sin(partition.theta[:-1]) ** 2, np.sin(partition.theta[1:]) ** 2
    cosine = np.sqrt(1 - low[:, None] - (high - low)[:, None] * part)
    shares = glass_properties(
        cosine, transmissivity=transmissivity, index=index, panes=panes
    )
    measure = partition.projected_solid_angles()
    transmission, reflection = (
        np.diag(np.repeat(share.mean(axis=1), partition.count) / measure)
        for share in shares
    )
    return _symmetric("Clear pane", partition, transmission, reflection)


def glass_properties(
    cosine: Values, *, transmissivity: float, index: float, panes: int = 1
) -> tuple[Values, Values]:
    """Transmittance and reflectance of clear panes for unpolarised light.

    Fresnel's equations are used at each surface, with the geometric series of
    interreflections for each polarisation, as in Radiance's material `glass`. Light
    between panes is assumed to be unpolarised.

    `cosine`: cosine of the angle of incidence.

    >>> t, r = glass_properties(np.array(1.0), transmissivity=1.0, index=1.5)
    >>> round(float(t), 6), round(float(r), 6)  # t = 2n/(n² + 1), r = 1 − t
    (0.923077, 0.076923)
    """
    inside = np.sqrt(1 - (1 - cosine**2) / index**2)
    passage = transmissivity ** (1 / inside)
    transmitted, reflected = [], []
    for face in (
        (cosine - index * inside) / (cosine + index * inside),
        (index * cosine - inside) / (index * cosine + inside),
    ):
        r = face**2
        series = 1 / (1 - (r * passage) ** 2)
        transmitted.append((1 - r) ** 2 * passage * series)
        reflected.append(r + (1 - r) ** 2 * r * passage**2 * series)
    t, r = np.mean(transmitted, axis=0), np.mean(reflected, axis=0)

    # Add panes one by one with the series of interreflections between panes
    all_t, all_r = t, r
    for _ in range(panes - 1):
        between = 1 / (1 - all_r * r)
        all_t, all_r = all_t * t * between, r + t**2 * all_r * between
    return np.asarray(all_t), np.asarray(all_r)


def _symmetric(
    name: str,
    partition: RingPartition,
    transmission: ExitIncident,
    reflection: ExitIncident,
) -> Bsdf:
    # Build a layer with equal transmission and reflection on both sides
    tables = transmission, transmission, reflection, reflection
    functions = {
        ("visible", function): ScatteringMatrix(table, partition, partition)
        for function, table in zip(FUNCTIONS, tables, strict=True)
    }
    return Bsdf(functions, Product(name=name))
