"""Symmetry of a layer, deduced from the measured incident directions.

- isotropic: no dependence on azimuth; directions in one plane suffice
- quadrilateral: left–right and up–down mirror symmetry; one quadrant suffices
- bilateral-x, bilateral-y: mirror symmetry about the plane x = 0 (left–right) or
  y = 0 (up–down); half of the directions suffice
- rotational: symmetry under rotation by 180°; half of the directions suffice
- none: all directions are needed

References: G. Ward, M. Kurt, N. Bonneel, "A practical framework for sharing and
rendering real-world bidirectional scattering distribution functions", LBNL-5954E, 2012;
"Reducing anisotropic BSDF measurement to common practice", MAM 2014.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import Directions, Vector2
from clerestory.errors import InputError

Symmetry = Literal[
    "isotropic", "quadrilateral", "bilateral-x", "bilateral-y", "rotational", "none"
]
SYMMETRIES: tuple[Symmetry, ...] = get_args(Symmetry)

# Polar angle [°] below which the azimuth is ignored, and largest difference [°] between
# an azimuth and an axis that counts as zero; both as in pabopto2bsdf.
_NEAR_NORMAL_DEG = 1.0
_NEAR_AXIS_DEG = 1.0

# Symmetry implied by the quadrants in which azimuths were measured.
_IN_QUADRANTS: dict[frozenset[int], Symmetry] = {
    **{frozenset({k}): "quadrilateral" for k in range(4)},
    frozenset({0, 1}): "bilateral-y",
    frozenset({2, 3}): "bilateral-y",
    frozenset({1, 2}): "bilateral-x",
    frozenset({3, 0}): "bilateral-x",
    frozenset(range(4)): "none",
}

# Symmetry implied by azimuths: (0° and 180° measured, 90° and 270° measured).
_ON_AXES: dict[tuple[bool, bool], Symmetry] = {
    (True, True): "none",
    (True, False): "bilateral-y",
    (False, True): "bilateral-x",
    (False, False): "quadrilateral",
}

# Signs of x and y of the images of a direction under each symmetry.
_IMAGES: dict[Symmetry, tuple[tuple[int, int], ...]] = {
    "isotropic": ((1, 1),),
    "quadrilateral": ((1, 1), (-1, 1), (1, -1), (-1, -1)),
    "bilateral-x": ((1, 1), (-1, 1)),
    "bilateral-y": ((1, 1), (1, -1)),
    "rotational": ((1, 1), (-1, -1)),
    "none": ((1, 1),),
}


# Axes (0: x, 1: y) along which all measured directions have the same sign.
_BOUNDED: dict[Symmetry, list[int]] = {
    "isotropic": [],
    "quadrilateral": [0, 1],
    "bilateral-x": [0],
    "bilateral-y": [1],
    "rotational": [1],
    "none": [],
}


def images(symmetry: Symmetry) -> Directions:
    """Factors of x, y and z for each image of a direction, the identity first."""
    return np.array([(*signs, 1) for signs in _IMAGES[symmetry]], dtype=float)


def deduce_symmetry(incidents: Directions) -> Symmetry:
    """Symmetry implied by the quadrants that contain incident directions.

    Two adjacent quadrants imply bilateral symmetry; rotational symmetry is never
    deduced.

    >>> deduce_symmetry(np.array([[0, 0, 1.0], [0.5, 0, 0.866], [0.9, 0, 0.436]]))
    'isotropic'
    """
    theta = np.degrees(np.arctan2(np.hypot(*incidents[:, :2].T), incidents[:, 2]))
    phi = np.degrees(np.arctan2(incidents[:, 1], incidents[:, 0])) % 360
    phi = phi[theta >= _NEAR_NORMAL_DEG]
    if len(phi) == 0 or np.all(np.abs((phi - phi[0] + 180) % 360 - 180) < 1.0):
        return "isotropic"
    inner = np.abs((phi + 45) % 90 - 45) > _NEAR_AXIS_DEG
    covered = frozenset((phi[inner] // 90).astype(int).tolist())
    if not covered:
        # All azimuths are 0, 90, 180 or 270°
        axes = set((np.round(phi / 90) % 4).astype(int).tolist())
        return _ON_AXES[{0, 2} <= axes, {1, 3} <= axes]
    if covered in _IN_QUADRANTS:
        return _IN_QUADRANTS[covered]
    names = ", ".join(f"{90 * k}–{90 * k + 90}°" for k in sorted(covered))
    raise InputError(
        f"incident azimuths cover {names}; one plane, one quadrant, two adjacent"
        " quadrants, or all quadrants expected"
    )


def rotation_about_normal(
    angle: Float[np.ndarray, "*batch"] | float,
) -> Float[np.ndarray, "*batch 3 3"]:
    """Matrix of a rotation about the normal by an angle [rad], from +x to +y."""
    c, s = np.cos(angle), np.sin(angle)
    nil, one = np.zeros_like(c), np.ones_like(c)
    return np.stack(
        [np.stack(row, -1) for row in ([c, -s, nil], [s, c, nil], [nil, nil, one])], -2
    )


def fold(
    incident: Float[np.ndarray, "batch 3"], symmetry: Symmetry, quadrant: Vector2
) -> tuple[Float[np.ndarray, "batch 3"], Float[np.ndarray, "batch 3 3"]]:
    """Map directions to their images in the measured part of the hemisphere.

    Return the images, which have azimuth 0 for isotropic layers, and the matrices that
    map images back to directions. `quadrant`: signs of x and y in the measured part.
    """
    if symmetry == "isotropic":
        x, y, z = incident.T
        radius = np.hypot(x, y)
        folded = np.stack([radius, 0 * radius, z], axis=-1)
        return folded, rotation_about_normal(np.arctan2(y, x))
    factor = np.ones_like(incident)
    outside = np.where(incident[:, :2] * quadrant < 0, -1, 1)
    for axis in _BOUNDED[symmetry]:
        factor[:, axis] = outside[:, axis]
    if symmetry == "rotational":
        factor[:, 0] = factor[:, 1]
    return incident * factor, factor[:, None] * np.eye(3)


def measured_quadrant(incidents: Directions) -> Vector2:
    """Signs of x and y in the measured quarter or half of the hemisphere."""
    return np.where(incidents[:, :2].sum(axis=0) < -1e-9, -1.0, 1.0)


def within(
    triangles: Float[np.ndarray, "triangles 3 3"], symmetry: Symmetry, quadrant: Vector2
) -> Bool[np.ndarray, " triangles"]:
    """Mask of the triangles that overlap the measured part of the hemisphere."""
    reach = np.max(triangles[:, :, :2] * quadrant, axis=1) > 1e-6
    return np.asarray(reach[:, _BOUNDED[symmetry]].all(axis=1))
