"""Perlin noise with values from -1 to 1, for arrays of any library.

A permutation of 256 numbers assigns one of twelve gradients to each integer lattice
point; the interpolant has degree five. `noise3x`, `noise3y` and `noise3z` are
backward differences over 0.0005, as in Radiance.

References: K. Perlin, "Improving Noise", SIGGRAPH 2002 (method and permutation);
G. Ward, Radiance, src/rt/noise3.c (step of the differences).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Float

# Step of the backward differences
STEP = 0.0005

# Permutation of 0…255; its last four bits select one of the gradients
SHUFFLE = np.array(
    [
        151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140,
        36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234,
        75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88, 237,
        149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48,
        27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105,
        92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73,
        209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86,
        164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38,
        147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189,
        28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101,
        155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232,
        178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12,
        191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31,
        181, 199, 106, 157, 184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254,
        138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215,
        61, 156, 180,
    ],
    dtype=float,
)  # fmt: skip
GRADIENTS = np.array(
    [
        (1, 1, 0), (-1, 1, 0), (1, -1, 0), (-1, -1, 0),
        (1, 0, 1), (-1, 0, 1), (1, 0, -1), (-1, 0, -1),
        (0, 1, 1), (0, -1, 1), (0, 1, -1), (0, -1, -1),
        (1, 1, 0), (0, -1, 1), (-1, 1, 0), (0, -1, -1),
    ],
    dtype=float,
)  # fmt: skip

# Tables of 256 numbers: the permutation; x, y and z of the gradients it selects
TABLES = (SHUFFLE, *GRADIENTS[SHUFFLE.astype(int) & 15].T)

# Function that returns entries of a table, given table number and indices
Take = Callable[[int, Any], Any]


def noise(x: Any, y: Any, z: Any, *, floor: Callable[[Any], Any], take: Take) -> Any:
    """Return the noise at the points (x, y, z).

    `floor` rounds arrays down; `take(n, i)` returns the entries of `TABLES[n]` at the
    indices i modulo 256.
    """
    cell = [floor(c) for c in (x, y, z)]
    local = [c - low for c, low in zip((x, y, z), cell, strict=True)]
    fade = [t * t * t * (t * (t * 6 - 15) + 10) for t in local]
    total: Any = 0.0
    for i in (0, 1):
        one = take(0, cell[0] + i) + cell[1]
        for j in (0, 1):
            two = take(0, one + j) + cell[2]
            for k in (0, 1):
                weight, slope = 1.0, 0.0
                for axis, step in enumerate((i, j, k)):
                    near = fade[axis] if step else 1 - fade[axis]
                    weight = weight * near
                    slope = slope + take(1 + axis, two + k) * (local[axis] - step)
                total = total + weight * slope
    return total


def slope_of(
    at: Callable[[Any, Any, Any], Any], axis: int
) -> Callable[[Any, Any, Any], Any]:
    """Return the backward difference quotient of a noise function along an axis."""

    def slope(x: Any, y: Any, z: Any) -> Any:
        before = [x, y, z]
        before[axis] = before[axis] - STEP
        return (at(x, y, z) - at(*before)) / STEP

    return slope


def noise_of_arrays(
    x: Float[np.ndarray, " points"],
    y: Float[np.ndarray, " points"],
    z: Float[np.ndarray, " points"],
) -> Float[np.ndarray, " points"]:
    """Return the noise at the points (x, y, z)."""
    found: np.ndarray = noise(
        x, y, z, floor=np.floor, take=lambda t, i: TABLES[t][i.astype(np.int64) & 255]
    )
    return found
