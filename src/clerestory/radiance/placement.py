"""Placement of included files by xform: transform, modifier, name prefix, inversion."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Int

from clerestory.radiance.statements import PolygonRun
from clerestory.scene.surface import Simple, Surface, transformed
from clerestory.scene.transform import Transform, Transforms, single


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
            _joined(outer.prefix, self.prefix),
            self.inverted != outer.inverted,
        )

    def name(self, name: str) -> str:
        """Return a surface name with the prefix of the placement."""
        return f"{self.prefix}.{name}" if self.prefix else name

    def polygons(self, run: PolygonRun) -> PolygonRun:
        """Return the polygons transformed and renamed."""
        vertices = self.transform.points(run.vertices)
        if self.transform.mirrored != self.inverted:
            vertices = vertices[_reversal(run)]
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


@dataclass(frozen=True, eq=False)
class Placements:
    """Placements of the copies of an array, which differ in transform and prefix."""

    transform: Transforms
    prefix: list[str]
    modifier: str | None = None
    inverted: bool = False

    def __len__(self) -> int:
        return len(self.transform)

    def __iter__(self) -> Iterator[Placement]:
        for copy, prefix in enumerate(self.prefix):
            yield Placement(self.transform[copy], self.modifier, prefix, self.inverted)

    def then(self, outer: "Placements") -> "Placements":
        """Return each placement followed by each of `outer`, whose index is slowest."""
        return Placements(
            self.transform.then(outer.transform),
            [_joined(o, own) for o in outer.prefix for own in self.prefix],
            self.modifier if outer.modifier is None else outer.modifier,
            self.inverted != outer.inverted,
        )

    def polygons(self, run: PolygonRun) -> PolygonRun:
        """Return the polygons of all copies, one copy after the other."""
        if len(self) == 1:
            return next(iter(self)).polygons(run)
        matrix, copies, count = self.transform.matrix, len(self), len(run.vertices)
        vertices = run.vertices @ matrix[:, :3, :3] + matrix[:, 3:, :3]
        reverse = self.transform.mirrored != self.inverted
        if reverse.any():
            vertices[reverse] = vertices[reverse][:, _reversal(run)]
        ends = run.first[1:] + count * np.arange(copies)[:, None]
        modifier = run.modifier
        if self.modifier is not None:
            modifier = [self.modifier] * len(modifier)
        return PolygonRun(
            modifier * copies,
            [f"{p}.{name}" if p else name for p in self.prefix for name in run.name],
            run.source * copies,
            np.append(0, ends.ravel()),
            vertices.reshape(-1, 3),
        )


def one_placement(placement: Placement) -> Placements:
    """Return a placement as an array of one copy."""
    transform = single(placement.transform)
    modifier, inverted = placement.modifier, placement.inverted
    return Placements(transform, [placement.prefix], modifier, inverted)


def _joined(outer: str, inner: str) -> str:
    return ".".join(prefix for prefix in (outer, inner) if prefix)


def _reversal(run: PolygonRun) -> Int[np.ndarray, " vertices"]:
    # Index that reverses each polygon: vertex k of n becomes vertex n-1-k
    flip = np.repeat(run.first[:-1] + run.first[1:] - 1, np.diff(run.first))
    return np.asarray(flip - np.arange(len(run.vertices)))
