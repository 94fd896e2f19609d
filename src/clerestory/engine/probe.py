"""Test kernel, compiled in a child process to check that a compute device works.

Run as a script with a Mitsuba variant as argument. The kernel has the features that
unsuitable LLVM versions fail to compile: a loop with ray tracing, a virtual call and
exact sums by 64-bit scatters.
"""

import sys

import drjit as dr
import mitsuba as mi


@dr.syntax
def bounce(scene, count):
    """Return the number of paths that leave a closed box within five bounces."""
    total = dr.zeros(mi.UInt64, 4)
    path = dr.arange(mi.UInt32, count)
    random = mi.PCG32(initstate=path)
    ray = mi.Ray3f(mi.Point3f(0, 0, 0), mi.Vector3f(0, 0, 1))
    depth = mi.UInt32(0)
    active = mi.Bool(True)
    while active:
        hit = scene.ray_intersect(ray, active)
        u = mi.Point2f(random.next_float32(), random.next_float32())
        sample, weight = hit.bsdf().sample(mi.BSDFContext(), hit, u.x, u, active)
        dr.scatter_add(total, mi.UInt64(weight.x * 1024), path % 4, active)
        ray = hit.spawn_ray(hit.to_world(sample.wo))
        depth += 1
        active &= depth < 5
    return total


if __name__ == "__main__":
    mi.set_variant(sys.argv[1])
    box = mi.load_dict({"type": "scene", "box": {"type": "cube", "flip_normals": True}})
    works = dr.sum(bounce(box, 1000))[0] > 0
    sys.stdout.write("works" if works else "a test kernel computed nothing")
