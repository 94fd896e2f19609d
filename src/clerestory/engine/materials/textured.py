"""`radiance_textured`: a material on a surface that scatters as if it were bumpy.

The nested material sees a bent frame: what a function of the interaction returns is
added to the unit normal, as Radiance's textures do. A normal bent away from the viewer
is turned back to him. Light that would leave on the wrong side of the real surface is
lost, so that no light leaks through closed solids. Bent normals conserve no energy and
are not reciprocal; they are for looks.

Reference: G. Ward, Radiance, src/rt/raytrace.c (raynormal).
"""

import drjit as dr
import mitsuba as mi

from clerestory.engine.materials.queries import completed
from clerestory.engine.pattern_code import perturbation
from clerestory.scene.pattern import Pattern

PLUGIN = "radiance_textured"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(base="base")
    class RadianceTextured(mi.BSDF):
        """A nested material in a bent frame."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.base = props["base"]
            self.added = None
            self.m_components = [
                self.base.flags(i) for i in range(self.base.component_count())
            ]
            self.m_flags = self.base.flags()

        def bent(self, si):
            """Return the interaction in the bent frame."""
            towards = si.sh_frame.to_world(si.wi)
            normal = si.sh_frame.n
            added = mi.Vector3f(0) if self.added is None else self.added(si)
            bent = dr.normalize(mi.Vector3f(normal) + added)
            bent = dr.select(dr.isfinite(bent.x), bent, mi.Vector3f(normal))

            # Mirror a normal that faces the other way in the plane across the view
            seen = dr.dot(bent, towards)
            away = (seen > 0) != (si.wi.z > 0)
            bent = dr.select(away, bent - 2 * seen * towards, bent)
            made = mi.SurfaceInteraction3f(si)
            made.sh_frame = mi.Frame3f(bent)
            made.wi = made.to_local(towards)
            return made

        def turned(self, si, bent, wo):
            """Direction in the bent frame, and whether it stays on its side."""
            world = si.sh_frame.to_world(wo)
            local = bent.to_local(world)
            return local, local.z * wo.z > 0

        def sample(self, ctx, si, sample1, sample2, active=True):
            bent = self.bent(si)
            bs, weight = self.base.sample(ctx, bent, sample1, sample2, active)
            local = si.to_local(bent.to_world(bs.wo))
            null = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Null)
            stays = null | (local.z * bs.wo.z > 0)
            bs.wo = dr.select(null, -si.wi, local)
            bs.pdf = dr.select(stays, bs.pdf, 0)
            return bs, dr.select(active & stays, weight, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            bent = self.bent(si)
            local, stays = self.turned(si, bent, wo)
            value, pdf = self.base.eval_pdf(ctx, bent, local, active & stays)
            stays &= active
            return dr.select(stays, value, 0), dr.select(stays, pdf, 0)

        def eval_null_transmission(self, si, active=True):
            return self.base.eval_null_transmission(self.bent(si), active)

    return RadianceTextured


def vary(made, name: str, texture: Pattern, origin) -> None:
    """Let a function perturb the normal (`texture`)."""
    made.added = perturbation(texture, origin)
