"""Check that the eyes of observers are in the room: not in walls or furniture."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import RayVectors
from clerestory.checks import require
from clerestory.scene.model import Scene
from clerestory.scene.proximity import Triangulation, distances, first_hits
from clerestory.scene.tessellate import meshes
from clerestory.scene.window import Window

# Distance to a surface below which an eye is in it [m]
_TOUCH = 0.01

# An eye is enclosed if half of its rays meet a surface within this distance [m]
_ENCLOSED = 0.4

# Number of rays around an eye, and of positions that a message names
_RAYS, _NAMED = 96, 5


def require_free_eyes(
    scene: Scene,
    windows: Sequence[Window],
    position: Float[np.ndarray, "position 3"],
    *,
    what: str,
) -> None:
    """Raise an error if an eye is outside the room or in something.

    Raises
    ------
    InputError : a position is outside the bounding box of the scene, behind all
        windows, on a surface, or enclosed; the message numbers positions from 1
    """
    for which, where, expected in _faults(scene, windows, position):
        found = np.flatnonzero(which)
        count = len(found)
        some = [
            f"{n + 1} ({' '.join(f'{x:.4g}' for x in position[n])})"
            for n in found[:_NAMED].tolist()
        ]
        shown = ", ".join(some) + (", …" if count > _NAMED else "")
        verb = f"position {shown} is" if count == 1 else f"{count} positions are"
        listed = "" if count == 1 else f": {shown}"
        require(
            count == 0, f"{what}: {verb} {where}{listed}; positions {expected} expected"
        )


def free_eyes(
    scene: Scene, windows: Sequence[Window], position: Float[np.ndarray, "position 3"]
) -> Bool[np.ndarray, " position"]:
    """Return whether each position passes the checks of `require_free_eyes`."""
    found = [which for which, _, _ in _faults(scene, windows, position)]
    return ~np.any(found, axis=0) if found else np.ones(len(position), dtype=bool)


def _faults(
    scene: Scene, windows: Sequence[Window], position: Float[np.ndarray, "position 3"]
) -> list[tuple[Bool[np.ndarray, " position"], str, str]]:
    # Positions with a fault, where they are, and where they should be
    parts = meshes(scene)
    if not parts:
        return []
    corner = np.concatenate([mesh.vertices[mesh.faces] for mesh in parts])
    solid = Triangulation(corner, np.concatenate([mesh.surface for mesh in parts]))
    low, high = scene.bounds()
    outside = np.any((position < low) | (position > high), axis=1)
    behind = np.ones(len(position), dtype=bool)
    for window in windows:
        from_plane = position - window.polygons[0].vertices[0]
        behind &= from_plane @ window.frame.normal <= 0
    behind &= bool(windows)
    rays, shut_in = _sphere(), np.zeros((2, len(position)), dtype=bool)
    for n, point in enumerate(position):
        near = solid.near(point, _ENCLOSED).corner
        shut_in[0, n] = distances(point, near).min(initial=np.inf) < _TOUCH
        shut_in[1, n] = np.median(first_hits(point, rays, near)) < _ENCLOSED
    touching, enclosed = shut_in
    return [
        (outside, "outside the bounding box of the scene", "in the room"),
        (behind, "behind all windows", "in front of a window"),
        (touching, "on a surface", "in free space"),
        (enclosed, "enclosed by a wall or furniture", "in free space"),
    ]


def _sphere() -> RayVectors:
    # Evenly spread directions over the sphere, on a spiral
    z = 1 - (2 * np.arange(_RAYS) + 1) / _RAYS
    angle = np.arange(_RAYS) * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - z**2)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=1)
