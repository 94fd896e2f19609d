"""Scenes for rays that meet the BSDF of a proxy, not the geometry that it stands for.

Rays that a sensor sends into its hemisphere are indirect: Radiance's material BSDF
scatters them where the sensor is on the side of a proxy that scatters. A proxy is the
surface of a BSDF with a thickness.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.array_types import Vector
from clerestory.scene.materials.bsdf_surface import BsdfSurface
from clerestory.scene.model import Scene
from clerestory.scene.surface import Polygon, area_vector, extent

# Distance up to which geometry may exceed a proxy that stands for it, as a fraction of
# the thickness of the proxy
_MARGIN = 0.05


def scattering_scenes(
    scene: Scene, places: Float[np.ndarray, "place 3"]
) -> Iterator[tuple[Int[np.ndarray, " some"], Scene]]:
    """Yield places [m] with the scene in which proxies scatter the rays from there.

    A proxy whose scattering side faces the place scatters without thickness, and what
    it stands for is left out. Rays from the place pass other proxies, which are left
    out too.
    """
    proxies = _proxies(scene)
    facing = np.array([_faced(proxy, places) for proxy in proxies])
    facing = facing.reshape(len(proxies), len(places)).T
    cases, of_place = np.unique(facing, axis=0, return_inverse=True)
    for number, case in enumerate(cases):
        yield (
            np.nonzero(of_place.ravel() == number)[0],
            _opened(scene, proxies, case) if len(proxies) else scene,
        )


# A polygon, its unit normal and its thickness [m]
_Proxy = tuple[Polygon, Vector, float]


def _proxies(scene: Scene) -> list[_Proxy]:
    found = []
    for surface in scene.surfaces:
        material = scene.materials[surface.material]
        if (
            isinstance(surface, Polygon)
            and isinstance(material, BsdfSurface)
            and material.thickness
        ):
            normal = area_vector(surface.vertices)
            unit = normal / np.linalg.norm(normal)
            found.append((surface, unit, material.thickness))
    return found


def _faced(
    proxy: _Proxy, places: Float[np.ndarray, "place 3"]
) -> Bool[np.ndarray, " place"]:
    # Geometry is behind the front of a positive thickness, which then scatters
    polygon, normal, thickness = proxy
    return np.asarray((places - polygon.vertices[0]) @ normal * thickness > 0)


def _opened(
    scene: Scene, proxies: list[_Proxy], faced: Bool[np.ndarray, " proxy"]
) -> Scene:
    scatter = [proxy for proxy, here in zip(proxies, faced, strict=True) if here]
    thin = {polygon.material for polygon, _, _ in scatter}
    passed = {id(p) for (p, _, _), here in zip(proxies, faced, strict=True) if not here}
    materials = {
        key: replace(m, thickness=0.0)
        if isinstance(m, BsdfSurface) and key in thin
        else m
        for key, m in scene.materials.items()
    }
    kept = [
        surface
        for surface in scene.surfaces
        if id(surface) not in passed
        and (surface.material in thin or not _proxied(extent(surface), scatter))
    ]
    return replace(scene, materials=materials, surfaces=tuple(kept))


def _proxied(points: Float[np.ndarray, "point 3"], proxies: list[_Proxy]) -> bool:
    # Whether all points are in the thickness behind or in front of a proxy
    for polygon, normal, thickness in proxies:
        margin = _MARGIN * abs(thickness)
        depth = (polygon.vertices[0] - points) @ normal * np.sign(thickness)
        near = (depth >= -margin) & (depth <= abs(thickness) + margin)
        flat = points + np.outer(depth * np.sign(thickness), normal)
        low, high = polygon.vertices.min(axis=0), polygon.vertices.max(axis=0)
        inside = (flat >= low - margin) & (flat <= high + margin)
        if near.all() and inside.all():
            return True
    return False
