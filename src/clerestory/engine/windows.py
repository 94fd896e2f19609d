"""Windows as receivers: sampling of directions to windows, and patches of directions.

A window is divided into rectangles and triangles, its elements. Rectangles are sampled
by the solid angle they subtend (`spherical_rectangle`), so that the variance does not
increase near a window. Triangles are sampled by area, as are distant rectangles, whose
solid angle is inaccurate in single precision.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.origin import Origin
from clerestory.engine.patches import PatchTable
from clerestory.engine.sampler import Distribution
from clerestory.engine.spherical_rectangle import (
    Parallelograms,
    SphericalRectangle,
    fold,
)
from clerestory.engine.upload import on_device, vectors
from clerestory.scene.surface import is_parallelogram
from clerestory.scene.triangulate import triangulate
from clerestory.scene.window import Window


@dataclass
class WindowTable:
    """Dr.Jit arrays of the windows, and of their elements.

    Attributes
    ----------
    elements, rectangle : corner and edges of each element; true for rectangles
    chosen, area : distribution of the elements by area, and their total area [m²]
    window : index of each element's window
    first_element : index of each window's first element; an element has two faces
    facing : normal of each element, of the frame unless its window is faceted
    facets : normals times areas [m²], if a window is faceted
    right, up, normal : unit vectors of each window's frame
    first, tables : matrix column of each window's first patch, and the partition
    columns : number of patches of all windows
    """

    elements: Parallelograms
    rectangle: mi.Bool
    chosen: Distribution
    area: mi.Float
    window: mi.UInt32
    first_element: mi.UInt32
    facing: mi.Vector3f
    facets: mi.Vector3f | None
    right: mi.Vector3f
    up: mi.Vector3f
    normal: mi.Vector3f
    first: mi.UInt32
    tables: list[PatchTable]
    columns: int

    def find(self, window, direction):
        """Return the matrix column of a direction that leaves a window."""
        local = self.to_local(window, direction)
        patch = self.tables[0].find(local)
        for number, table in enumerate(self.tables[1:], start=1):
            if table is not self.tables[0]:
                patch = dr.select(window == number, table.find(local), patch)
        return dr.gather(mi.UInt32, self.first, window) + patch

    def to_local(self, window, direction):
        """Transform a direction of the scene to the frame of a window."""
        axes = (self.right, self.up, self.normal)
        return mi.Vector3f(
            *(dr.dot(dr.gather(mi.Vector3f, axis, window), direction) for axis in axes)
        )

    def to_scene(self, window, local):
        """Transform a direction from the frame of a window to the scene."""
        direction = dr.gather(mi.Vector3f, self.right, window) * local.x
        direction += dr.gather(mi.Vector3f, self.up, window) * local.y
        return direction + dr.gather(mi.Vector3f, self.normal, window) * local.z

    def sample_point(self, u, v):
        """Sample a point uniformly by area on all windows; return it and its window."""
        element, _, u = self.chosen.sample(u)
        triangle = ~dr.gather(mi.Bool, self.rectangle, element)
        point = self.elements.take(element).point(*fold(u, v, triangle))
        return point, dr.gather(mi.UInt32, self.window, element)

    def sample_point_along(self, direction, u, v):
        """Sample a point uniformly by the area of one window seen along a direction.

        The direction is that of light which enters. Areas of polygons of one normal
        have constant ratios, so that they are sampled by area.
        """
        if self.facets is None:
            return self.sample_point(u, v)[0]
        element, rest = _facet_along(self.facets, direction, u)
        triangle = ~dr.gather(mi.Bool, self.rectangle, element)
        return self.elements.take(element).point(*fold(rest, v, triangle))

    def shines(self, window, direction):
        """Whether light that leaves a window in a direction is in one of its patches.

        It always is if it leaves the front of a window that is not faceted.
        """
        if self.facets is None:
            return mi.Bool(True)
        return dr.dot(dr.gather(mi.Vector3f, self.normal, window), direction) > 1e-6

    def sample_direction(self, origin, u, v):
        """Sample a direction from a point to the windows, regardless of visibility.

        Return the sampled point, the direction to it, its window, the cosine of the
        angle between the normal at the point and the reversed direction, and the
        density of the direction [1/sr].
        """
        element, _, rest = self.chosen.sample(u)
        by_area, window = self.sample_point(u, v)
        view = self._view(origin, element)
        x, y = view.sample(rest, v)
        point = origin + view.right * x + view.up * y + view.axis * view.depth
        point = dr.select(view.usable, point, by_area)
        direction = dr.normalize(point - origin)
        cosine = -dr.dot(direction, dr.gather(mi.Vector3f, self.facing, element))
        pdf = self._pdf(element, view, dr.squared_norm(point - origin), cosine)
        return point, direction, window, cosine, pdf

    def pdf(self, origin, element, point, cosine):
        """Return the density of sampling the direction to a point of an element [1/sr].

        `cosine` is that of the angle between its normal and the reversed direction.
        """
        view = self._view(origin, element)
        return self._pdf(element, view, dr.squared_norm(point - origin), cosine)

    def _pdf(self, element, view: SphericalRectangle, distance2, cosine):
        share = self.chosen.probability(element)
        by_area = distance2 / (dr.maximum(cosine, 1e-6) * self.area)
        return dr.select(view.usable, share / view.solid_angle, by_area)

    def _view(self, origin, element) -> SphericalRectangle:
        rectangle = dr.gather(mi.Bool, self.rectangle, element)
        return self.elements.take(element).seen_from(origin, rectangle)


@dataclass
class _Element:
    corner: Float[np.ndarray, "3"]
    edge_u: Float[np.ndarray, "3"]
    edge_v: Float[np.ndarray, "3"]
    rectangle: bool

    def faces(self) -> Float[np.ndarray, "2 3 3"]:
        """Return two triangular faces; the second face of a triangle has zero area."""
        a, b, d = self.corner, self.corner + self.edge_u, self.corner + self.edge_v
        c = b + self.edge_v if self.rectangle else d
        return np.array([[a, b, c], [a, c, d]])


@dr.syntax
def _facet_along(facets: mi.Vector3f, direction: mi.Vector3f, u: mi.Float):
    # Choose a facet by its area as seen along a direction; return its index, and `u`
    # rescaled to [0, 1)
    count, number = dr.opaque(mi.UInt32, dr.width(facets)), mi.UInt32(0)
    total = mi.Float(0)
    while number < count:
        total += dr.maximum(
            dr.dot(dr.gather(mi.Vector3f, facets, number), direction), 0
        )
        number += 1
    left, chosen, share = u * total, mi.UInt32(0), mi.Float(1)
    number = mi.UInt32(0)
    searching = mi.Bool(True)
    while searching & (number < count):
        area = dr.maximum(dr.dot(dr.gather(mi.Vector3f, facets, number), direction), 0)
        if area > 0:
            chosen, share = mi.UInt32(number), mi.Float(area)
        searching = (area == 0) | (left >= area)
        left = dr.select(searching, left - area, left)
        number += 1
    return chosen, dr.clip(left / share, 0, 0.9999999)


def window_shapes(
    windows: Sequence[Window], origin: Origin
) -> tuple[
    WindowTable | None, list[tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"]]]
]:
    """Return the Dr.Jit arrays of windows, and vertices and faces of their shapes.

    Each element has two faces, in the order of the elements.
    """
    if not windows:
        return None, []
    elements = [_elements(window) for window in windows]
    faces = [np.concatenate([e.faces() for e in own]) - origin for own in elements]
    shapes = [
        (corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
        for corners in faces
    ]
    return _table(windows, elements, origin), shapes


def _elements(window: Window) -> list[_Element]:
    # Keep rectangles, and triangulate all other polygons
    found = []
    for polygon in window.polygons:
        v = polygon.vertices
        u_edge, v_edge = v[1] - v[0], v[3 % len(v)] - v[0]
        size = np.linalg.norm(u_edge) * np.linalg.norm(v_edge)
        upright = abs(np.dot(u_edge, v_edge)) < 1e-5 * size
        if len(v) == 4 and upright and is_parallelogram(v):
            found.append(_Element(v[0], u_edge, v_edge, True))
            continue
        filled = triangulate(v)
        corners = filled.vertices[filled.faces]
        found.extend(_Element(a, b - a, c - a, False) for a, b, c in corners)
    return found


def _table(
    windows: Sequence[Window], elements: list[list[_Element]], origin: Origin
) -> WindowTable:
    flat = [element for own in elements for element in own]
    corner = np.array([e.corner for e in flat])
    edge_u = np.array([e.edge_u for e in flat])
    edge_v = np.array([e.edge_v for e in flat])
    rectangle = np.array([e.rectangle for e in flat])
    area = np.linalg.norm(np.cross(edge_u, edge_v), axis=1)
    area = area * np.where(rectangle, 1, 0.5)
    per_window = np.array([len(own) for own in elements])
    facing = np.repeat([w.frame.normal for w in windows], per_window, axis=0)
    faceted = np.repeat([w.faceted for w in windows], per_window)
    across = np.cross(edge_u, edge_v)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    facing = np.where(faceted[:, None], across, facing)
    count = np.array([len(w.partition) for w in windows])

    # Windows with equal partitions share a table
    tables: list[PatchTable] = []
    for number, window in enumerate(windows):
        own = window.partition
        like = [k for k in range(number) if windows[k].partition.matches(own)]
        tables.append(tables[like[0]] if like else PatchTable.of(own))
    return WindowTable(
        elements=Parallelograms.of(corner - origin, edge_u, edge_v),
        rectangle=on_device(mi.Bool, rectangle),
        chosen=Distribution.of(area),
        area=on_device(mi.Float, area.sum()),
        window=on_device(mi.UInt32, np.repeat(np.arange(len(windows)), per_window)),
        first_element=on_device(mi.UInt32, np.cumsum(per_window) - per_window),
        facing=vectors(mi.Vector3f, facing),
        facets=vectors(mi.Vector3f, facing * area[:, None]) if faceted.any() else None,
        right=vectors(mi.Vector3f, np.array([w.frame.right for w in windows])),
        up=vectors(mi.Vector3f, np.array([w.frame.up for w in windows])),
        normal=vectors(mi.Vector3f, np.array([w.frame.normal for w in windows])),
        first=on_device(mi.UInt32, np.cumsum(count) - count),
        tables=tables,
        columns=int(count.sum()),
    )
