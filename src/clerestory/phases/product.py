"""Illuminance from coefficients and a sky, in blocks of sensors.

The error components make coefficients many times larger than the result, so
they exist for one block of sensors at a time.
"""

from collections.abc import Callable

import numpy as np
import xarray as xr

from clerestory.matrix.axis import Axis
from clerestory.matrix.transfer_matrix import TransferMatrix, illuminance_dataset
from clerestory.progress import Progress
from clerestory.sky.sky_matrix import SkyMatrix

# Sensors in a block: 32 components of 3 x 64 x 2306 coefficients take 57 MB
_BLOCK = 64


def annual_illuminance(
    coefficients: Callable[[slice], TransferMatrix],
    sky: SkyMatrix,
    *,
    sensors: Axis,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] over (sensor, time), with its standard error, as float32.

    Parameters
    ----------
    coefficients : from sky patches to the given block of sensors [sr]
    sky : radiance of each patch at each time
    sensors : all of them
    progress : called with the share done, 0…1, and a note
    """
    shape = (sensors.size, len(sky.times))
    illuminance = np.empty(shape, np.float32)
    error = np.empty(shape, np.float32)
    for first in range(0, sensors.size, _BLOCK):
        rows = slice(first, min(first + _BLOCK, sensors.size))
        block = (coefficients(rows) @ sky).illuminance()
        illuminance[rows] = block["illuminance"]
        error[rows] = block["standard_error"]
        if progress is not None:
            progress(rows.stop / sensors.size, f"{rows.stop} of {sensors.size} sensors")
    return illuminance_dataset(illuminance, error, sensors=sensors, times=sky.columns)
