"""Receiving matrices (V, C or C_ds) read in blocks of rows.

V is in memory or in files. Computed on demand are the sky coefficients Σ V T D of a
range of receivers, and the columns of C_ds for suns with irradiance > 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import matmul

import numpy as np
from jaxtyping import Float32, Int

from clerestory.bands import common_bands
from clerestory.matrix.transfer_matrix import Entries, TransferMatrix
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Readable,
    Receiving,
)
from clerestory.phases.received_sunlight import Sunlit
from clerestory.phases.stored_views import StoredColumns
from clerestory.sky.sun_matrix import SunMatrix


@dataclass(frozen=True, eq=False)
class Columns:
    """Selected columns of a coefficient matrix."""

    matrix: Readable
    selected: Int[np.ndarray, " some"]

    def read(self, rows: slice) -> Entries:
        """Return a range of rows and their error components."""
        values, parts = self.matrix.read(rows)
        return values[..., self.selected], (
            None if parts is None else parts[..., self.selected]
        )


@dataclass(frozen=True, eq=False)
class SkyCoefficients:
    """Sky coefficients Σ V T D, the sum over all windows, with fixed shades."""

    windows: Sequence[MatrixChain]

    def read(self, rows: slice) -> Entries:
        """Return a range of rows and their error components."""
        return sky_coefficients(self.windows, rows).read(slice(None))


def sky_coefficients(windows: Sequence[MatrixChain], rows: slice) -> TransferMatrix:
    """Sum of V T D over the window groups in shade state 0, for some sensors [sr].

    Error components of V come first, summed over the windows by component index.
    """
    products: list[TransferMatrix] = []
    views: list[int] = []
    for window in windows:
        assert isinstance(window.view, TransferMatrix)
        view = window.view.select_rows(rows)
        views.append(0 if view.components is None else len(view.components))
        products.append(reduce(matmul, (view, *window.factors[0])))
    total = np.sum([product.values for product in products], axis=0)
    shared = np.zeros((max(views), *total.shape), np.float32)
    parts = [shared]
    for product, count in zip(products, views, strict=True):
        if product.components is not None:
            shared[:count] += product.components[:count]
            parts.append(product.components[count:])
    components = np.concatenate(parts)
    bands = common_bands([(p.bands, len(p.values)) for p in products])
    columns = windows[0].factors[0][-1].columns
    return TransferMatrix(
        total, products[0].rows, columns, components if len(components) else None, bands
    )


def side_by_side(
    matrices: Sequence[Readable], rows: slice, *, errors: bool
) -> Float32[np.ndarray, "layer channel row column"]:
    """Join rows of several matrices side by side: values, then error components."""
    found = [matrix.read(rows) for matrix in matrices]
    only, parts = found[0]
    if len(found) == 1 and (parts is None or not errors) and only.dtype == np.float32:
        return only[None]
    counts = [0 if c is None or not errors else len(c) for _, c in found]
    channels = max(len(values) for values, _ in found)
    columns = sum(values.shape[2] for values, _ in found)
    shape = 1 + max(counts), channels, found[0][0].shape[1], columns
    layers, first = np.zeros(shape, np.float32), 0
    for (values, components), count in zip(found, counts, strict=True):
        part = slice(first, first + values.shape[2])
        layers[0, ..., part] = values
        if count and components is not None:
            layers[1 : 1 + count, ..., part] = components
        first = part.stop
    return layers


def component_count(matrix: Receiving) -> int:
    """Return the number of error components of a matrix in memory or in files."""
    if isinstance(matrix, TransferMatrix) and matrix.components is not None:
        return len(matrix.components)
    if isinstance(matrix, StoredColumns):
        return matrix.views.counts[1]
    if isinstance(matrix, Sunlit):
        return 1
    if isinstance(matrix, SkyCoefficients):
        views = max(component_count(chain.receiving[0]) for chain in matrix.windows)
        return views + sum(map(chain_components, matrix.windows))
    return 0


def channel_count(matrix: Receiving) -> int:
    """Return the number of channels of a matrix in memory or in files."""
    if isinstance(matrix, TransferMatrix):
        return len(matrix.values)
    return matrix.views.counts[0] if isinstance(matrix, StoredColumns) else 0


def chain_components(chain: MatrixChain) -> int:
    """Return the largest number of error components of T, F and D of a shade state."""
    return max((sum(map(component_count, state)) for state in chain.factors), default=0)


def coefficients_cost_less(
    kinds: Sequence[Sequence[MatrixChain]],
    receivers: int,
    steps: Int[np.ndarray, " kind"],
    *,
    outputs: int = 1,
) -> bool:
    """Whether (V T D) S takes fewer operations than V (T D S).

    `kinds` has the matrices of all windows for each combination of shade states,
    `steps` the number of its time steps. `outputs` is the number of weighted sums of
    bands.
    """
    cost = np.zeros(2)
    for windows, count in zip(kinds, steps, strict=True):
        cost += _operations(windows, receivers, int(count), outputs)
    return bool(cost[0] < cost[1])


def _operations(
    windows: Sequence[MatrixChain], receivers: int, steps: int, outputs: int
) -> tuple[int, int]:
    # Multiplications of (V T D) S and of V (T D S), for fixed shades
    views = max(component_count(window.receiving[0]) for window in windows)
    layers, before, behind = 1 + views, 0, 0
    for window in windows:
        daylight = window.factors[0][-1]
        channels = max(channel_count(window.receiving[0]), len(daylight.values))
        inner, sky = window.factors[0][0].rows.size, daylight.columns.size
        own = chain_components(window)
        layers += own
        before += receivers * (1 + views + own) * channels * daylight.rows.size * sky
        behind += (1 + own) * channels * daylight.rows.size * sky * steps
        behind += receivers * (1 + views + own) * channels * inner * steps
    sky = windows[0].factors[0][-1].columns.size
    before += receivers * layers * sky * steps * outputs
    return before, behind


def shining_columns(matrix: Readable, suns: SunMatrix) -> tuple[Columns, SunMatrix]:
    """Return the columns of suns with irradiance > 0, and these suns."""
    shining = np.unique(suns.direct_normal.tocoo().coords[0])
    return Columns(matrix, shining), suns.rows_at(shining)


def layers_of(found: Sequence[MatrixChain], *, errors: bool) -> int:
    """Return the number of error components of a term, plus one for the estimate."""
    if not errors:
        return 1
    views = max(component_count(m) for chain in found for m in chain.receiving)
    return 1 + views + sum(chain_components(chain) for chain in found)


def light_bytes(found: Sequence[MatrixChain], bands: int) -> int:
    """Return the memory for the exiting radiance of a time step [bytes]."""
    patches = sum(
        chain.factors[0][0].rows.size * (1 + chain_components(chain))
        for chain in found
        if chain.factors
    )
    return int(4 * patches * bands)
