"""Placement of included files by xform: transform, modifier, name prefix, inversion."""

from dataclasses import dataclass, field, replace

import numpy as np

from clerestory.radiance.statements import PolygonRun
from clerestory.scene.surface import Simple, Surface, transformed
from clerestory.scene.transform import Transform


@dataclass(frozen=True, eq=False)
class Placement:
    """Effect of an xform command; if `modifier` is None, surfaces keep their own."""

    transform: Transform = field(default_factory=Transform)
    modifier: str | None = None
    prefix: str = ""
    inverted: bool = False

    def then(self, outer: "Placement") -> "Placement":
        """Return the placement followed by an outer placement."""
        return Placement(
            self.transform.then(outer.transform),
            self.modifier if outer.modifier is None else outer.modifier,
            ".".join(p for p in (outer.prefix, self.prefix) if p),
            self.inverted != outer.inverted,
        )

    def name(self, name: str) -> str:
        """Return a surface name with the prefix of the placement."""
        return f"{self.prefix}.{name}" if self.prefix else name

    def polygons(self, run: PolygonRun) -> PolygonRun:
        """Return the polygons transformed and renamed."""
        vertices = self.transform.points(run.vertices)
        if self.transform.mirrored != self.inverted:
            # Reverses each polygon: vertex k of n becomes vertex n-1-k
            length = np.diff(run.first)
            flip = np.repeat(run.first[:-1] + run.first[1:] - 1, length)
            vertices = vertices[flip - np.arange(len(vertices))]
        name = [self.name(n) for n in run.name] if self.prefix else run.name
        modifier = run.modifier
        if self.modifier is not None:
            modifier = [self.modifier] * len(modifier)
        return replace(run, modifier=modifier, name=name, vertices=vertices)

    def surface(self, surface: Simple) -> Simple:
        """Return a surface transformed and renamed."""
        material = surface.material if self.modifier is None else self.modifier
        moved = transformed(surface, self.transform, inverted=self.inverted)
        return replace(moved, material=material, name=self.name(surface.name))

    def turned(self, surface: Surface) -> Surface:
        """Return the surface, which is already transformed; inverted if -I is set."""
        return transformed(surface, Transform(), inverted=self.inverted)
