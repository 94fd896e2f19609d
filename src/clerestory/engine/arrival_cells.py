"""Cells in which particles from the sun arrive: on surfaces, and around sensors."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.sensor_crossings import crossings
from clerestory.engine.sun_particles import Particles

# Particles per cell of surfaces and of sensors aimed at; size of the cells of sensors
# tried first [m].
_PER_CELL, _PER_SENSOR, _FIRST_SIZE = 12, 96, 0.05

# Bounds of the cell size [m], and its steps.
_SMALLEST, _LARGEST, _STEP = 1e-4, 0.3, 1.3


@dataclass(frozen=True, eq=False)
class Entries:
    """Pairs of a particle and a cell near which it arrives.

    Attributes
    ----------
    number : index of the particle
    point : where it arrives [m]
    place : indices of the cell along each axis
    side : class of normals of surfaces or sensors in the cell (`facings`)
    """

    number: Int[np.ndarray, " entry"]
    point: Float[np.ndarray, "entry 3"]
    place: Int[np.ndarray, "entry 3"]
    side: Int[np.ndarray, " entry"]

    def some(self, chosen: Int[np.ndarray, " m"]) -> "Entries":
        """Return the pairs of given indices."""
        return Entries(*(part[chosen] for part in vars(self).values()))


def facings(normal: Float[np.ndarray, "n 3"]) -> Int[np.ndarray, " n"]:
    """Return the class of normals: nearest direction of ±x, ±y and ±z."""
    size = np.abs(normal)
    upright = (size[:, 2] >= size[:, 0]) & (size[:, 2] >= size[:, 1])
    axis = np.where(upright, 2, np.where(size[:, 0] >= size[:, 1], 0, 1))
    along = np.take_along_axis(normal, axis[:, None], axis=1)[:, 0]
    return np.asarray(2 * axis + (along > 0))


def size_on_surfaces(particles: Particles) -> float:
    """Return the largest cell size with few particles per cell [m]."""
    size = _LARGEST
    while size > _SMALLEST:
        place = np.floor(particles.end / size).astype(np.int64) + (1 << 20)
        occupied = len(np.unique(place @ [1 << 42, 1 << 21, 1]))
        if len(particles) <= _PER_CELL * occupied:
            break
        size /= _STEP
    return size


def on_surfaces(particles: Particles, size: float) -> Entries:
    """Return the cells within half a cell of the points where particles land."""
    corner = np.floor(particles.end / size - 0.5).astype(np.int64)
    steps = np.stack(np.meshgrid(*[[0, 1]] * 3), axis=-1).reshape(-1, 3)
    number = np.repeat(np.arange(len(particles)), len(steps))
    return Entries(
        number,
        particles.end[number],
        (corner[:, None] + steps).reshape(-1, 3),
        facings(particles.normal)[number],
    )


def size_at_sensors(particles: Particles, sensors: SurfacePoints) -> float:
    """Return a cell size with a moderate number of particles per cell [m]."""
    size = _FIRST_SIZE
    for _ in range(2):
        _, _, box = _passing(particles, sensors, size)
        each = len(box) / max(len(np.unique(box)), 1)
        size *= float(np.sqrt(_PER_SENSOR / max(each, 1e-3)))
        size = min(max(size, _SMALLEST), _LARGEST)
    return size


def at_sensors(particles: Particles, sensors: SurfacePoints, size: float) -> Entries:
    """Return the cells of sensors that particles pass within half a cell."""
    cell, passed, box = _passing(particles, sensors, size)
    # Nearest point to the middle of the cell
    middle, start = (cell[box] + 0.5) * size, particles.start[passed]
    way = particles.end[passed] - start
    share = np.sum((middle - start) * way, axis=1) / np.sum(way**2, axis=1)
    point = start + np.clip(share, 0, 1)[:, None] * way
    sides = np.unique(facings(sensors.normal))
    return Entries(
        np.tile(passed, len(sides)),
        np.tile(point, (len(sides), 1)),
        np.tile(cell[box], (len(sides), 1)),
        np.repeat(sides, len(passed)),
    )


def _passing(
    particles: Particles, sensors: SurfacePoints, size: float
) -> tuple[
    Int[np.ndarray, "cell 3"], Int[np.ndarray, " entry"], Int[np.ndarray, " entry"]
]:
    # Cells of sensors; particles that pass within half a cell, and cells they pass
    cell = np.unique(np.floor(sensors.point / size).astype(np.int64), axis=0)
    return cell, *crossings(particles, (cell - 0.5) * size, 2 * size)
