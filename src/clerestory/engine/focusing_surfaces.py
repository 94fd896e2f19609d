"""Surfaces that refract or focus sunlight: sources of caustics.

Mirror images (`mirror_images`) and lobes of flat surfaces (`sun_lobes`) bring the
sunlight of other smooth surfaces.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from clerestory.engine.narrow_highlights import (
    highlights,
    kind_of,
    narrow_roughness,
    with_parts,
)
from clerestory.engine.origin import Origin
from clerestory.engine.smooth_faces import SmoothFaces
from clerestory.scene.model import (
    Cone,
    Dielectric,
    Interface,
    Material,
    Scene,
    Sphere,
    Surface,
    Textured,
)
from clerestory.scene.tessellate import meshes

NARROW = "surfaces of narrow highlights"


def focusing_kind(surface: Surface, material: Material) -> str | None:
    """Return how a surface refracts or focuses sunlight; None if it does not."""
    if any(isinstance(part, Dielectric | Interface) for part in with_parts(material)):
        return "refracting surfaces"
    for part in with_parts(material):
        if isinstance(part, Textured) and part.base.mirrored > 0:
            return "smooth surfaces of perturbed normals"
    if material.mirrored > 0:
        return "curved smooth surfaces" if isinstance(surface, Sphere | Cone) else None
    return NARROW if len(narrow_roughness(material)) else None


def focusing_triangles(
    scene: Scene, smooth: SmoothFaces, origin: Origin
) -> Float[np.ndarray, "triangle 3 3"]:
    """Return the triangles of surfaces that refract or focus sunlight [m]."""
    sampled = highlights(scene)
    chosen = []
    for surface in scene.surfaces:
        kind = focusing_kind(surface, scene.materials[surface.material])
        if kind is not None and not (
            kind == NARROW and kind_of(surface, scene) in sampled
        ):
            chosen.append(surface)
    found = [smooth.corner[smooth.clusters(distant=True) < 0]]
    if chosen:
        made = meshes(replace(scene, surfaces=tuple(chosen)))
        found += [mesh.vertices[mesh.faces] - origin for mesh in made]
    return np.concatenate(found)
