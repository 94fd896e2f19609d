"""Mirror images of light sources in the flat smooth surfaces of a scene.

The image of a source by one or more plane reflections is a virtual light source, as for
Radiance's `mirror`. Surfaces of one plane share an image; for suns, so do all surfaces
of one orientation. A *state* is the composition of the reflections of a path since its
last vertex with next-event estimation: the transform that maps a source to its image.

Reference: G. Ward, "The RADIANCE Lighting Simulation and Rendering System", SIGGRAPH
1994, section 3.2 (virtual light sources).
"""

from dataclasses import dataclass, replace

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.engine.image_cells import ImageCells, ImageReach
from clerestory.engine.image_compositions import Compositions, guidance
from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import Scattering
from clerestory.engine.sampler import PathNumbers, random_number
from clerestory.engine.smooth_faces import SmoothFaces
from clerestory.engine.upload import on_device, search, vectors

# Number of the last vertex that always samples an image; binary logarithm of the number
# of paths that share the decision at later vertices; dimension of the random numbers.
_FIRST, _ALIKE, _DECISION = 1, 5, 0x60000


@dataclass
class MirrorImages:
    """Images of a source, sampled in the cells of a room by learned probabilities.

    Attributes
    ----------
    distant : whether the sources are suns, whose images depend on orientations only
    count : number of planes or orientations; 0: no images
    plane_of_face : 1 + index of each face's plane, or 0
    normal, offset : planes; offset from the origin [m], or 0 for orientations
    rows, shift : transforms from a source to its images, by state
    step : next state, by state and 1 + index of the plane; state 0 is a path without
        reflections, state `other` one whose image is not sampled
    outside, columns : `other` and 1 + `count`, opaque to the compiler
    guide : sampling weight of surfaces, by state after reflection and image
    reach : surfaces that reflect first on the way to each image
    cells, chances : cells, and cumulative sampling probabilities by cell and state
    slots : entries of a cell in `chances`
    rate : probability of sampling an image at all, beyond the first vertices of a path
    """

    distant: bool
    count: int
    plane_of_face: mi.UInt32
    normal: mi.Vector3f
    offset: mi.Float
    rows: list[mi.Vector3f]
    shift: mi.Vector3f
    step: mi.UInt32
    other: int
    outside: mi.UInt32
    columns: mi.UInt32
    guide: mi.Float
    reach: ImageReach
    cells: ImageCells
    chances: mi.Float
    slots: int
    rate: mi.Float

    @classmethod
    def of(cls, faces: SmoothFaces, *, distant: bool) -> "MirrorImages":
        """Return the images of suns (`distant`) or of emitters in a scene."""
        planes = faces.planes(distant=distant)
        made = Compositions.of(planes)
        step = made.steps()
        guide = guidance(step)
        linear, shift = np.array(made.linear), np.array(made.shift)
        first = made.beginnings(guide, planes)
        return cls(
            distant=distant,
            count=len(planes.normal),
            plane_of_face=on_device(mi.UInt32, planes.of_face),
            normal=vectors(mi.Vector3f, planes.normal.reshape(-1, 3)),
            offset=on_device(mi.Float, planes.offset),
            rows=[vectors(mi.Vector3f, linear[:, i]) for i in range(3)],
            shift=vectors(mi.Vector3f, shift),
            step=on_device(mi.UInt32, step),
            other=len(step) - 1,
            outside=on_device(mi.UInt32, [len(step) - 1]),
            columns=on_device(mi.UInt32, [len(planes.normal) + 1]),
            guide=on_device(mi.Float, guide),
            reach=ImageReach(distant, linear, shift, *first, planes.boxes),
            cells=ImageCells.one(),
            chances=on_device(mi.Float, []),
            slots=1,
            rate=on_device(mi.Float, [1.0]),
        ).sampled_by(ImageCells.one(), np.array([[0, *made.reflectance[1:]]]), 1.0)

    def sampled_by(
        self, cells: ImageCells, weight: Float[np.ndarray, "cell state"], rate: float
    ) -> "MirrorImages":
        """Return the images with sampling weights of each cell."""
        total = weight.sum(axis=1, keepdims=True)
        chances = np.cumsum(weight / np.where(total > 0, total, 1), axis=1)
        # There is one kernel for each power of two
        slots = 1 << (self.other - 1).bit_length()
        filled = np.pad(chances, ((0, 0), (0, slots - self.other)), mode="edge")
        return replace(
            self,
            cells=cells,
            chances=on_device(mi.Float, filled),
            slots=slots,
            rate=on_device(mi.Float, [rate]),
        )

    def choose(self, pick, numbers: PathNumbers, point, given: mi.UInt32 | None = None):
        """Sample an image that a point may see, unless one is given.

        Return its state, the probability, and the rate of sampling images at the
        vertex; 0 if no image is sampled.
        """
        if given is not None:
            return given, mi.Float(1), mi.Float(1)
        cell = self.cells.number(point)
        state = search(self.chances, self.slots, pick, cell * self.slots)
        chance = self.probability(state, cell)
        # Neighbouring paths share the decision, which saves time in kernels
        group = (numbers.index + numbers.points.first) >> _ALIKE
        decision = random_number(numbers.seed, group, _DECISION + numbers.vertex)
        rate = dr.select(numbers.vertex <= _FIRST, 1, self.rate)
        return state, chance, dr.select((decision < rate) & (chance > 0), rate, 0)

    def known(self, state):
        """Return whether a state's image is sampled wherever it can be seen."""
        return (state > 0) & (state < self.outside)

    def probability(self, state, cell):
        """Return the probability of sampling the image of a state in a cell."""
        known = self.known(state)
        place = cell * self.slots + state
        low = dr.gather(mi.Float, self.chances, place - 1, known)
        return dr.select(
            known, dr.gather(mi.Float, self.chances, place, known) - low, 0
        )

    def image(self, state, source):
        """Return the image of a point, or of a direction, of a source."""
        rows = [dr.gather(mi.Vector3f, row, state) for row in self.rows]
        shift = dr.gather(mi.Vector3f, self.shift, state)
        return type(source)(*(dr.dot(row, source) for row in rows)) + shift

    def source_direction(self, state, direction):
        """Return the direction at the source of light that arrives from its image."""
        rows = [dr.gather(mi.Vector3f, row, state) for row in self.rows]
        return sum(row * part for row, part in zip(rows, direction, strict=True))

    def following(self, state, plane):
        """Return the state after reflection in a plane (1 + index, or 0)."""
        return dr.gather(mi.UInt32, self.step, state * self.columns + plane)

    def guidance(self, state, image):
        """Return the sampling weight of a surface: 0 if the image is out of reach."""
        return dr.gather(mi.Float, self.guide, state * self.outside + image)

    def plane(self, model: LoweredScene, shape, si, active):
        """Return 1 + index of the plane of a surface hit, or 0."""
        first = dr.gather(mi.UInt32, model.first_face, shape, active)
        return dr.gather(mi.UInt32, self.plane_of_face, first + si.prim_index, active)

    def reflected(self, aim, plane):
        """Return the reflection of a point or direction in a plane (1 + index)."""
        normal = dr.gather(mi.Vector3f, self.normal, plane - 1, plane > 0)
        offset = dr.gather(mi.Float, self.offset, plane - 1, plane > 0)
        return aim - 2 * (dr.dot(normal, aim) - offset) * normal

    def remember(self, model: LoweredScene, state, shape, si, after: Scattering):
        """Return the state of the next path segment; see `Source.remember`."""
        mirrored = after.delta & ~after.null
        mirrored &= mi.has_flag(after.flags, mi.BSDFFlags.DeltaReflection)
        plane = dr.select(mirrored, self.plane(model, shape, si, mirrored), 0)
        moved = self.following(state, plane)
        moved = dr.select(after.delta, moved, 0)
        return dr.select(after.null, state, moved)
