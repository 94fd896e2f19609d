"""Black scenes, and checks of the inputs, for direct light through windows."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import has_shape, one_of, require
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.scene.model import Plastic, Scene
from clerestory.scene.window import Window

# Sampling parameters that do not apply to direct light
_WITHOUT = ("relative_error", "bounces", "batches", "components")

_BLACK = Plastic("black", np.zeros(3))


@lru_cache(maxsize=4)
def blackened(scene: Scene) -> Scene:
    """Return the scene with black surfaces, without sources at infinity."""
    return Scene(
        {"black": _BLACK},
        tuple(replace(surface, material="black") for surface in scene.surfaces),
        bands=scene.bands,
    )


def sun_effort(
    function: Callable[..., object], keywords: EffortKeywords, *, samples: int
) -> Effort:
    """Return the checked sampling parameters for tracing direct light.

    `samples` is the default number of paths per receiver.
    """
    goal, most = Goal(samples), 1 << 20
    return effort_of(
        function, keywords, default=goal, most_samples=most, without=_WITHOUT
    )


def window_number(
    windows: Sequence[Window], window: str, bsdf: Bsdf, suns: Float[np.ndarray, "sun 3"]
) -> int:
    """Check window name, BSDF and suns, and return the index of the window."""
    names = [each.name for each in windows]
    one_of(window, "window", choices=names)
    message = "the BSDF has no visible transmission; a transmitting layer expected"
    require(bsdf.has("transmission_front"), message, file=bsdf.source)
    has_shape(suns, (len(suns), 3), "array of unit vectors to the suns")
    return names.index(window)
