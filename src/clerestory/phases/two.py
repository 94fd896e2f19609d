"""The two-phase method: daylight coefficients times the sky, I = C S.

Reference: P. R. Tregenza, I. M. Waters, Lighting Research and Technology 15 (2),
1983.
"""

import xarray as xr

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.product import annual_illuminance
from clerestory.progress import Progress
from clerestory.sky.sky_matrix import SkyMatrix


def two_phase(
    coefficients: TransferMatrix, sky: SkyMatrix, *, progress: Progress | None = None
) -> xr.Dataset:
    """Illuminance [lux] over (sensor, time), with its standard error, as float32.

    Parameters
    ----------
    coefficients : from sky patches to sensors [sr]
    sky : radiance of each patch at each time
    progress : called with the share done, 0…1, and a note

    Raises
    ------
    MatrixError : the matrices do not fit each other
    """
    return annual_illuminance(
        coefficients.select_rows, sky, sensors=coefficients.rows, progress=progress
    )
