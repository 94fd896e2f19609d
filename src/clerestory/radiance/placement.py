"""Where an included file goes: what xform does to the surfaces that pass through it."""

from dataclasses import dataclass, field, replace

import numpy as np

from clerestory.radiance.statements import PolygonRun
from clerestory.scene.surface import Simple, Surface, transformed
from clerestory.scene.transform import Transform


@dataclass(frozen=True, eq=False)
class Placement:
    """One passage through xform.

    Attributes
    ----------
    transform : where points go
    modifier : replaces the modifier of surfaces, if given
    prefix : stands before the names of surfaces
    inverted : whether fronts become backs (-I)
    """

    transform: Transform = field(default_factory=Transform)
    modifier: str | None = None
    prefix: str = ""
    inverted: bool = False

    def then(self, outer: "Placement") -> "Placement":
        """Return this placement followed by another."""
        return Placement(
            self.transform.then(outer.transform),
            self.modifier if outer.modifier is None else outer.modifier,
            ".".join(p for p in (outer.prefix, self.prefix) if p),
            self.inverted != outer.inverted,
        )

    def name(self, name: str) -> str:
        """Return the name a surface gets."""
        return f"{self.prefix}.{name}" if self.prefix else name

    def polygons(self, run: PolygonRun) -> PolygonRun:
        """Return the polygons in their place."""
        vertices = self.transform.points(run.vertices)
        if self.transform.mirrored != self.inverted:
            # Reverse each polygon: vertex k of n becomes vertex n-1-k
            length = np.diff(run.first)
            flip = np.repeat(run.first[:-1] + run.first[1:] - 1, length)
            vertices = vertices[flip - np.arange(len(vertices))]
        return PolygonRun(
            run.modifier
            if self.modifier is None
            else [self.modifier] * len(run.modifier),
            [self.name(n) for n in run.name] if self.prefix else run.name,
            run.line,
            run.first,
            vertices,
        )

    def surface(self, surface: Simple) -> Simple:
        """Return the surface in its place."""
        material = surface.material if self.modifier is None else self.modifier
        moved = transformed(surface, self.transform, inverted=self.inverted)
        return replace(moved, material=material, name=self.name(surface.name))

    def turned(self, surface: Surface) -> Surface:
        """Return a surface that is in its place already, inverted if -I says so."""
        return transformed(surface, Transform(), inverted=self.inverted)
