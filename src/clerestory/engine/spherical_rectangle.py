"""Parallelograms and triangles in kernels; rectangles sampled by solid angle.

Reference: C. Ureña, M. Fajardo, A. King, "An area-preserving parametrization for
spherical rectangles", Computer Graphics Forum 32 (4), 2013.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.upload import vectors

# Rectangles that subtend a smaller solid angle [sr] are sampled by area.
_SMALL = 0.02


@dataclass
class Parallelograms:
    """Parallelograms, each spanned by two edges from a corner [m]."""

    corner: mi.Point3f
    edge_u: mi.Vector3f
    edge_v: mi.Vector3f

    @classmethod
    def of(
        cls,
        corner: Float[np.ndarray, "n 3"],
        edge_u: Float[np.ndarray, "n 3"],
        edge_v: Float[np.ndarray, "n 3"],
    ) -> "Parallelograms":
        """Return parallelograms as Dr.Jit arrays."""
        edges = (vectors(mi.Vector3f, edge) for edge in (edge_u, edge_v))
        return cls(vectors(mi.Point3f, corner), *edges)

    def take(self, number) -> "Parallelograms":
        """Return the parallelograms with the given indices."""
        return dr.gather(Parallelograms, self, number)

    def point(self, u, v) -> mi.Point3f:
        """Return the points with the given coordinates along the edges, 0…1."""
        return self.corner + self.edge_u * u + self.edge_v * v

    def seen_from(self, origin, rectangle) -> "SphericalRectangle":
        """Return the spherical rectangles, as seen from a point."""
        corner = self.corner - origin
        return SphericalRectangle.of(corner, self.edge_u, self.edge_v, rectangle)


def fold(u, v, triangle=True):
    """Map a uniform point of the unit square to the triangle u + v < 1."""
    outside = triangle & (u + v > 1)
    return dr.select(outside, 1 - u, u), dr.select(outside, 1 - v, v)


@dataclass
class SphericalRectangle:
    """A rectangle as seen from a reference point; symbols as in the paper.

    Attributes
    ----------
    right, up, axis : local axes; `axis` points from the rectangle's plane to the
        reference point
    x0, x1, y0, y1 : limits of the rectangle in local coordinates [m]
    depth : local z coordinate of the rectangle's plane, negative (the paper's z0) [m]
    b0, b1, k : constants of the parametrization
    usable : whether the rectangle is sampled by solid angle, not by area
    """

    right: mi.Vector3f
    up: mi.Vector3f
    axis: mi.Vector3f
    x0: mi.Float
    x1: mi.Float
    y0: mi.Float
    y1: mi.Float
    depth: mi.Float
    b0: mi.Float
    b1: mi.Float
    k: mi.Float
    solid_angle: mi.Float
    usable: mi.Bool

    @classmethod
    def of(cls, corner, edge_u, edge_v, rectangle) -> "SphericalRectangle":
        """Return the spherical rectangle of a corner and two edges [m].

        The corner is relative to the reference point. If `rectangle` is false, the
        element is a triangle or an oblique parallelogram, and is sampled by area.
        """
        width, height = dr.norm(edge_u), dr.norm(edge_v)
        right, up = edge_u / width, edge_v / height
        axis = dr.cross(right, up)
        depth = dr.dot(corner, axis)
        axis = dr.select(depth > 0, -axis, axis)
        depth = -dr.abs(depth)
        x0, y0 = dr.dot(corner, right), dr.dot(corner, up)
        x1, y1 = x0 + width, y0 + height

        # Inner angles of the spherical rectangle, from the normals of its edge planes
        z2 = dr.square(depth)
        n0 = -y0 * dr.rsqrt(z2 + dr.square(y0))
        n1 = x1 * dr.rsqrt(z2 + dr.square(x1))
        n2 = y1 * dr.rsqrt(z2 + dr.square(y1))
        n3 = -x0 * dr.rsqrt(z2 + dr.square(x0))
        g0, g1 = dr.acos(-n0 * n1), dr.acos(-n1 * n2)
        g2, g3 = dr.acos(-n2 * n3), dr.acos(-n3 * n0)
        k = 2 * dr.pi - g2 - g3
        solid_angle = g0 + g1 - k
        usable = rectangle & (solid_angle > _SMALL) & (depth < -1e-4)
        return cls(
            right, up, axis, x0, x1, y0, y1, depth, n0, n2, k, solid_angle, usable
        )

    def sample(self, u, v):
        """Return the local coordinates of a point of the rectangle [m]."""
        angle = u * self.solid_angle + self.k
        sine, cosine = dr.sincos(angle)
        f = (cosine * self.b0 - self.b1) / sine
        c = dr.mulsign(dr.rsqrt(dr.square(f) + dr.square(self.b0)), f)
        x = -c * self.depth * dr.rsqrt(dr.maximum(1 - dr.square(c), 1e-7))
        x = dr.select(x < self.x0, self.x0, dr.select(x > self.x1, self.x1, x))
        d2 = dr.square(x) + dr.square(self.depth)
        h0 = self.y0 * dr.rsqrt(d2 + dr.square(self.y0))
        h1 = self.y1 * dr.rsqrt(d2 + dr.square(self.y1))
        h = h0 + v * (h1 - h0)
        y = h * dr.sqrt(d2) * dr.rsqrt(dr.maximum(1 - dr.square(h), 1e-7))
        return x, dr.select(y < self.y0, self.y0, dr.select(y > self.y1, self.y1, y))
