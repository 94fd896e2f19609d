"""Time for products of matrices and skies, from rates measured on one core.

The rates are processor time of one core, measured on 2026-11-23 on a shared x86-64
server (two cores of an AMD EPYC; NumPy with OpenBLAS). `machine_factor` is the ratio of
the time on this machine to the time there.
"""

import time
from collections.abc import Sequence

import numpy as np

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import MatrixChain
from clerestory.phases.received_sunlight import Sunlit
from clerestory.phases.receivers import (
    chain_components,
    coefficients_cost_less,
    component_count,
)
from clerestory.phases.stored_views import FEW, StoredColumns
from clerestory.threads import linear_algebra_in_one_thread

# Seconds per multiply-add with sky matrices and with window matrices, per matrix value
# that is copied, per value of a result or of its error components
_SKY, _WINDOW, _COPY, _VALUE = 5e-11, 7e-10, 3e-9, 2e-9

# Seconds per recorded path and time step: pixels in sunlight, in one band
_PATH = 2e-9

# Rows of the square matrices whose product is timed, number of products, and seconds
# per multiply-add on the server
_ROWS, _REPEATS, _SERVER = 512, 5, 4.1e-11


def machine_factor() -> float:
    """Return the time of a product on this machine, relative to the server."""
    one = np.full((_ROWS, _ROWS), 0.5, dtype=np.float32)
    spent = []
    # With several threads, processor time includes their waiting
    with linear_algebra_in_one_thread():
        for _ in range(_REPEATS):
            start = time.process_time()
            _ = one @ one
            spent.append(time.process_time() - start)
    return min(spent) / (_SERVER * _ROWS**3)


def product_seconds(
    found: Sequence[MatrixChain],
    rows: int,
    steps: int,
    bands: int = 1,
    *,
    errors: bool = True,
    together: int = 0,
    samples: int = 0,
) -> float:
    """Return the time for a term of the matrix equation [s].

    `rows` are sensors or pixels, `steps` time steps. Of pictures, `together` time steps
    are in a block, and `samples` paths per pixel are recorded.
    """
    short = found[0].factors and isinstance(found[0].receiving[0], TransferMatrix)
    # Pictures are computed separately for each combination of shade states
    combinations = 1 + sum(chain.states - 1 for chain in found)
    if short:
        kinds = [[chain.at(0) for chain in found]] * combinations
        counts = np.full(combinations, steps // combinations)
        short = coefficients_cost_less(kinds, rows, counts)
    blocks = max(combinations, steps / together) if together else 1
    seconds = 0.0
    for chain in found:
        first = chain.receiving[0]
        held = first if isinstance(first, TransferMatrix) else None
        own = chain_components(chain) if errors else 0
        views = (component_count(held) if held else FEW) if errors else 0
        layers, channels = 1 + views + own, len(held.values) if held else bands
        if chain.factors:
            T, D = chain.factors[0][0], chain.factors[0][-1]
            channels, patches = max(channels, bands, len(T.values)), T.rows.size
            whole = D.columns.size * D.rows.size * len(D.values)
            if short:
                whole *= combinations
                seconds += layers * rows * channels * whole * _WINDOW
                seconds += layers * rows * D.columns.size * steps * _SKY
            else:
                whole *= (1 + own) * channels
                seconds += whole * (steps * _SKY + blocks * _COPY)
                inner = (1 + own) * D.rows.size + layers * rows
                seconds += inner * patches * channels * steps * _WINDOW
                seconds += layers * rows * patches * channels * blocks * _COPY
        elif isinstance(first, Sunlit):
            seconds += rows * steps * bands * samples * _PATH
        else:
            axis = None
            if isinstance(first, TransferMatrix | StoredColumns):
                axis = first.columns
            each = layers * rows * (axis.size if axis else steps)
            seconds += each * channels * len(chain.receiving) * _COPY
            if axis and axis.kind == "sky":
                seconds += each * bands * steps * _SKY
        seconds += layers * rows * steps * bands * _VALUE
    return seconds
