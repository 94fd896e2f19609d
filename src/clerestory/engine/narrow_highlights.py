"""Flat surfaces with narrow highlights, in which the sun is sampled (`sun_lobes`)."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from clerestory.scene.material import Material, parts
from clerestory.scene.model import Polygon, Scene, Surface, Textured
from clerestory.scene.surface import area_vectors

# Greatest number of orientations and roughnesses, the largest in area.
_MOST = 4

# Largest roughness of narrow highlights; smallest one at which shadow rays bring nearly
# all sunlight, and not sampling of the highlight, which is as narrow as the sun below;
# smallest of rough surfaces (normal.c, SP_PURE).
_NARROW, _LEAST, _SMOOTHEST = 0.05, 0.01, 1e-3

# Roughness, and normal
Kind = tuple[float, tuple[float, float, float]]


def highlights(scene: Scene) -> dict[Kind, float]:
    """Return the largest narrow highlights of a scene, and their areas [m²]."""
    found: dict[Kind, float] = {}
    for surface in scene.surfaces:
        kind = kind_of(surface, scene)
        if kind is not None:
            found[kind] = found.get(kind, 0) + float(np.linalg.norm(_vector(surface)))
    largest = sorted(found, key=lambda kind: -found[kind])[:_MOST]
    return {kind: found[kind] for kind in largest}


def kind_of(surface: Surface, scene: Scene) -> Kind | None:
    """Return roughness and normal of a flat surface with a narrow round highlight."""
    material = scene.materials[surface.material]
    rough = narrow_roughness(material)
    bent = any(isinstance(part, Textured) for part in with_parts(material))
    if rough.size != 1 or rough[0] < _LEAST or bent or not isinstance(surface, Polygon):
        return None
    normal = _vector(surface)
    normal /= max(float(np.linalg.norm(normal)), 1e-30)
    # Both sides of a surface are of one kind
    normal *= -1.0 if normal @ [0.5377, 0.6123, 0.5796] < 0 else 1.0
    first, second, third = np.round(normal, 5).tolist()
    return float(rough[0]), (first, second, third)


def narrow_roughness(material: Material) -> Float[np.ndarray, " value"]:
    """Return the roughness of narrow highlights; two values if it is elliptical."""
    found = [np.zeros(0)]
    for part in with_parts(material):
        rough = np.ravel(getattr(part, "roughness", 0.0))
        if getattr(part, "specularity", 0.0) > 0 and _SMOOTHEST < rough.max() < _NARROW:
            found.append(rough)
    return np.unique(np.concatenate(found))


def with_parts(material: Material) -> Iterator[Material]:
    """Yield a material and all materials of which it is composed."""
    yield material
    for part in parts(material):
        yield from with_parts(part)


def _vector(surface: Polygon) -> Float[np.ndarray, "3"]:
    corners = surface.vertices
    return area_vectors(corners, np.array([0, len(corners)]))[0]
