"""Mitsuba's BSDF methods that can be derived from other methods of a plugin."""

from __future__ import annotations

from operator import attrgetter

import mitsuba as mi


def completed(**parameters: str):
    """Return a class decorator that adds methods which a BSDF class does not define.

    `eval`, `pdf` and `eval_pdf_sample` are derived from `eval_pdf` and `sample`. A
    class without `eval_pdf` has delta components only.

    Parameters
    ----------
    parameters : for each parameter name of `mi.traverse`, the path of its attribute
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
