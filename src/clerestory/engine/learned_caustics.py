"""Learning of the directions of focused sunlight from particles.

Particles (`sun_particles`) that arrive in one cell of the room from nearly one
direction are merged to a cone. Cells are small enough that their cones are narrow, and
large enough for several particles. They lie on surfaces, and around sensors.

Reference: H. W. Jensen, "Importance driven path tracing using the photon map",
Rendering Techniques 1995.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Int

from clerestory.engine.arrival_cells import (
    Entries,
    at_sensors,
    on_surfaces,
    size_at_sensors,
    size_on_surfaces,
)
from clerestory.engine.caustic_lobes import CausticLobes, Caustics, Level, keys
from clerestory.engine.cone_fits import Arrivals, fitted_cones
from clerestory.engine.focusing_surfaces import focusing_triangles
from clerestory.engine.illumination import Illumination
from clerestory.engine.origin import Origin
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.sun_particles import Particles, trace_particles
from clerestory.scene.model import Scene

# Number of particles aimed at, and most rounds in which they are traced.
_ENOUGH, _ROUNDS = 1 << 17, 8

# Sizes of the cells of each level, relative to a cell of few particles, the smallest
# first; fewest arrivals in one of the smaller cells, which serve bright places.
_SIZES = (1 / 16, 1 / 4, 1.0, 4.0, 16.0)
_DENSE = 64

# Slots of the hash table per cell, at least.
_SPARSE = 4

# Directions of a cell within this angle are merged [rad]; factors that combine the
# indices of directions and chains into one number.
_MERGED = 0.15
_STRIDES, _CHAIN = [7919, 104729, 1299709], 31


def learned_caustics(
    scene: Scene,
    illuminated: Illumination,
    origin: Origin,
    sensors: SurfacePoints | None = None,
) -> Caustics | None:
    """Return the cones of focused sunlight; None if no surface focuses any.

    Paths start at `sensors`, or at surfaces seen by a camera.
    """
    if not illuminated.distant.suns:
        return None
    triangles = focusing_triangles(scene, illuminated.model.smooth, origin)
    if not len(triangles):
        return None
    box = illuminated.model.scene.bbox()
    corners = np.array([*np.array(box.min).T, *np.array(box.max).T]).reshape(2, 3)
    if sensors is not None:
        corners = np.concatenate([corners, sensors.point])
    reach = float(np.linalg.norm(np.ptp(corners, axis=0)))
    rounds = (
        trace_particles(illuminated, triangles, reach=reach, seed=n)
        for n in range(_ROUNDS)
    )
    found = next(rounds)
    for more in rounds:
        if not 0 < len(found) < _ENOUGH:
            break
        found += more
    landed = found.some(np.flatnonzero(found.normal.any(axis=1)))
    surfaces = None
    if len(landed):
        usual = size_on_surfaces(landed)
        surfaces = _lobes(landed, usual, lambda size: on_surfaces(landed, size))
    if sensors is None or not (len(found) and len(sensors)):
        return Caustics(surfaces, surfaces if sensors is None else None)
    usual = size_at_sensors(found, sensors)
    passed = _lobes(found, usual, lambda size: at_sensors(found, sensors, size))
    return Caustics(surfaces, passed)


def _lobes(
    particles: Particles, usual: float, entries: Callable[[float], Entries]
) -> CausticLobes | None:
    # Cones of the particles in cells of several sizes, the smallest first
    levels = []
    for part in _SIZES:
        size = part * usual
        found = entries(size)
        key = keys(found.place, found.side)
        if part < 1:
            _, member, count = np.unique(key, return_inverse=True, return_counts=True)
            dense = np.flatnonzero(count[member] >= _DENSE)
            found, key = found.some(dense), key[dense]
        if len(key):
            levels.append(_level(particles, found, key, size))
    return CausticLobes.of(levels) if levels else None


def _level(
    particles: Particles, entries: Entries, key: Int[np.ndarray, " entry"], size: float
) -> Level:
    # Cones of particles that arrive near a cell by one chain of surfaces, from similar
    # directions
    table = np.unique(key)
    slots = 1 << (_SPARSE * len(table)).bit_length()
    owner = np.zeros(slots, dtype=np.int64)
    owner[table & (slots - 1)] = table
    place, side = np.zeros((slots, 3), dtype=np.int64), np.zeros(slots, dtype=np.int64)
    # Of cells in one slot, one owns it; larger cells serve the others
    owned = np.flatnonzero(owner[key & (slots - 1)] == key)
    entries, key = entries.some(owned), key[owned]
    place[key & (slots - 1)], side[key & (slots - 1)] = entries.place, entries.side
    segment = particles.start - particles.end
    distance = np.linalg.norm(segment, axis=1)
    direction = segment / np.maximum(distance, 1e-12)[:, None]
    bins = np.round(direction / _MERGED).astype(np.int64) @ _STRIDES
    kind = (particles.chain * _CHAIN + bins) & 0xFFFFFFFF
    code = ((key & (slots - 1)) << 32) + kind[entries.number]
    code, cone = np.unique(code, return_inverse=True)
    # Near the last surface, light may come from any part of it
    blur = particles.blur + 0.25 * size / np.maximum(distance, size)
    number = entries.number
    found = Arrivals(entries.point, direction[number], blur[number])
    fits = fitted_cones(code >> 32, code & 0xFFFFFFFF, cone, found)
    return Level(size, owner, place, side, fits)
