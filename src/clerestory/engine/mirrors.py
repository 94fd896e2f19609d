"""Paths from a vertex to a light source by way of flat smooth surfaces.

The sampled direction points to a mirror image of the source. The path passes panes, is
reflected by surfaces until the composition of the reflections is that of the image, and
ends at the source. Where several panes on a straight segment could reflect it, one is
chosen at random in proportion to transmittance times reflectance.
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.engine.lower import LoweredScene
from clerestory.engine.mirror_images import MirrorImages
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.visibility import along, interaction, offset, towards

# Russian roulette: largest probability of continuing a path that has completed the
# image, or has many reflections; throughput below which other paths may end.
_SURVIVE, _MANY, _FAINT = 0.95, 8, 0.005

# Dimension of the hashed random numbers; numbers per vertex.
_PICKS, _PER_VERTEX = 0x80000, 64


@dr.syntax
def by_mirrors(
    model: LoweredScene,
    images: MirrorImages,
    start: mi.Point3f,
    aim: mi.Vector3f | mi.Point3f,
    image: mi.UInt32,
    numbers: PathNumbers,
    active: mi.Bool,
):
    """Return the throughput of paths from a point to a mirrored source.

    `aim` is the image of a point of the source, or the direction to the image of a sun;
    `image` is the state of the image. The throughput is an estimate of the sum over all
    paths to the image.
    """
    light, throughput = mi.Color3f(0), mi.Color3f(1)
    state = mi.UInt32(0)
    point, travelling = mi.Point3f(start), mi.Bool(active)
    number = mi.UInt32(0)
    while travelling:
        key = _PICKS + numbers.vertex * _PER_VERTEX + 2 * number
        pick, last = numbers.hashed(key), numbers.hashed(key + 1)
        # Follow a straight segment through panes; choose a surface that reflects
        ends = (state == image) & (state > 0)
        share, total = mi.Color3f(1), mi.Float(0)
        chosen, gain, plane = mi.Point3f(0), mi.Color3f(0), mi.UInt32(0)
        origin, looking, blocked = mi.Point3f(point), mi.Bool(travelling), mi.Bool(True)
        while looking:
            if dr.hint(images.distant, mode="scalar"):
                ray = along(aim)(origin)
            else:
                ray = towards(aim)(origin)
                ray.maxt = dr.select(ends, ray.maxt, dr.inf)
            hit = model.scene.ray_intersect_preliminary(ray, active=looking)
            met = looking & hit.is_valid()
            blocked &= ~(looking & ~met)
            si = interaction(hit, ray, met)
            shape = dr.reinterpret_array(mi.UInt32, si.shape)
            emitter = dr.gather(mi.UInt32, model.emitter_of_shape, shape, met)
            illum = dr.gather(
                mi.Bool, model.emitters.illum, emitter - 1, met & (emitter > 0)
            )
            met &= (emitter == 0) | (illum & images.distant)
            bsdf = si.bsdf()

            # Choose the surface by the throughput that it would have
            here = images.plane(model, shape, si, met)
            useful = images.guidance(images.following(state, here), image)
            reflects = met & (useful > 0)
            _, mirrored = bsdf.sample(
                materials.mirror_context(), si, mi.Float(0.5), mi.Point2f(0.5), reflects
            )
            mirrored = dr.select(reflects, share * mirrored, 0)
            strength = dr.max(mirrored) * useful
            total += strength
            part = dr.select(strength > 0, strength / total, 0)
            taken = pick < part
            pick = dr.select(taken, pick / part, (pick - part) / (1 - part))
            pick = dr.clip(pick, 0, dr.one_minus_epsilon(mi.Float))
            chosen = dr.select(taken, offset(model, si, -ray.d, taken), chosen)
            gain = dr.select(taken, mirrored / strength, gain)
            plane = dr.select(taken, here, plane)

            # Pass panes, and proxies
            if dr.hint(model.panes, mode="scalar"):
                flags = dr.gather(mi.UInt32, model.flags_of_shape, shape, met)
                passed = met & mi.has_flag(flags, mi.BSDFFlags.Null)
                straight = mi.Bool(False)
                if dr.hint(model.proxies, mode="scalar"):
                    depth = dr.gather(mi.Float, model.thickness_of_shape, shape, met)
                    straight = met & (depth != 0)
                passed &= ~straight
                through = bsdf.eval_null_transmission(si, passed)
                share = dr.select(passed, share * through, share)
                looking = (passed | straight) & (dr.max(share) > 0)
                origin = dr.select(looking, offset(model, si, ray.d, looking), origin)
            else:
                looking = mi.Bool(False)

        # Score the paths that reach the source
        reached = travelling & ends & ~blocked
        light += dr.select(reached, throughput * share, 0)

        # Reflect, with Russian roulette
        travelling &= total > 0
        if dr.hint(not images.distant, mode="scalar"):
            travelling &= ~ends
        throughput *= gain * total
        survive = dr.minimum(dr.max(throughput) / _FAINT, 1)
        survive = dr.select(ends, total, survive)
        limited = dr.minimum(survive, _SURVIVE)
        survive = dr.select(ends | (number >= _MANY), limited, survive)
        travelling &= last < survive
        throughput /= survive
        number += 1
        state = dr.select(travelling, images.following(state, plane), state)
        aim = dr.select(travelling, images.reflected(aim, plane), aim)
        point = dr.select(travelling, chosen, point)
    return light
