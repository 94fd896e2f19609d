"""Light of small sources that is found by chance, without next-event estimation.

Suns and small emitters are sampled directly and by way of flat smooth surfaces. Their
light by way of curved smooth surfaces, perturbed normals, narrow highlights, refracting
solids (caustics) and very many reflections is found by BSDF sampling only. Few paths
find it; if none does in a run, the standard errors do not include it.
"""

import warnings
from dataclasses import replace

import numpy as np

from clerestory.engine.image_compositions import Compositions
from clerestory.engine.narrow_highlights import (
    highlights,
    kind_of,
    narrow_roughness,
    with_parts,
)
from clerestory.engine.sampled_sources import is_sampled, suns_of
from clerestory.engine.smooth_faces import MOST, SmoothFaces
from clerestory.errors import ClerestoryWarning
from clerestory.scene.model import (
    Cone,
    Dielectric,
    Emitter,
    Interface,
    Material,
    Scene,
    Sphere,
    Surface,
    Textured,
    extent,
)
from clerestory.scene.tessellate import meshes

# Largest dimension of a small emitter [m].
_SMALL = 1.0

_NARROW = "surfaces of narrow highlights"

# Largest reflectance of images by several reflections that may be missing.
_FAINT = 0.02


def warn_of_unsampled_light(scene: Scene) -> None:
    """Warn if light of small sources in a scene is found by chance only."""
    suns = bool(suns_of(scene))
    lamps = any(_is_small(each, scene) for each in scene.surfaces)
    if not (suns or lamps):
        return
    found = [
        f'{len(names)} {kind} (material "{names[0]}")'
        for kind, names in _by_chance(scene, suns=suns, lamps=lamps).items()
    ]
    if found:
        source = "the sun" if suns else "small luminaires"
        warnings.warn(
            f"light of {source} by way of {' and '.join(found)} is found by chance;"
            " standard errors may be too small to include it",
            ClerestoryWarning,
            stacklevel=4,
        )


def _by_chance(scene: Scene, *, suns: bool, lamps: bool) -> dict[str, list[str]]:
    # Materials of the surfaces that have no sampling technique, by kind
    found: dict[str, list[str]] = {}
    flat: list[Surface] = []
    sampled = {} if lamps else highlights(scene)
    for surface in scene.surfaces:
        kind = _kind(surface, scene.materials[surface.material])
        if kind == _NARROW and kind_of(surface, scene) in sampled:
            continue
        if kind is not None:
            found.setdefault(kind, []).append(surface.material)
        elif scene.materials[surface.material].mirrored > 0:
            flat.append(surface)
    tessellated = meshes(replace(scene, surfaces=tuple(flat)))
    surface = np.concatenate([np.zeros(0, int), *(m.surface for m in tessellated)])
    first = np.cumsum([0, *(len(mesh.faces) for mesh in tessellated)])
    numbered = list(zip(first.tolist(), tessellated, strict=False))
    faces = SmoothFaces.of(len(surface), numbered, np.zeros(3))
    for distant, present in ((True, suns), (False, lamps)):
        if not present:
            continue
        left = faces.clusters(distant=distant) < 0
        if left.any():
            beyond = np.unique(surface[faces.face[left]])
            names = [flat[number].material for number in beyond]
            found[f"smooth surfaces beyond the {MOST} largest planes"] = names
        missing = Compositions.of(faces.planes(distant=distant)).missing
        if missing > _FAINT:
            flat.sort(key=lambda each: -scene.materials[each.material].mirrored)
            names = [each.material for each in flat]
            found["smooth surfaces that mirror each other many times"] = names
        if found:
            break
    return found


def _kind(surface: Surface, material: Material) -> str | None:
    if any(isinstance(part, Dielectric | Interface) for part in with_parts(material)):
        return "refracting surfaces"
    for part in with_parts(material):
        if isinstance(part, Textured) and part.base.mirrored > 0:
            return "smooth surfaces of perturbed normals"
    if material.mirrored > 0:
        return "curved smooth surfaces" if isinstance(surface, Sphere | Cone) else None
    return _NARROW if len(narrow_roughness(material)) else None


def _is_small(surface: Surface, scene: Scene) -> bool:
    material = scene.materials[surface.material]
    if not isinstance(material, Emitter) or not is_sampled(material):
        return False
    return bool(np.ptp(extent(surface), axis=0).max() <= _SMALL)
