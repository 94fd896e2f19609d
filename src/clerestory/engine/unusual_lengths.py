"""Scaling of jobs with scenes of unusual size, for single precision.

Ray offsets, distances and areas on the compute device have absolute limits: rooms of a
fraction of a millimetre, or of a million kilometres, would be wrong. Radiance and
irradiance do not depend on the unit of length, so such a job is traced in another unit:
a power of two, by which coordinates are scaled exactly. Other jobs remain unchanged.
"""

from collections.abc import Iterable
from dataclasses import fields, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled
from clerestory.scene.surface import Surface, extent
from clerestory.scene.window import Window

if TYPE_CHECKING:
    from clerestory.engine.work_units import Job

    AnyJob = TypeVar("AnyJob", bound=Job)

# Sizes of scenes that are traced unchanged, and size of scaled scenes [m]
_SMALLEST, _LARGEST, _USUAL = 0.05, 1e7, 8.0

# Number of surfaces for the estimate of the size
_SURFACES = 1000


def in_usual_lengths(job: "AnyJob") -> "AnyJob":
    """Return a job in a unit of length in which its scene has a usual size."""
    if not job.scalable:
        return job
    surfaces: list[Surface] = list(_few(job.scene.surfaces))
    values = {known.name: getattr(job, known.name) for known in fields(job)}
    for value in values.values():
        windows = value if isinstance(value, tuple) else (value,)
        for window in windows:
            surfaces += window.polygons if isinstance(window, Window) else ()
    factor = length_factor(surfaces)
    if factor == 1:
        return job
    return replace(job, **{name: scaled(v, factor) for name, v in values.items()})


def scene_factor(scene: Scene) -> float:
    """Return the factor by which a scene is scaled to a usual size; usually 1."""
    return length_factor(_few(scene.surfaces))


def length_factor(surfaces: Iterable[Surface]) -> float:
    """Return the power of two by which surfaces are scaled to a usual size; usually 1.

    The size is a low quantile of the distances of surfaces from their middle, so that
    distant surfaces, such as the terrain around a room, do not count.
    """
    points = [extent(surface) for surface in surfaces]
    boxes = np.array([(some.min(axis=0), some.max(axis=0)) for some in points])
    if not len(boxes):
        return 1.0
    away = np.abs(boxes - np.median(boxes.mean(axis=1), axis=0)).max(axis=(1, 2))
    size = float(np.quantile(away, 0.25))
    if _SMALLEST <= size <= _LARGEST or size == 0:
        return 1.0
    return float(2.0 ** np.round(np.log2(_USUAL / size)))


def _few(surfaces: tuple[Surface, ...]) -> tuple[Surface, ...]:
    return surfaces[:: 1 + len(surfaces) // _SURFACES]
