"""Derivatives of path contributions with respect to parameters of materials.

A contribution C is a product of what the vertices of a path scatter. With e_v the
derivative of the logarithm of the factor of vertex v by the logarithm of its parameter
(1 if the factor is proportional to the parameter), and θ the values of parameters,

    θ_i ∂C/∂θ_i          = C Σ_v e_v                          v of material i
    θ_i θ_j ∂²C/∂θ_i∂θ_j = C Σ_v≠w e_v e_w + C Σ_v q_v        v of i, w of j

where q_v θ⁻² is the relative second derivative of one factor. For n vertices of a
diffuse material, the sums are n and n (n − 1). One vertex and one pair of vertices are
chosen at random along the path (reservoir sampling) and stand for the sums; the cost
does not depend on the number of parameters. Sampling densities are held constant.

References: J. Vitter, "Random sampling with a reservoir", ACM Transactions on
Mathematical Software 11 (1), 1985; P. Glynn, "Likelihood ratio gradient estimation for
stochastic systems", Communications of the ACM 33 (10), 1990.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.engine.channels import two_reflectances
from clerestory.engine.conditional_evaluation import where_needed
from clerestory.engine.lower import LoweredScene
from clerestory.engine.next_event_estimation import (
    Bandwise,
    LightSample,
    Path,
    Scattering,
    Vertex,
)
from clerestory.engine.origin import Origin
from clerestory.engine.sampler import PathNumbers
from clerestory.engine.upload import on_device
from clerestory.engine.vertex_scores import Scores
from clerestory.engine.visibility import ShadowRay, interaction, offset
from clerestory.scene.material_parameters import compared_material
from clerestory.scene.model import Material, Scene

# First dimension of the random numbers that choose vertices; their number per vertex
_CHOICES, _PER_VERTEX = 0x40000, 64

# Largest number of samples of a source at a vertex, first pane of a ray, least divisor
_SAMPLES, _FIRST_PANE, _SMALL = 4, 8, 1e-30

# Fraction of the golden ratio: its multiples, modulo 1, are evenly spread
_GOLDEN = 0.618034


@dataclass
class MaterialDerivatives:
    """Parameters of the shapes of a scene.

    Attributes
    ----------
    parameter_of_shape : 1 + index of the parameter of a shape, or 0
    compared : BSDF of each parameter with another colour, as registry indices
    step : relative change of that colour, by parameter; 0 if all is proportional
    proportional, nonlinear : whether this holds for all, or for some parameters
    panes : whether some material transmits shadow rays
    kept : BSDFs, which must exist as long as their indices
    """

    model: LoweredScene
    parameter_of_shape: mi.UInt32
    compared: mi.UInt32
    step: mi.Float
    proportional: bool
    nonlinear: bool
    panes: bool
    kept: list[mi.BSDF]

    @classmethod
    def of(
        cls, scene: Scene, names: Sequence[str], model: LoweredScene, origin: Origin
    ) -> "MaterialDerivatives | None":
        """Return the parameters of materials of a lowered scene; None without any."""
        if not names:
            return None
        index = {name: 1 + number for number, name in enumerate(names)}
        pairs = [compared_material(scene.materials[name]) for name in names]
        steps = [0.0 if pair is None else pair[1] for pair in pairs]
        kept = [
            materials.absorber() if pair is None else materials.load(pair[0], origin)
            for pair in (_in_channels(pair, model) for pair in pairs)
        ]
        ids = [dr.reinterpret_array(mi.UInt32, mi.BSDFPtr(each))[0] for each in kept]
        return cls(
            model,
            on_device(mi.UInt32, [index.get(n, 0) for n in model.name_of_shape]),
            on_device(mi.UInt32, ids),
            on_device(mi.Float, steps),
            not any(steps),
            any(0 < step < 1 for step in steps),
            any(not scene.materials[name].opaque for name in names),
            kept,
        )

    def begin(self) -> Scores:
        """Return the scores of a path without vertices."""
        none = mi.UInt32(0)
        one = None if self.proportional else mi.Color3f(1)
        if one is not None and self.model.throughput is not None:
            one = self.model.throughput.uniform(1)
        curved = one * 0 if self.nonlinear else None
        return Scores(mi.Float(0), none, one, none, none, one, curved)

    def continued(
        self,
        scores: Scores,
        vertex: Vertex,
        si: mi.SurfaceInteraction3f,
        after: Scattering,
        numbers: PathNumbers,
        active: mi.Bool,
    ) -> Scores:
        """Return the scores of a path that is scattered at a vertex."""

        def values(bsdf, active):
            smooth, mirrored = mi.BSDFContext(), materials.mirror_context()
            local = si.to_local(after.direction)
            sharp = after.null | after.delta
            value = bsdf.eval(smooth, si, local, active & ~sharp)
            u = mi.Point2f(0.5)
            flat = bsdf.sample(mirrored, si, 0.5, u, active & after.delta)[1]
            straight = bsdf.eval_null_transmission(si, active & after.null)
            sharp = dr.select(after.null, straight, flat)
            return dr.select(after.null | after.delta, sharp, value)

        return self._met(scores, vertex.shape, si, values, _pick(numbers), active)

    def connected(
        self,
        path: Path | None,
        vertex: Vertex,
        si: mi.SurfaceInteraction3f | None,
        sample: LightSample,
        numbers: PathNumbers,
        number: int,
        active: mi.Bool,
    ) -> Scores:
        """Return the scores of a path from a vertex to a sampled point of a source.

        `number` is that of the sample; `path` and `si` are None at a sensor.
        """
        scores = self.begin() if path is None else path.scores
        if si is not None:

            def values(bsdf, active):
                local = si.to_local(sample.direction)
                return bsdf.eval(mi.BSDFContext(), si, local, active)

            # Samples choose vertices by equidistant numbers, which costs one hash
            pick = _pick(numbers) + number * _GOLDEN
            pick -= dr.floor(pick)
            scores = self._met(scores, vertex.shape, si, values, pick, active)
        if self.panes and sample.shadow_ray is not None:
            start = vertex.leave(sample.direction, active)
            ray = sample.shadow_ray
            scores = self._crossed(scores, start, ray, numbers, number, active)
        return scores

    @dr.syntax
    def _crossed(
        self,
        scores: Scores,
        start: mi.Point3f,
        shadow_ray: ShadowRay,
        numbers: PathNumbers,
        number: int,
        active: mi.Bool,
    ) -> Scores:
        # Scores after the panes along shadow rays that reach their ends
        model, ray = self.model, shadow_ray(start)
        looking = mi.Bool(active)
        pane = mi.UInt32(_FIRST_PANE + number)
        while looking:
            hit = model.scene.ray_intersect_preliminary(ray, active=looking)
            looking &= hit.is_valid()
            si = interaction(hit, ray, looking)
            shape = dr.reinterpret_array(mi.UInt32, si.shape)
            depth = dr.gather(mi.Float, model.thickness_of_shape, shape, looking)
            values = _straight(si)
            pick = _pick(numbers, pane)
            crossing = looking & (depth == 0)
            scores = self._met(scores, shape, si, values, pick, crossing)
            pane += _SAMPLES
            onward = shadow_ray(offset(model, si, ray.d, looking))
            ray.o = dr.select(looking, onward.o, ray.o)
            ray.d = dr.select(looking, onward.d, ray.d)
            ray.maxt = dr.select(looking, onward.maxt, ray.maxt)
        return scores

    def _met(self, scores: Scores, shape, si, values, pick, active) -> Scores:
        # Scores after a vertex on a shape; `values` evaluates the factor of a BSDF
        index = dr.gather(mi.UInt32, self.parameter_of_shape, shape, active)
        here, parameter = active & (index > 0), index - 1
        value = curved = None
        if not self.proportional:
            step = dr.gather(mi.Float, self.step, parameter, here)
            value = self._logarithmic(parameter, step, shape, si, values, here)
            if self.nonlinear:
                # The factor of a pane is about a power of its transmissivity
                linear = (step == 0) | (step == 1)
                curved = dr.select(linear, 0, value * (value - 1))
        return scores.met(parameter, value, curved, pick, here)

    def _logarithmic(self, parameter, step, shape, si, values, active) -> Bandwise:
        # Logarithmic derivative of a factor, from its value for another colour

        def evaluated(active):
            index = dr.gather(mi.UInt32, self.compared, parameter, active)
            other = dr.reinterpret_array(mi.BSDFPtr, index)
            return values(si.bsdf(), active), values(other, active)

        def same():
            return mi.Color3f(1), mi.Color3f(1)

        own, less = where_needed(active & (step > 0), evaluated, same)
        if self.model.throughput is not None:
            in_bands = self.model.throughput.at(shape, active)
            own, less = in_bands(own), in_bands(less)
        share = less / dr.maximum(own, _SMALL)
        change = 1 - share
        if self.nonlinear:
            power = dr.log(dr.maximum(share, _SMALL)) / dr.log(1 - step)
            change = dr.select((step > 0) & (step < 1), power, change)
        return dr.select((step > 0) & (own > 0), change, dr.select(step > 0, 0, 1))


def _straight(si: mi.SurfaceInteraction3f) -> Callable[[mi.BSDF, mi.Bool], mi.Color3f]:
    return lambda bsdf, active: bsdf.eval_null_transmission(si, active)


def _in_channels(
    pair: tuple[Material, float] | None, model: LoweredScene
) -> tuple[Material, float] | None:
    # The compared material in the three channels of a lowered scene
    if pair is None or model.throughput is None:
        return pair
    return two_reflectances(pair[0]), pair[1]


def _pick(numbers: PathNumbers, purpose: mi.UInt32 | int = 0) -> mi.Float:
    # Random number of a vertex, or of a pane beyond it, that chooses vertex or pair
    return numbers.hashed(numbers.vertex * _PER_VERTEX + (_CHOICES + purpose))
