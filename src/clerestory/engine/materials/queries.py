"""Code shared by the plugins of materials: flags, samples and derived methods."""

from __future__ import annotations

from functools import reduce
from operator import attrgetter, or_

import drjit as dr
import mitsuba as mi


def set_components(bsdf: mi.BSDF, *kinds: mi.BSDFFlags) -> None:
    """Set the components of a BSDF, each on both sides."""
    sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
    bsdf.m_components = [kind | sides for kind in kinds]
    bsdf.m_flags = reduce(or_, bsdf.m_components)


def either(condition, yes: mi.BSDFFlags, no: mi.BSDFFlags) -> mi.UInt32:
    """Select one of two BSDF flags."""
    return dr.select(condition, mi.UInt32(+yes), mi.UInt32(+no))


def sampled(wo, pdf, kind, component=0, *, eta=1.0) -> mi.BSDFSample3f:
    """Return a sample of a BSDF: direction, density, and flag of its component."""
    bs = dr.zeros(mi.BSDFSample3f)
    bs.wo, bs.pdf, bs.eta = wo, pdf, eta
    bs.sampled_type, bs.sampled_component = kind, mi.UInt32(component)
    return bs


def upwards(si) -> mi.Vector3f:
    """Return the direction to the viewer, mirrored to the front (z > 0)."""
    return mi.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z))


def mirror_context() -> mi.BSDFContext:
    """Return the BSDF context that samples mirror reflection only.

    The weight of the sample is the reflectance.
    """
    flag = +mi.BSDFFlags.DeltaReflection
    return mi.BSDFContext(mi.TransportMode.Radiance, flag)


def only_mirrored(ctx: mi.BSDFContext) -> bool:
    """Whether a context was made by `mirror_context`."""
    return ctx.type_mask == +mi.BSDFFlags.DeltaReflection


def mirror_sample(si, reflectance, active):
    """Return the sample of mirror reflection, and its reflectance as weight."""
    wo = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
    bs = sampled(wo, 1.0, mi.UInt32(+mi.BSDFFlags.DeltaReflection))
    return bs, dr.select(active, mi.Color3f(reflectance), 0)


def eval_pdf_of_parts(self, ctx, si, wo, active=True):
    """Return BSDF × cosine and pdf, by the method `parts`, alike on both sides."""
    wo = mi.Vector3f(wo.x, wo.y, dr.mulsign(wo.z, si.wi.z))
    matt, glossy, pdf = self.parts(ctx, si, upwards(si), wo, active)
    return matt + glossy, pdf


def completed(**parameters: str):
    """Return a class decorator that adds methods which a BSDF class does not define.

    `eval`, `pdf` and `eval_pdf_sample` are derived from `eval_pdf` and `sample`. A
    class without `eval_pdf` has delta components only. Each keyword is a parameter name
    of `mi.traverse`; its value is the path of an attribute.
    """
    shown = {name: attrgetter(path) for name, path in parameters.items()}

    def eval_pdf(self, ctx, si, wo, active=True):
        return mi.Color3f(0), mi.Float(0)

    def value(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf_sample(self, ctx, si, wo, sample1, sample2, active=True):
        bs, weight = self.sample(ctx, si, sample1, sample2, active)
        return *self.eval_pdf(ctx, si, wo, active), bs, weight

    def traverse(self, callback):
        for name, of in shown.items():
            callback.put(name, of(self), mi.ParamFlags.Differentiable)

    def to_string(self):
        values = ", ".join(str(of(self)) for of in shown.values())
        return f"{type(self).__name__}[{values}]"

    added = {
        "eval_pdf": eval_pdf,
        "eval": value,
        "pdf": pdf,
        "eval_pdf_sample": eval_pdf_sample,
        "traverse": traverse,
        "to_string": to_string,
    }

    def complete(cls: type) -> type:
        for name, method in added.items():
            if name not in vars(cls):
                setattr(cls, name, method)
        return cls

    return complete
