"""Light on both sides of BSDF layers, for the choice of transmission or reflection.

A path that meets a blind from a dim room mostly returns to the room if it is sampled by
the BSDF alone, yet most of the light comes from outside. The ratio of the radiances on
both sides, measured in a pilot run, therefore changes the probabilities. An inexact
ratio increases noise but causes no bias.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.lower import LoweredScene
from clerestory.engine.materials.bsdf_file import expect
from clerestory.engine.origin import Origin
from clerestory.engine.pilot_paths import SurfacePoints
from clerestory.engine.sun_lobes import is_layer
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.surface import area_vectors

# Points on each side of the polygons of a material, and distance from the surface [m]
_POINTS, _BEFORE = 128, 1e-3

# Largest ratio of radiances; a larger one would leave too few paths to the dim side
_MOST = 8.0


@dataclass
class LayerPoints:
    """Points in front of and behind the layers of a scene.

    Attributes
    ----------
    names : names of the materials
    places : for each material, points in front, then as many behind
    """

    names: list[str]
    places: SurfacePoints

    @classmethod
    def of(cls, scene: Scene, origin: Origin) -> "LayerPoints":
        """Return points of the polygons of each layer, in proportion to their areas."""
        found: dict[str, list[Polygon]] = {}
        for surface in scene.surfaces:
            if isinstance(surface, Polygon):
                material = scene.materials[surface.material]
                if is_layer(material):
                    found.setdefault(surface.material, []).append(surface)
        sides = [_sides(polygons, origin) for polygons in found.values()]
        none = SurfacePoints(*(np.zeros((0, 3)) for _ in range(3)))
        return cls([*found], sum(sides, start=none))

    def apply(
        self, model: LoweredScene, irradiance: Float[np.ndarray, " place"]
    ) -> None:
        """Set the expected ratios of radiances of all layers, from pilot samples."""
        sides = irradiance.reshape(len(self.names), 2, _POINTS).mean(axis=2)
        ratios = {
            name: _ratio(front, behind)
            for name, (front, behind) in zip(self.names, sides, strict=True)
        }
        expect_ratios(model, ratios)


def expect_ratios(model: LoweredScene, ratios: dict[str, float]) -> None:
    """Set the ratios of the radiances behind and in front of layers, by material.

    The ratio of all other layers is 1.
    """
    index = dr.reinterpret_array(mi.UInt32, model.scene.shapes_dr()).numpy()
    layer = model.layer_of_shape.numpy()
    for shape, number in zip(model.scene.shapes(), index, strict=True):
        if layer[number]:
            name = str(model.name_of_shape[number])
            expect(shape.bsdf(), ratios.get(name, 1.0))


def _ratio(front: float, behind: float) -> float:
    if max(front, behind) == 0:
        return 1.0
    least = max(front, behind) / _MOST
    return max(behind, least) / max(front, least)


def _sides(polygons: list[Polygon], origin: Origin) -> SurfacePoints:
    # Points in front of and behind polygons, uniform over their triangles of a fan
    triangle = np.concatenate([_fan(p.vertices - origin) for p in polygons])
    vector = area_vectors(triangle.reshape(-1, 3), np.arange(len(triangle) + 1) * 3)
    area = np.linalg.norm(vector, axis=1)
    chosen = _evenly(area)
    random = np.random.default_rng(1).random((2, _POINTS, 1))
    u, v = np.where(random.sum(axis=0) > 1, 1 - random, random)
    a, b, c = np.moveaxis(triangle[chosen], 1, 0)
    point = a + u * (b - a) + v * (c - a)
    normal = vector[chosen] / area[chosen, None]
    both = [
        SurfacePoints(point, point + side * normal * _BEFORE, side * normal)
        for side in (1.0, -1.0)
    ]
    return both[0] + both[1]


def _fan(corner: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "triangle 3 3"]:
    first = np.broadcast_to(corner[0], corner[2:].shape)
    return np.stack([first, corner[1:-1], corner[2:]], axis=1)


def _evenly(area: Float[np.ndarray, " n"]) -> Int[np.ndarray, " point"]:
    # Index of a triangle for each point, by area
    edges = np.cumsum(area) / area.sum()
    place = (np.arange(_POINTS) + 0.5) / _POINTS
    return np.minimum(np.searchsorted(edges, place), len(area) - 1)
