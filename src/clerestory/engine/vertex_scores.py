"""Vertices of a path, chosen at random, that stand for all in its derivatives.

Reference: J. Vitter, "Random sampling with a reservoir", ACM Transactions on
Mathematical Software 11 (1), 1985.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from clerestory.engine.next_event_estimation import Bandwise


@dataclass
class Scores:
    """A vertex and a pair of vertices of a path, chosen at random, and their factors.

    Attributes
    ----------
    count : number of vertices of differentiated materials
    parameter, value : parameter of the chosen vertex, and its logarithmic derivative
    one, other, product : parameters of the chosen pair, and the product of its
        logarithmic derivatives

    `value` and `product` are None if all derivatives are 1. `curved` is the relative
    second derivative of the factor of the chosen vertex; None if all factors are
    linear.
    """

    count: mi.Float
    parameter: mi.UInt32
    value: Bandwise
    one: mi.UInt32
    other: mi.UInt32
    product: Bandwise
    curved: Bandwise = None

    def met(
        self,
        parameter: mi.UInt32,
        value: Bandwise,
        curved: Bandwise,
        pick: mi.Float,
        active: mi.Bool,
    ) -> "Scores":
        """Return the scores after a further vertex; `pick` is a random number."""
        count = dr.select(active, self.count + 1, self.count)
        replaced = active & (pick * count < 1)
        pick = dr.select(replaced, pick * count, (pick * count - 1) / self.count)
        paired = active & (self.count > 0) & (pick * count < 2)

        def chosen(condition, new, old):
            return None if new is None else dr.select(condition, new, old)

        product = None if value is None else value * self.value
        return Scores(
            count,
            dr.select(replaced, parameter, self.parameter),
            chosen(replaced, value, self.value),
            dr.select(paired, self.parameter, self.one),
            dr.select(paired, parameter, self.other),
            chosen(paired, product, self.product),
            chosen(replaced, curved, self.curved),
        )
