"""The three-phase method: I = V T D S.

References: G. Ward, R. Mistrick, E. Lee, A. McNeil, J. Jonsson, Leukos 7 (4),
2011; A. McNeil, The three-phase method for simulating complex fenestration with
Radiance, LBNL, 2014.

Errors of several windows: their view matrices are scored by the same paths, so
batch k of one goes with batch k of the others and their contributions are added
before they are squared. Their daylight matrices are traced independently.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.errors import MatrixError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.product import annual_illuminance
from clerestory.progress import Progress
from clerestory.sky.sky_matrix import SkyMatrix


@dataclass(frozen=True, eq=False)
class WindowPhases:
    """What one window group brings to the equation.

    Attributes
    ----------
    view : V, from its patches on the room side to the sensors
    transmission : T, from its outer to its inner patches
    daylight : D, from the sky to its outer patches
    """

    view: TransferMatrix
    transmission: TransferMatrix
    daylight: TransferMatrix


def three_phase(
    view: TransferMatrix,
    transmission: TransferMatrix,
    daylight: TransferMatrix,
    sky: SkyMatrix,
) -> xr.Dataset:
    """Illuminance [lux] behind one window group, with its standard error.

    Raises
    ------
    MatrixError : two of the matrices do not fit each other
    """
    return three_phase_sum([WindowPhases(view, transmission, daylight)], sky)


def three_phase_sum(
    windows: Sequence[WindowPhases],
    sky: SkyMatrix,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] behind several window groups, with its standard error.

    Parameters
    ----------
    windows : their view matrices have the same sensors and were traced together
    progress : called with the share done, 0…1, and a note

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time), float32

    Raises
    ------
    MatrixError : two of the matrices do not fit each other
    """
    if not windows:
        raise MatrixError("no window; the matrices of at least one window expected")
    sensors = windows[0].view.rows
    for window in windows:
        if not window.view.rows.fits(sensors):
            raise MatrixError(
                f"view matrices for {window.view.rows.describe()} and for"
                f" {sensors.describe()}; the same sensors expected"
            )

    def coefficients(rows: slice) -> TransferMatrix:
        return sky_coefficients(windows, rows)

    return annual_illuminance(coefficients, sky, sensors=sensors, progress=progress)


def sky_coefficients(windows: Sequence[WindowPhases], rows: slice) -> TransferMatrix:
    """Σ V T D over the window groups, for some of the sensors [sr]."""
    parts = []
    for window in windows:
        view = window.view.select_rows(rows)
        parts.append((view @ window.transmission @ window.daylight, view))
    values = np.sum([product.values for product, _ in parts], axis=0)
    components = _joint_components(parts)
    columns = replace(parts[0][0].columns, window=None)
    return TransferMatrix(values, parts[0][0].rows, columns, components)


def _joint_components(
    parts: Sequence[tuple[TransferMatrix, TransferMatrix]],
) -> Float[np.ndarray, "component channel row column"] | None:
    # The first components of a product are those of its view matrix. Where views
    # were traced apart after all, the sum over batches is still free of bias.
    shared: dict[int, np.ndarray] = {}
    independent: list[np.ndarray] = []
    for product, view in parts:
        if product.components is None:
            continue
        count = 0 if view.components is None else len(view.components)
        if count:
            own = product.components[:count]
            shared[count] = shared[count] + own if count in shared else own
        independent.append(product.components[count:])
    groups = [group for group in (*shared.values(), *independent) if len(group)]
    return np.concatenate(groups) if groups else None
