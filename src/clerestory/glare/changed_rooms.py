"""Rooms whose reflectances differ from those of their traced matrices.

D is expanded to second order by its derivatives; direct light is traced again.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from clerestory.glare.view_point_tracer import ViewPointTracer
from clerestory.matrix.expansion import expanded_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.shaded_windows import ShadedWindow, ShadeState
from clerestory.scene.material_parameters import with_parameters


def changed_room(
    tracer: ViewPointTracer, values: Mapping[str, float], change: Mapping[str, float]
) -> ViewPointTracer:
    """Return the room with other values of parameters, and D by its derivatives.

    `values` are those of the parameters, `change` their differences from the scene.

    Raises
    ------
    InputError : a BSDF, of which direct light cannot be traced with another value
    """
    scene = tracer.scene
    if tracer.sunlit and change:
        scene = with_parameters(scene, values)
    windows = tuple(_changed(each, change) for each in tracer.windows)
    # Not a copy of the tracer, which keeps beams of light in its own room
    return ViewPointTracer(scene, windows, tracer.skies, tracer.terms)


def _changed(shaded: ShadedWindow, change: Mapping[str, float]) -> ShadedWindow:
    # A window whose D is that of a changed scene
    known: dict[int, TransferMatrix] = {}

    def of(matrix: TransferMatrix) -> TransferMatrix:
        derivatives = matrix.derivatives
        if derivatives is None or not set(change) <= set(derivatives.names):
            return replace(matrix, derivatives=None)
        # Equal matrices remain one object
        if id(matrix) not in known:
            known[id(matrix)] = expanded_matrix(matrix, change)
        return known[id(matrix)]

    def state(own: ShadeState) -> ShadeState:
        return replace(own, whole=tuple(map(of, own.whole)))

    return replace(shaded, states=tuple(map(state, shaded.states)))


def without_components(matrix: TransferMatrix) -> TransferMatrix:
    """Return a matrix with one error component of zero, for products without errors."""
    none = np.zeros((1, *matrix.values.shape), np.float32)
    return replace(matrix, components=none, derivatives=None)
