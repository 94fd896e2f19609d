"""Random walks of light in a rectangular room with diffuse surfaces and one window.

The referee of the sunlight that a zone returns to its window: exact surfaces, and no
matrices.
"""

import numpy as np

_REFLECTIONS, _LEAST = 100, 1e-4


def returned(zone, walls, slabs, window, *, paths=200_000, seed=1):
    """Share of diffuse radiation from a window that passes or heats it again.

    Parameters
    ----------
    zone : size of the room and place of its window, in the plane y = 0
    walls, slabs, window : reflectances of walls, of floor and ceiling, of the window
    """
    rng, size = np.random.default_rng(seed), np.array(zone.size, float)
    left, right, low, high = zone.window
    place = np.stack(
        [
            rng.uniform(left, right, paths),
            np.zeros(paths),
            rng.uniform(low, high, paths),
        ],
        axis=1,
    )
    axis, side, weight, lost = np.ones(paths, int), np.zeros(paths), np.ones(paths), 0.0
    for _ in range(_REFLECTIONS):
        # Leave the surface in a cosine-distributed direction
        rows = np.arange(len(place))
        u, turn = rng.random(len(rows)), 2 * np.pi * rng.random(len(rows))
        way = np.empty_like(place)
        way[rows, axis] = np.where(side == 0, 1, -1) * np.sqrt(1 - u)
        way[rows, (axis + 1) % 3] = np.sqrt(u) * np.cos(turn)
        way[rows, (axis + 2) % 3] = np.sqrt(u) * np.sin(turn)

        # Find the next surface
        far = (np.where(way > 0, size, 0) - place) / way
        far[rows, axis] = np.where(far[rows, axis] > 1e-9, far[rows, axis], np.inf)
        axis = far.argmin(axis=1)
        place = place + far[rows, axis, None] * way
        side = (way[rows, axis] > 0).astype(float)
        place[rows, axis] = side * size[axis]

        # Count what the window takes
        x, _, z = place.T
        within = (x > left) & (x < right) & (z > low) & (z < high)
        glass = (axis == 1) & (side == 0) & within
        lost += weight[glass].sum() * (1 - window)
        weight = weight * np.where(glass, window, np.where(axis == 2, slabs, walls))
        keep = weight > _LEAST
        place, axis, side, weight = place[keep], axis[keep], side[keep], weight[keep]
    return lost / paths
