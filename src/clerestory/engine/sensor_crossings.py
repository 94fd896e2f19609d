"""Particles that pass the cells of sensors, found by tracing them through boxes."""

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine.sun_particles import Particles
from clerestory.engine.upload import launching, on_device, vectors

# Largest number of cells that a particle is recorded in.
_MOST = 32

# Step beyond a face [m]; more than the largest number of boxes.
_STEP, _BOXES = 1e-5, 1 << 32

# Faces of a box, counter-clockwise from outside, by corner x + 2y + 4z.
_FACES = np.array(
    [
        [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
        [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
    ]
)  # fmt: skip


def crossings(
    particles: Particles, corner: Float[np.ndarray, "box 3"], size: float
) -> tuple[Int[np.ndarray, " entry"], Int[np.ndarray, " entry"]]:
    """Return the particles that enter or leave cubes, and the cubes.

    `corner` is the lowest corner of each cube, `size` the length of its edges [m].
    """
    corners = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), axis=-1)
    offsets = corners.transpose(2, 1, 0, 3).reshape(8, 3) * size
    vertices = (corner[:, None] + offsets).reshape(-1, 3)
    faces = (8 * np.arange(len(corner))[:, None, None] + _FACES).reshape(-1, 3)
    mesh = mi.Mesh("boxes", len(vertices), len(faces))
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = on_device(mi.Float, vertices)
    parameters["faces"] = on_device(mi.UInt32, faces)
    parameters.update()
    return _met(mi.load_dict({"type": "scene", "boxes": mesh}), particles)


@dr.syntax
def _met(
    boxes: mi.Scene, particles: Particles
) -> tuple[Int[np.ndarray, " entry"], Int[np.ndarray, " entry"]]:
    # Walk along each segment from face to face; record the boxes
    start = vectors(mi.Point3f, particles.start)
    end = vectors(mi.Point3f, particles.end)
    direction = dr.normalize(end - start)
    ray = mi.Ray3f(start, direction)
    ray.maxt = dr.norm(end - start)
    lane = dr.arange(mi.UInt32, len(particles))
    found = dr.zeros(mi.UInt32, len(particles) * _MOST)
    count, last, walking = mi.UInt32(0), mi.UInt32(0), mi.Bool(True)
    while walking:
        hit = boxes.ray_intersect_preliminary(ray, active=walking)
        walking &= hit.is_valid()
        box = hit.prim_index // 12 + 1
        new = walking & (box != last)
        dr.scatter(found, box, lane * _MOST + count, new)
        count += dr.select(new, mi.UInt32(1), 0)
        last = dr.select(new, box, last)
        step = hit.t + _STEP
        ray.o = dr.select(walking, ray.o + ray.d * step, ray.o)
        ray.maxt = dr.select(walking, ray.maxt - step, ray.maxt)
        walking &= (count < _MOST) & (ray.maxt > 0)
    with launching():
        dr.eval(found, count)
    boxes_of = found.numpy().reshape(-1, _MOST).astype(np.int64)
    lanes = np.broadcast_to(np.arange(len(particles))[:, None], boxes_of.shape)
    pairs = np.unique(lanes[boxes_of > 0] * _BOXES + boxes_of[boxes_of > 0])
    return pairs // _BOXES, pairs % _BOXES - 1
