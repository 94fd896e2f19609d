"""Light of small sources that is found by chance, without next-event estimation.

Suns and small emitters are sampled directly and by way of flat smooth surfaces, suns by
way of all others too (`learned_caustics`). Light of small emitters by way of curved
smooth surfaces, perturbed normals, narrow highlights and refracting solids (caustics),
and light that is reflected very many times, is found by BSDF sampling only. Few paths
find it; if none does in a run, the standard errors do not include it.
"""

import warnings
from dataclasses import replace

import numpy as np
from jaxtyping import Int

from clerestory.engine.focusing_surfaces import focusing_kind
from clerestory.engine.image_compositions import Compositions
from clerestory.engine.sampled_sources import is_sampled, suns_of
from clerestory.engine.smooth_faces import MOST, SmoothFaces
from clerestory.errors import ClerestoryWarning
from clerestory.scene.model import (
    Emitter,
    Scene,
    Surface,
    extent,
)
from clerestory.scene.tessellate import meshes

# Largest dimension of a small emitter [m].
_SMALL = 1.0

# Largest reflectance of images by several reflections that may be missing.
_FAINT = 0.02


def warn_of_unsampled_light(scene: Scene) -> None:
    """Warn if light of small sources in a scene is found by chance only."""
    suns = bool(suns_of(scene))
    lamps = any(_is_small(each, scene) for each in scene.surfaces)
    if not (suns or lamps):
        return
    for source, found in (
        ("the sun", _many_times(scene, distant=True) if suns else {}),
        ("small luminaires", _by_chance(scene) if lamps else {}),
    ):
        texts = [
            f'{len(names)} {kind} (material "{names[0]}")'
            for kind, names in found.items()
        ]
        if texts:
            warnings.warn(
                f"light of {source} by way of {' and '.join(texts)} is found by chance;"
                " standard errors may be too small to include it",
                ClerestoryWarning,
                stacklevel=4,
            )


def _by_chance(scene: Scene) -> dict[str, list[str]]:
    # Materials of the surfaces by way of which lamps are not sampled, by kind
    found: dict[str, list[str]] = {}
    for surface in scene.surfaces:
        kind = focusing_kind(surface, scene.materials[surface.material])
        if kind is not None:
            found.setdefault(kind, []).append(surface.material)
    flat, surface, faces = _flat_mirrors(scene)
    left = faces.clusters(distant=False) < 0
    if left.any():
        beyond = np.unique(surface[faces.face[left]])
        names = [flat[number].material for number in beyond]
        found[f"smooth surfaces beyond the {MOST} largest planes"] = names
    return found | _many_times(scene, distant=False)


def _many_times(scene: Scene, *, distant: bool) -> dict[str, list[str]]:
    # Materials of mirrors whose images by several reflections are too many
    flat, _, faces = _flat_mirrors(scene)
    if Compositions.of(faces.planes(distant=distant)).missing <= _FAINT:
        return {}
    flat.sort(key=lambda each: -scene.materials[each.material].mirrored)
    names = [each.material for each in flat]
    return {"smooth surfaces that mirror each other many times": names}


def _flat_mirrors(
    scene: Scene,
) -> tuple[list[Surface], Int[np.ndarray, " face"], SmoothFaces]:
    # Flat smooth surfaces, the index of the surface of each face, and the faces
    flat = [
        each
        for each in scene.surfaces
        if scene.materials[each.material].mirrored > 0
        and focusing_kind(each, scene.materials[each.material]) is None
    ]
    tessellated = meshes(replace(scene, surfaces=tuple(flat)))
    surface = np.concatenate([np.zeros(0, int), *(m.surface for m in tessellated)])
    first = np.cumsum([0, *(len(mesh.faces) for mesh in tessellated)])
    numbered = list(zip(first.tolist(), tessellated, strict=False))
    return flat, surface, SmoothFaces.of(len(surface), numbered, np.zeros(3))


def _is_small(surface: Surface, scene: Scene) -> bool:
    material = scene.materials[surface.material]
    if not isinstance(material, Emitter) or not is_sampled(material):
        return False
    return bool(np.ptp(extent(surface), axis=0).max() <= _SMALL)
