"""Shirley–Chiu map between disc and square, in Dr.Jit arrays.

The map is the same as in `hemisphere.shirley_chiu`.
"""

import drjit as dr
import mitsuba as mi


def square_from_disc(x, y):
    """Map a point of the unit disc to the square [0, 1]²."""
    steep = dr.abs(y) > dr.abs(x)
    far, near = dr.select(steep, y, x), dr.select(steep, x, y)
    edge = dr.mulsign(0.5 * dr.sqrt(dr.square(x) + dr.square(y)), far)
    angle = dr.atan(near / dr.select(far == 0, 1, far))
    along = edge * angle * (4 * dr.inv_pi)
    return mi.Point2f(
        0.5 + dr.select(steep, along, edge), 0.5 + dr.select(steep, edge, along)
    )


def cell_of_disc(direction, edge: int):
    """Return the cell of a direction's disc point in a grid of edge² cells."""
    place = square_from_disc(direction.x, direction.y) * edge
    row = dr.clip(mi.Int32(place.x), 0, edge - 1)
    column = dr.clip(mi.Int32(place.y), 0, edge - 1)
    return mi.UInt32(row * edge + column)


def disc_from_square(a, b):
    """Map a point of the square [0, 1]² to the unit disc."""
    a, b = 2 * a - 1, 2 * b - 1
    steep = dr.abs(b) > dr.abs(a)
    radius, along = dr.select(steep, b, a), dr.select(steep, a, b)
    angle = (0.25 * dr.pi) * along / dr.select(radius == 0, 1, radius)
    sine, cosine = dr.sincos(angle)
    far, near = radius * cosine, radius * sine
    return mi.Point2f(dr.select(steep, near, far), dr.select(steep, far, near))
