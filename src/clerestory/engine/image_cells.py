"""Visibility of the mirror images of light sources from the cells of a room.

Light that a mirror reflects arrives along the line to the image of its source, if the
first surface that this line meets is the mirror. For a cell and the bounding box of the
surfaces of a plane, a separating axis proves that no line does. No visible image is
excluded by this test, and few images remain for each cell.

Reference: S. Gottschalk, M. Lin, D. Manocha, "OBBTree: a hierarchical structure for
rapid interference detection", SIGGRAPH 1996 (separating axes of boxes).
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.engine.smooth_faces import Boxes
from clerestory.engine.upload import on_device, vectors

# Largest number of tests of cells against surfaces, and smallest number of tests per
# cell that is assumed; largest number of cells along an axis; smallest cell size [m].
_PAIRS, _FEWEST, _ALONG, _SIZE = 1 << 20, 256, 64, 0.05

# Margin around points and boxes [m]; largest number of groups of sources.
_MARGIN, _GROUPS = 5e-3, 16


@dataclass
class ImageCells:
    """Cells of equal size in a grid, and one cell that contains all other points.

    `low` is the corner of the grid, `size` the cell size [m], `shape` the number of
    cells along each axis, `outside` the index of the cell of all other points, `centre`
    the centres of the other cells.
    """

    low: mi.Point3f
    size: mi.Vector3f
    shape: mi.Vector3u
    outside: mi.UInt32
    centre: Float[np.ndarray, "cell 3"]

    @classmethod
    def around(cls, point: Float[np.ndarray, "n 3"], most: int) -> "ImageCells":
        """Return a grid of at most a given number of cells around points."""
        low = point.min(axis=0) - _MARGIN
        extent = point.max(axis=0) + _MARGIN - low
        edge = max(float(extent.max()) / _ALONG, _SIZE)
        while np.ceil(extent / edge).prod() > most:
            edge *= 1.05
        shape = np.ceil(extent / edge).astype(int)
        size = extent / shape
        index = np.stack(np.unravel_index(np.arange(shape.prod()), shape), axis=1)
        return cls(
            vectors(mi.Point3f, low[None]),
            vectors(mi.Vector3f, size[None]),
            vectors(mi.Vector3u, shape[None]),
            on_device(mi.UInt32, [shape.prod()]),
            low + (index + 0.5) * size,
        )

    @classmethod
    def one(cls) -> "ImageCells":
        """Return a single cell of all points."""
        none = np.zeros((1, 3))
        return cls(
            vectors(mi.Point3f, none), vectors(mi.Vector3f, none + 1),
            vectors(mi.Vector3u, none), on_device(mi.UInt32, [0]), none[:0],
        )  # fmt: skip

    def number(self, point: mi.Point3f) -> mi.UInt32:
        """Return the index of the cell that contains a point."""
        number, inside = mi.UInt32(0), mi.Bool(True)
        for place, cells in zip(
            (point - self.low) / self.size, self.shape, strict=True
        ):
            inside &= (place >= 0) & (place < mi.Float(cells))
            number = number * cells + mi.UInt32(dr.maximum(place, 0))
        return dr.select(inside, number, self.outside)


@dataclass
class Sources:
    """Groups of light sources: bounding spheres, or cones of directions.

    `centre` is a point [m] or a unit vector; `radius` that of the sphere [m], or the
    tangent of the half angle of the cone.
    """

    centre: Float[np.ndarray, "group 3"]
    radius: Float[np.ndarray, " group"]

    @classmethod
    def of(
        cls, centre: Float[np.ndarray, "n 3"], radius: Float[np.ndarray, " n"]
    ) -> "Sources":
        """Return groups of neighbouring spheres, at most a few."""
        axis = int(np.argmax(np.ptp(centre, axis=0)))
        found = []
        for group in np.array_split(np.argsort(centre[:, axis]), _GROUPS):
            if len(group):
                middle = (centre[group].min(axis=0) + centre[group].max(axis=0)) / 2
                away = np.linalg.norm(centre[group] - middle, axis=1) + radius[group]
                found.append([*middle, away.max()])
        made = np.array(found).reshape(-1, 4)
        return cls(made[:, :3], made[:, 3])


@dataclass
class ImageReach:
    """Surfaces that reflect first on the way to each image.

    Attributes
    ----------
    distant : whether the sources are suns
    linear, shift : transforms from a source to its images, by state
    state, plane : pairs of an image and a plane that reflects first
    reflectance : of the shortest paths by way of each pair
    boxes : bounding boxes of the surfaces of each plane
    """

    distant: bool
    linear: Float[np.ndarray, "state 3 3"]
    shift: Float[np.ndarray, "state 3"]
    state: Int[np.ndarray, " pair"]
    plane: Int[np.ndarray, " pair"]
    reflectance: Float[np.ndarray, " pair"]
    boxes: Boxes

    def cells(self, point: Float[np.ndarray, "n 3"], sources: Sources) -> ImageCells:
        """Return cells around points, fewer if there are many images."""
        tests = max(len(self.state) * len(sources.radius), _FEWEST)
        return ImageCells.around(point, max(_PAIRS // tests, 1))

    def seen(
        self, cells: ImageCells, sources: Sources
    ) -> Float[np.ndarray, "cell_and_outside state"]:
        """Return the reflectance of images that a point of each cell may see, or 0."""
        seen = np.zeros((len(self.linear), len(cells.centre) + 1))
        half = np.array(cells.size).ravel() / 2 + _MARGIN
        np.maximum.at(seen[:, -1], self.state, self.reflectance)
        for centre, radius in zip(sources.centre, sources.radius, strict=True):
            image = self.linear[self.state] @ centre + self.shift[self.state]
            meets = self._meets(cells.centre, half, image, float(radius))
            shown = meets.T * self.reflectance[:, None]
            np.maximum.at(seen[:, :-1], self.state, shown)
        return seen.T

    def _meets(
        self,
        start: Float[np.ndarray, "cell 3"],
        half: Float[np.ndarray, "3"],
        image: Float[np.ndarray, "pair 3"],
        radius: float,
    ) -> Bool[np.ndarray, "cell pair"]:
        # Whether a line from a cell to an image may meet the bounding box of a plane
        axes, width = self.boxes.axes[self.plane], self.boxes.half[self.plane]
        apart = self.boxes.centre[self.plane] - start[:, None]
        towards = image[None] if self.distant else image - start[:, None]
        length = np.maximum(np.linalg.norm(towards, axis=2, keepdims=True), 1e-9)
        towards = towards / length

        def extent(axis):
            # Half the lengths of box and cell along an axis
            box = np.abs(np.einsum("cpi,pji->cpj", axis, axes))
            return np.sum(box * width, axis=2), np.abs(axis) @ half

        # The box lies beyond the cell, and before an image at finite distance
        box, own = extent(towards)
        depth = np.sum(towards * apart, axis=2)
        end = np.maximum(depth + box + own, 0)
        spread = radius * end if self.distant else radius
        meets = depth + box + np.maximum(own, 0 if self.distant else radius) > 0
        if not self.distant:
            meets &= depth - box - own < length[..., 0] + radius
        # No axis across the line separates the box from cell and image
        edges = [np.broadcast_to(each, image.shape) for each in np.eye(3)]
        for edge in (*edges, *np.moveaxis(axes, 1, 0)):
            across = np.cross(towards, edge[None])
            box, own = extent(across)
            wide = spread * np.linalg.norm(across, axis=2)
            own = own + wide if self.distant else np.maximum(own, wide)
            meets &= np.abs(np.sum(across * apart, axis=2)) <= box + own
        return meets
