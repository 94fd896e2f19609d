"""Outlines of honeybee's faces."""

import numpy as np
from jaxtyping import Float

from clerestory.scene.surface import area_vector


def seamed(
    loops: list[Float[np.ndarray, "_ 3"]],
) -> Float[np.ndarray, "point 3"]:
    """Return one outline of several; holes hang on seams from the first corner.

    Holes run against the outline, so that areas come out right by the sign too.
    """
    first = loops[0]
    outward = area_vector(first)
    outline = [first]
    for hole in loops[1:]:
        turned = hole[::-1] if area_vector(hole) @ outward > 0 else hole
        outline += [first[:1], turned, turned[:1]]
    return np.concatenate(outline)


def plane_of(outline: Float[np.ndarray, "point 3"]) -> tuple[float, ...]:
    """Return normal and distance [m] of an outline, rounded to tell planes apart."""
    normal = area_vector(outline)
    normal /= max(float(np.linalg.norm(normal)), 1e-12)
    distance = float(normal @ outline.mean(axis=0))
    return (*(round(float(x), 3) + 0.0 for x in normal), round(distance, 2) + 0.0)
