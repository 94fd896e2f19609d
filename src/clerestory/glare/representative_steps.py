"""Time steps that represent a year: all kinds of sky and positions of the sun."""

import numpy as np
from jaxtyping import Int

from clerestory.phases.matrix_equation import Skies

# Default number of time steps
_CHOSEN = 256


def representative_steps(
    skies: Skies, count: int = _CHOSEN
) -> Int[np.ndarray, " step"]:
    """Return time steps with all kinds of sky and positions of the sun, in order.

    Half of them are those of suns far apart from each other, by direction; the others
    are evenly distributed over the daylit steps, ordered by the radiance of the sky.
    """
    diffuse = skies.whole.diffuse
    lit = np.flatnonzero(diffuse.max(axis=0) > 0)
    if len(lit) <= count:
        return lit
    total = diffuse[:, lit].mean(axis=0)
    order = lit[np.argsort(total, kind="stable")]
    found = np.empty(0, int)
    if skies.suns is not None and skies.suns.direct_normal.nnz:
        found = _apart(skies, count // 2)
    rest = count - len(found)
    even = order[((np.arange(rest) + 0.5) * len(order) / rest).astype(int)]
    return np.unique(np.concatenate([found, even]))


def _apart(skies: Skies, count: int) -> Int[np.ndarray, " step"]:
    # Steps of suns that are farthest from those chosen before, the strongest first
    assert skies.suns is not None
    normal = skies.suns.direct_normal.tocoo()
    sun, step = normal.coords
    bright = normal.data > 0.1 * normal.data.max()
    sun, step, power = sun[bright], step[bright], normal.data[bright]
    direction = skies.suns.directions[sun]
    chosen = [int(power.argmax())]
    nearest = np.full(len(step), np.inf)
    while len(chosen) < min(count, len(step)):
        away = np.square(direction - direction[chosen[-1]]).sum(axis=1)
        nearest = np.minimum(nearest, away)
        chosen.append(int(nearest.argmax()))
    return np.asarray(step[chosen])
